// Directions of eye-image pixels and back; lens distortion. Compiled in float by glslang and in double by g++ (shaders/shared_types.h).
// Pixel coordinates: x right, y down, centre of the first pixel at (0.5, 0.5). Directions: x right, y up, -z forward.
#ifndef ENTOPTIC_SHADERS_GEOMETRY_GLSL
#define ENTOPTIC_SHADERS_GEOMETRY_GLSL

#include "shaders/eye_geometry.h"
#include "shaders/visual_polar_math.glsl"

ENTOPTIC_MATH_BEGIN(geometry)

#ifdef __cplusplus
using namespace entoptic::visual_polar;
#endif

// Denominator of Valve's DISTORT_DPOLY3 (facts/devices.md 1.4). Positive inside the lens.
FN real lens_denominator(LensChannel c, real r2) {
    return LIT(1.0) + r2 * (real(c.coefficients.x) + r2 * (real(c.coefficients.y) + r2 * real(c.coefficients.z)));
}

// Panel position in the lens's own coordinates: distance 1 is half the panel's width, origin at the colour's centre.
FN rvec2 lens_position(EyeGeometry g, LensChannel c, rvec2 px) {
    rvec2 uv = px / rvec2(real(g.width), real(g.height));
    return rvec2(LIT(2.0) * uv.x - LIT(1.0) - real(c.centre.x), (LIT(2.0) * uv.y - LIT(1.0)) / real(g.aspect) - real(c.centre.y));
}

// Tangents (right, up) of the direction in which panel pixel `px` is seen in one colour.
FN rvec2 lens_tangents(EyeGeometry g, LensChannel c, rvec2 px) {
    rvec2 p = lens_position(g, c, px);
    real gain = LIT(1.0) / lens_denominator(c, dot(p, p));
    rvec2 ndc = rvec2(p.x * gain + real(c.centre.x), (p.y * gain + real(c.centre.y)) * real(g.aspect));
    return rvec2((ndc.x + real(g.principal_point.x)) / real(g.focal.x), (real(g.principal_point.y) - ndc.y) / real(g.focal.y));
}

// Inverse of lens_tangents: where on the panel the direction (right, up) is seen in one colour.
// Solves r = R0 (1 + k0 r² + k1 r⁴ + k2 r⁶) by Newton's method from r = R0; the k of real lenses are negative, so that the function is
// convex and the iteration falls to the root from above. 8 steps: below 1e-7 of the panel inside the cut-off (lens_test).
FN rvec2 lens_pixel(EyeGeometry g, LensChannel c, rvec2 tangents) {
    rvec2 ndc = rvec2(tangents.x * real(g.focal.x) - real(g.principal_point.x), real(g.principal_point.y) - tangents.y * real(g.focal.y));
    rvec2 q = rvec2(ndc.x - real(c.centre.x), ndc.y / real(g.aspect) - real(c.centre.y));
    real target = length(q);
    real r = min(target, LIT(1.5));
    for (int i = 0; i < 8; ++i) {
        real r2 = r * r;
        real f = r - target * lens_denominator(c, r2);
        real slope = LIT(1.0) - target * r * (LIT(2.0) * real(c.coefficients.x) +
                                            r2 * (LIT(4.0) * real(c.coefficients.y) + r2 * LIT(6.0) * real(c.coefficients.z)));
        r = r - f / max(slope, LIT(0.1));
    }
    rvec2 p = target > LIT(1e-12) ? q * (r / target) : q;
    rvec2 uv = rvec2((p.x + real(c.centre.x) + LIT(1.0)) * LIT(0.5), ((p.y + real(c.centre.y)) * real(g.aspect) + LIT(1.0)) * LIT(0.5));
    return uv * rvec2(real(g.width), real(g.height));
}

// False where the lens shows nothing: beyond the cut-off, or where any colour's polynomial has left its range.
FN bool lens_visible(EyeGeometry g, rvec2 px) {
    rvec2 green = lens_position(g, g.channels[1], px);
    rvec2 red = lens_position(g, g.channels[0], px);
    rvec2 blue = lens_position(g, g.channels[2], px);
    real lowest = min(lens_denominator(g.channels[1], dot(green, green)),
                      min(lens_denominator(g.channels[0], dot(red, red)), lens_denominator(g.channels[2], dot(blue, blue))));
    return dot(green, green) <= real(g.r2_cutoff.y) && lowest > LIT(0.05);
}

// Whether `px` is so near to the panel's edge that another colour's pixel of the same direction may lie beyond it.
FN bool lens_near_edge(EyeGeometry g, rvec2 px) {
    rvec2 size = rvec2(real(g.width), real(g.height));
    rvec2 from_middle = abs(px - size * LIT(0.5));
    return from_middle.x > size.x * LIT(0.38) || from_middle.y > size.y * LIT(0.38);
}

// Whether panel pixel `px` lights up in colour 0, 1, 2: only where all colours show its direction, so that none stands alone at the
// rim. The cut-offs end at one direction; at the panel's straight edges the other colours' pixels are looked up.
FN bool lens_shows(EyeGeometry g, int colour, rvec2 px) {
    rvec2 p = lens_position(g, g.channels[colour], px);
    if (!(dot(p, p) <= real(g.r2_cutoff[colour]) && lens_denominator(g.channels[colour], dot(p, p)) > LIT(0.05))) return false;
    if (!lens_near_edge(g, px)) return true;
    rvec2 tangents = lens_tangents(g, g.channels[colour], px);
    for (int other = 0; other < 3; ++other) {
        if (other == colour) continue;
        rvec2 at = lens_pixel(g, g.channels[other], tangents);
        if (at.x < LIT(0.0) || at.y < LIT(0.0) || at.x > real(g.width) || at.y > real(g.height)) return false;
    }
    return true;
}

FN rvec3 direction_of_tangents(rvec2 t) { return normalize(rvec3(t.x, t.y, LIT(-1.0))); }

// The foveated disc. Its radius is the root of the number of samples within an eccentricity: every pixel holds as many samples of the
// retina as every other, which is Liu's visual-polar map with its rectangle of radius and angle laid out as the disc that it is. In the
// fovea a pixel is 1/foveal_ppd degrees, both ways.
FN real foveated_radius_px(EyeGeometry g, real deg) { return real(g.foveal_ppd) * sqrt(polar_samples(deg) * LIT(0.3183098861837907)); }

FN real foveated_eccentricity_deg(EyeGeometry g, real radius_px) {
    real in_fovea = radius_px / real(g.foveal_ppd);
    real samples = LIT(3.141592653589793) * in_fovea * in_fovea;
    return min(g.fitted == 1u ? polar_eccentricity_fitted(samples) : polar_eccentricity(samples), LIT(180.0));
}

FN rvec3 foveated_direction(EyeGeometry g, rvec2 px) {
    rvec2 from_middle = px - rvec2(real(g.width), real(g.height)) * LIT(0.5);
    real radius = length(from_middle);
    real angle = foveated_eccentricity_deg(g, radius) * LIT(0.017453292519943295);
    rvec2 across = from_middle * (sin(angle) / max(radius, LIT(1e-6)));
    return rvec3(across.x, -across.y, -cos(angle));
}

FN rvec2 foveated_pixel(EyeGeometry g, rvec3 direction) {
    real off_axis = length(rvec2(direction.x, direction.y));
    real radius = foveated_radius_px(g, atan(off_axis, -direction.z) * LIT(57.29577951308232));
    return rvec2(real(g.width), real(g.height)) * LIT(0.5) + rvec2(direction.x, -direction.y) * (radius / max(off_axis, LIT(1e-12)));
}

// Unit direction that pixel `px` of the eye image shows.
FN rvec3 geometry_direction(EyeGeometry g, rvec2 px) {
    if (g.kind == geometry_lens) return direction_of_tangents(lens_tangents(g, g.channels[1], px));
    if (g.kind == geometry_foveated) return foveated_direction(g, px);
    rvec2 uv = px / rvec2(real(g.width), real(g.height));
    if (g.kind == geometry_rectilinear)
        return direction_of_tangents(rvec2(mix(real(g.tan_left), real(g.tan_right), uv.x), mix(real(g.tan_up), real(g.tan_down), uv.y)));
    real longitude = (uv.x - LIT(0.5)) * LIT(6.283185307179586);
    real latitude = (LIT(0.5) - uv.y) * LIT(3.141592653589793);
    return rvec3(sin(longitude) * cos(latitude), sin(latitude), -cos(longitude) * cos(latitude));
}

// Pixel of the eye image that shows `direction` (need not be a unit vector). Lens and rectilinear: directions behind the eye give (-1e6, -1e6).
FN rvec2 geometry_pixel(EyeGeometry g, rvec3 direction) {
    if (g.kind == geometry_foveated) return foveated_pixel(g, direction);
    rvec2 size = rvec2(real(g.width), real(g.height));
    if (g.kind == geometry_equirect) {
        rvec3 d = normalize(direction);
        return rvec2(LIT(0.5) + atan(d.x, -d.z) * LIT(0.15915494309189535), LIT(0.5) - asin(clamp(d.y, LIT(-1.0), LIT(1.0))) * LIT(0.3183098861837907)) * size;
    }
    if (direction.z > LIT(-1e-3) * length(direction)) return rvec2(LIT(-1e6), LIT(-1e6));
    rvec2 t = rvec2(direction.x, direction.y) / -direction.z;
    if (g.kind == geometry_lens) return lens_pixel(g, g.channels[1], t);
    return rvec2((t.x - real(g.tan_left)) / (real(g.tan_right) - real(g.tan_left)), (t.y - real(g.tan_up)) / (real(g.tan_down) - real(g.tan_up))) *
           size;
}

// Whether pixel `px` shows anything at all. Of the foveated disc: whether it can; what the view does not hold has no solid angle in the frame.
FN bool geometry_visible(EyeGeometry g, rvec2 px) {
    if (g.kind == geometry_foveated)
        return length(px - rvec2(real(g.width), real(g.height)) * LIT(0.5)) <= foveated_radius_px(g, real(g.edge_deg));
    return g.kind != geometry_lens || lens_visible(g, px);
}

// Solid angle of the pixel around `px`, sr, by central differences of one pixel.
FN real geometry_solid_angle(EyeGeometry g, rvec2 px) {
    rvec3 across = geometry_direction(g, px + rvec2(LIT(0.5), LIT(0.0))) - geometry_direction(g, px - rvec2(LIT(0.5), LIT(0.0)));
    rvec3 down = geometry_direction(g, px + rvec2(LIT(0.0), LIT(0.5))) - geometry_direction(g, px - rvec2(LIT(0.0), LIT(0.5)));
    return length(cross(across, down));
}

// Local pixels per degree: the geometric mean of both axes.
FN real geometry_ppd(EyeGeometry g, rvec2 px) { return LIT(0.017453292519943295) / sqrt(max(geometry_solid_angle(g, px), LIT(1e-20))); }

ENTOPTIC_MATH_END

#endif
