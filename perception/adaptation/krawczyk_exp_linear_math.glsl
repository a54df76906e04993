// Krawczyk, Myszkowski and Seidel 2005 as in Luidolt et al. 2020, equations 2-4: the adaptation luminance follows a gaze-weighted mean
// of the scene with the time constants of rods and cones. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_ADAPTATION_KRAWCZYK_EXP_LINEAR_MATH_GLSL
#define ENTOPTIC_PERCEPTION_ADAPTATION_KRAWCZYK_EXP_LINEAR_MATH_GLSL

#include "perception/adaptation/krawczyk_exp_linear_params.h"
#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

ENTOPTIC_MATH_BEGIN(perception::krawczyk_exp_linear)
#ifdef __cplusplus
using namespace entoptic::geometry;
#endif

// Equation 4: sensitivity of the rods, 1 in the dark, at luminance y (cd/m²).
FN real rod_sensitivity(real y) { return LIT(0.04) / (LIT(0.04) + y); }

// Equation 3: time constant, s.
FN real time_constant(KrawczykExpLinearParams p, real y) {
    real s = rod_sensitivity(y);
    return s * real(p.tau_rod_s) + (LIT(1.0) - s) * real(p.tau_cone_s);
}

const float short_step = 0.25f;     // in time constants

// 1 - exp(-x) for 0 <= x < short_step without cancellation: the series to x⁷ (relative error under 2e-9). fp32 needs it because
// 1 - exp(-1e-6) is 5 % off there and 0 at 1e-8 (oracle expm1_fp32).
FN real one_minus_exp(real x) {
    real series = LIT(1.0) - x / LIT(7.0);
    series = LIT(1.0) - x / LIT(6.0) * series;
    series = LIT(1.0) - x / LIT(5.0) * series;
    series = LIT(1.0) - x / LIT(4.0) * series;
    series = LIT(1.0) - x / LIT(3.0) * series;
    series = LIT(1.0) - x / LIT(2.0) * series;
    return x * series;
}

// Equation 2: the adaptation luminance dt_s after `before`, on its way to `target` (cd/m²). The time constant is the target's, so that
// two half steps are one step. dt_s <= 0 or NaN: no change. The state keeps its floor.
FN real adapted(KrawczykExpLinearParams p, real before, real target, real dt_s) {
    if (!(dt_s > LIT(0.0))) return before;
    real x = dt_s * real(p.speed) / time_constant(p, target);
    // A short step is exact as a change of the state, a long one as the rest of the way to the target.
    real after = x < real(short_step) ? before + (target - before) * one_minus_exp(x) : target + (before - target) * exp(-x);
    return max(after, real(p.floor_cd_m2));
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

// Weight of one point of the eye image: exp(-angle²/2σ²).
FN real pixel_weight(KrawczykExpLinearParams p, EyeGeometry g, rvec3 gaze, rvec2 px) {
    real angle = angle_between(geometry_direction(g, px), gaze) / (real(p.sigma_gaze_deg) * LIT(0.017453292519943295));
    return exp(LIT(-0.5) * angle * angle);
}

// Mean weight of a tile's four 8×8-pixel blocks: exp(-angle²/2σ²) at their centres.
FN real tile_weight(KrawczykExpLinearParams p, EyeGeometry g, rvec3 gaze, uint tile_x, uint tile_y) {
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
FN real clip_luminance(KrawczykExpLinearParams p, SceneStatistics s) {
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
    real printed_y;           // luminance times weight, over pixels: as printed
};

FN GazeSums no_tiles() {
    GazeSums s;
    s.near_y = s.near_sr = s.wide_y = s.wide_sr = s.printed_y = LIT(0.0);
    return s;
}

FN GazeSums added(GazeSums a, GazeSums b) {
    a.near_y += b.near_y;
    a.near_sr += b.near_sr;
    a.wide_y += b.wide_y;
    a.wide_sr += b.wide_sr;
    a.printed_y += b.printed_y;
    return a;
}

// What one tile adds. `weight` of tile_weight().
FN GazeSums tile_sums(TileStatistics t, real weight, real clip) {
    if (t.visible == 0u) return no_tiles();
    real mean = real(t.sum_y_sr) / real(t.sum_sr);
    GazeSums s;
    s.printed_y = weight * mean * real(t.visible);
    mean = min(mean, clip);
    s.near_sr = weight * real(t.sum_sr);
    s.near_y = s.near_sr * mean;
    s.wide_sr = real(t.sum_sr);
    s.wide_y = s.wide_sr * mean;
    return s;
}

// Gaze-weighted luminance, cd/m². Uniform weights when less than 1e-3 of the Gaussian falls on what can be seen. `pixels` of the view.
FN real gaze_luminance(KrawczykExpLinearParams p, GazeSums s, real pixels) {
    if (p.as_printed > 0.5) return max(s.printed_y / pixels, real(p.floor_cd_m2));
    if (s.wide_sr <= LIT(0.0)) return real(p.floor_cd_m2);
    real sigma = real(p.sigma_gaze_deg) * LIT(0.017453292519943295);
    real full = min(LIT(6.283185307179586) * sigma * sigma, s.wide_sr);
    real wide = s.wide_y / s.wide_sr;
    real near = s.near_sr > LIT(1e-3) * full ? s.near_y / s.near_sr : wide;
    return max(mix(near, wide, real(p.wide_share)), real(p.floor_cd_m2));
}

ENTOPTIC_MATH_END

#endif
