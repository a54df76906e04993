// What all adaptation models share: the luminance around the gaze that drives the eye's state, and its speed. Compiled in float and
// in double.
#ifndef ENTOPTIC_PERCEPTION_ADAPTATION_GAZE_LUMINANCE_GLSL
#define ENTOPTIC_PERCEPTION_ADAPTATION_GAZE_LUMINANCE_GLSL

#include "perception/adaptation/gaze_weighting.h"
#include "perception/decay.glsl"
#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

ENTOPTIC_MATH_BEGIN(perception::gaze)
#ifdef __cplusplus
using namespace entoptic::geometry;
using namespace decay;
#endif

FN GazeParams gaze_params(float sigma_gaze_deg, float wide_share, float floor_cd_m2, float clip_over_median, float retinal, float as_printed) {
    GazeParams g;
    g.sigma_gaze_deg = sigma_gaze_deg;
    g.wide_share = wide_share;
    g.floor_cd_m2 = floor_cd_m2;
    g.clip_over_median = clip_over_median;
    g.retinal = retinal;
    g.as_printed = as_printed;
    return g;
}

// Luidolt et al. 2020, equation 4: sensitivity of the rods, 1 in the dark, at luminance y (cd/m²).
FN real rod_sensitivity(real y) { return LIT(0.04) / (LIT(0.04) + y); }

// Equation 3: time constant of an eye that sees y (cd/m²), from those of rods and cones, s.
FN real rods_and_cones_s(float tau_rod_s, float tau_cone_s, real y) {
    real s = rod_sensitivity(y);
    return s * real(tau_rod_s) + (LIT(1.0) - s) * real(tau_cone_s);
}

// Angle between unit vectors, radians; exact for small angles, where acos(dot) is not.
FN real angle_between(rvec3 a, rvec3 b) { return LIT(2.0) * asin(min(length(a - b) * LIT(0.5), LIT(1.0))); }

// The direction the weights are centred on: the gaze, moved to the nearest edge of the picture when it points outside; the zero vector
// when it is not a direction (NaN, zero) or points behind, which means uniform weights.
FN rvec3 gaze_in_view(EyeGeometry g, rvec3 gaze) {
    real size = length(gaze);
    if (!(size > LIT(0.5) && size < LIT(2.0))) return rvec3(LIT(0.0), LIT(0.0), LIT(0.0));
    rvec2 px = geometry_pixel(g, gaze);
    if (!(px.x > LIT(-9e5))) return rvec3(LIT(0.0), LIT(0.0), LIT(0.0));
    return geometry_direction(g, clamp(px, rvec2(LIT(0.0), LIT(0.0)), rvec2(real(g.width), real(g.height))));
}

// Angle between the gaze and the middle of a tile, radians; pi where the gaze is unknown.
FN real tile_angle(EyeGeometry g, rvec3 gaze, uint tile_x, uint tile_y) {
    if (!(dot(gaze, gaze) > LIT(0.5))) return LIT(3.141592653589793);
    rvec2 px = rvec2((real(tile_x) + LIT(0.5)) * real(tile_width), (real(tile_y) + LIT(0.5)) * real(tile_height));
    return angle_between(geometry_direction(g, min(px, rvec2(real(g.width), real(g.height)))), gaze);
}

// Weight of a point `angle` (radians) from the gaze: exp(-angle²/2σ²).
FN real gaussian(GazeParams p, real angle) {
    real sigmas = angle / (real(p.sigma_gaze_deg) * LIT(0.017453292519943295));
    return exp(LIT(-0.5) * sigmas * sigmas);
}

// True where the Gaussian changes so much within a tile that its pixels have to be weighted one by one: wider than a quarter of σ, and within
// 3.2 σ of the gaze.
FN bool tile_is_coarse(GazeParams p, EyeGeometry g, rvec3 gaze, uint tile_x, uint tile_y) {
    real sigma = real(p.sigma_gaze_deg) * LIT(0.017453292519943295);
    rvec2 corner = rvec2(real(tile_x * tile_width), real(tile_y * tile_height));
    rvec2 across = rvec2(min(corner.x + real(tile_width), real(g.width)), corner.y);
    real width = angle_between(geometry_direction(g, corner), geometry_direction(g, across));
    return width > LIT(0.25) * sigma && tile_angle(g, gaze, tile_x, tile_y) < LIT(3.2) * sigma + width;
}

// Mean weight of a tile's four 8×8-pixel blocks: exp(-angle²/2σ²) at their centres.
FN real tile_weight(GazeParams p, EyeGeometry g, rvec3 gaze, uint tile_x, uint tile_y) {
    real sigma = real(p.sigma_gaze_deg) * LIT(0.017453292519943295);
    real sum = LIT(0.0);
    for (int i = 0; i < 4; ++i) {
        rvec2 px = rvec2(real(tile_x * tile_width) + LIT(4.0) + LIT(8.0) * real(i), real(tile_y * tile_height) + LIT(4.0));
        real angle = angle_between(geometry_direction(g, min(px, rvec2(real(g.width), real(g.height)))), gaze) / sigma;
        sum += exp(LIT(-0.5) * angle * angle);
    }
    return sum * LIT(0.25);
}

// Luminance above which a tile is clipped, cd/m²: clip_over_median times the median of the tiles that show light, interpolated inside
// its histogram bin. Tiles in the lowest bin (below 1.7e-6 cd/m²: not drawn) do not count: a lamp on an undrawn background is no outlier.
FN real clip_luminance(GazeParams p, SceneStatistics s) {
    real total = LIT(0.0);
    for (uint b = 1u; b < histogram_bins; ++b) total += real(s.histogram[b]);
    real below = LIT(0.0);
    for (uint b = 1u; b < histogram_bins; ++b) {
        real count = real(s.histogram[b]);
        if (count > LIT(0.0) && LIT(2.0) * (below + count) >= total) {
            real inside = (LIT(0.5) * total - below) / count;
            real log10_median = LIT(14.0) * (real(b) + inside) / real(histogram_bins) - LIT(6.0);
            return real(p.clip_over_median) * exp(LIT(2.302585092994046) * log10_median);
        }
        below += count;
    }
    return real(max_scene_cd_m2);
}

// Sums over tiles: luminance times weight times solid angle, and its weight; near the gaze and over the whole field.
struct GazeSums {
    real near_y, near_sr;
    real wide_y, wide_sr;
    real veil_y, veil_sr;     // weighted by the straylight that reaches the fovea, 1/sr: an illuminance's share
    real printed_y;           // luminance times weight, over pixels: as printed
};

FN GazeSums no_tiles() {
    GazeSums s;
    s.near_y = s.near_sr = s.wide_y = s.wide_sr = s.veil_y = s.veil_sr = s.printed_y = LIT(0.0);
    return s;
}

FN GazeSums added(GazeSums a, GazeSums b) {
    a.near_y += b.near_y;
    a.near_sr += b.near_sr;
    a.wide_y += b.wide_y;
    a.wide_sr += b.wide_sr;
    a.veil_y += b.veil_y;
    a.veil_sr += b.veil_sr;
    a.printed_y += b.printed_y;
    return a;
}

// Straylight: veiling luminance at the fovea over the illuminance of light from `angle` (radians) away, 1/sr. CIE 146:2002, general
// disability glare equation at age 30 and brown eyes: 10/θ³ + 5/θ²·(1 + (30/62.5)⁴), θ in degrees, within 1..100.
FN real straylight(real angle) {
    real degrees = clamp(angle * LIT(57.29577951308232), LIT(1.0), LIT(100.0));
    return LIT(10.0) / (degrees * degrees * degrees) + LIT(5.0) * LIT(1.05308416) / (degrees * degrees);
}

// What one tile adds. `weight` of tile_weight(), `scatter` of straylight() at its middle (0 when the source is before the eye's optics).
FN GazeSums tile_sums(TileStatistics t, real weight, real scatter, real clip) {
    if (t.visible == 0u) return no_tiles();
    real mean = real(t.sum_y_sr) / real(t.sum_sr);
    GazeSums s;
    s.printed_y = weight * mean * real(t.visible);
    mean = min(mean, clip);
    s.near_sr = weight * real(t.sum_sr);
    s.near_y = s.near_sr * mean;
    s.wide_sr = real(t.sum_sr);
    s.wide_y = s.wide_sr * mean;
    s.veil_sr = scatter * real(t.sum_sr);
    s.veil_y = s.veil_sr * mean;
    return s;
}

// Gaze-weighted luminance, cd/m². Uniform weights when less than 1e-3 of the Gaussian falls on what can be seen. `pixels` of the view.
FN real gaze_luminance(GazeParams p, GazeSums s, real pixels) {
    if (p.as_printed > 0.5f) return max(s.printed_y / pixels, real(p.floor_cd_m2));
    if (s.wide_sr <= LIT(0.0)) return real(p.floor_cd_m2);
    real sigma = real(p.sigma_gaze_deg) * LIT(0.017453292519943295);
    real full = min(LIT(6.283185307179586) * sigma * sigma, s.wide_sr);
    real wide = s.wide_y / s.wide_sr;
    real near = s.near_sr > LIT(1e-3) * full ? s.near_y / s.near_sr : wide;
    // On the retina, what leaves the place of the gaze for other places is replaced by what comes from there.
    if (p.retinal > 0.5f) return max(near * (LIT(1.0) - min(s.veil_sr, LIT(0.5))) + s.veil_y * min(LIT(1.0), LIT(0.5) / max(s.veil_sr, LIT(1e-9))), real(p.floor_cd_m2));
    return max(mix(near, wide, real(p.wide_share)), real(p.floor_cd_m2));
}

ENTOPTIC_MATH_END

#endif
