// What the models of the slot `dof` share: the optics of a defocused eye, and how a pixel's light is laid out over its disc. Compiled in
// float and in double. Distances are dioptres, 1/m, so that infinity is 0.
#ifndef ENTOPTIC_PERCEPTION_DOF_DOF_MATH_GLSL
#define ENTOPTIC_PERCEPTION_DOF_DOF_MATH_GLSL

#include "shaders/scene_statistics.h"
#include "shaders/shared_types.h"

ENTOPTIC_MATH_BEGIN(perception::dof)

// Visual angle (rad) of the disc into which a pupil spreads a point that is `defocus` dioptres out of focus: Liu et al. 2021, equation 12
// with its misprint (a product for a quotient, trap Li3) undone, divided by the focal length, which cancels.
FN real disc_angle_rad(real pupil_mm, real defocus) { return LIT(1e-3) * pupil_mm * abs(defocus); }

// Chromatic eye of Thibos et al. 1992 (Applied Optics 31:3594): refraction at a wavelength (µm) relative to 580 nm, dioptre. Blue is
// focused in front of the retina: negative.
FN real chromatic_dioptre(real wavelength_um) { return LIT(1.7312) - LIT(0.63346) / (wavelength_um - LIT(0.21410)); }

// Of the display's red, green and blue, at the centroids 610, 540 and 460 nm of its primaries.
FN rvec3 chromatic_dioptres() {
    return rvec3(chromatic_dioptre(LIT(0.610)), chromatic_dioptre(LIT(0.540)), chromatic_dioptre(LIT(0.460)));
}

// Liu et al. 2021, section 3.2: focal length of the eye, m, and the tangent of 1 minute of arc, which times it is the criterion c.
const float focal_length_m = 0.0223f;
const float tan_arcminute = 2.908882168e-4f;

// Half of the depth of field, dioptres: equations 4 and 5 as 1/DF and 1/DN = 1/F -+ this, with c/tau (not c·tau, trap Li1).
FN real depth_of_field_dioptre(real pupil_mm, real focus) {
    return real(tan_arcminute) * LIT(1e3) / pupil_mm * (LIT(1.0) - real(focal_length_m) * focus);
}
// Ends of the depth of field, dioptres. The far end is infinity, not beyond it (trap Li2).
FN real near_limit_dioptre(real pupil_mm, real focus) { return focus + depth_of_field_dioptre(pupil_mm, focus); }
FN real far_limit_dioptre(real pupil_mm, real focus) { return max(focus - depth_of_field_dioptre(pupil_mm, focus), LIT(0.0)); }

// Liu et al. 2021, equation 10: how densely a pixel's disc is sampled. As printed the weight falls to 0 at the scene's farthest point and
// is linear in metres (trap Li5); here a disc of d pixels needs 2/d of them.
const float least_sampling = 0.05f;
FN real sampling_weight(real radius_px) { return clamp(LIT(1.0) / max(radius_px, LIT(1e-6)), real(least_sampling), LIT(1.0)); }

// Discs up to this radius lie within their pixel: exactly the identity.
const float identity_radius_px = 0.5f;

// Share of a pixel's light that its disc of `radius` puts into a pixel `distance` away, all in pixels. The rim is one pixel wide; the
// divisor is the integral of the numerator but for 0.05 square pixels, so that a disc of one pixel is 1 in its own pixel and 0 elsewhere.
FN real disc_share(real radius, real distance_px) {
    real r = max(radius, real(identity_radius_px));
    return clamp(r + LIT(0.5) - distance_px, LIT(0.0), LIT(1.0)) / (LIT(1.0) + LIT(3.141592653589793) * (r * r - LIT(0.25)));
}

// Liu et al. 2021, section 3.3.2: beyond the depth of field the kernel's top two rows pass no blue and its bottom two no red; in front of
// it the other way around. `side`: -1 beyond, 1 in front, 0 within. `row`: of the tap, down from the kernel's centre. Divided by what is
// left of the disc (a circle cut at a chord), so that white stays white.
FN rvec3 row_filter(real side, real radius, real row) {
    rvec3 all = rvec3(LIT(1.0), LIT(1.0), LIT(1.0));
    if (side == LIT(0.0) || radius <= real(identity_radius_px)) return all;
    real reach = floor(radius + LIT(0.5));
    real cut = clamp((reach - LIT(1.5)) / radius, LIT(-0.9), LIT(1.0));
    real left = LIT(0.5) + (cut * sqrt(LIT(1.0) - cut * cut) + asin(cut)) * LIT(0.3183098861837907);
    bool top = row < LIT(1.5) - reach, bottom = row > reach - LIT(1.5);
    bool red = side < LIT(0.0) ? !bottom : !top, blue = side < LIT(0.0) ? !top : !bottom;
    return rvec3(red ? LIT(1.0) / left : LIT(0.0), LIT(1.0), blue ? LIT(1.0) / left : LIT(0.0));
}

// Light that a pixel gathers. In front: from what is nearer than the pixel's own depth; it covers. Behind: from all the rest.
struct Gathered {
    rvec3 front, front_share;
    rvec3 behind, behind_share;
};
FN Gathered nothing_gathered() {
    Gathered g;
    g.front = g.front_share = g.behind = g.behind_share = rvec3(LIT(0.0), LIT(0.0), LIT(0.0));
    return g;
}
// What covers takes its share of the light away from what lies behind; the rest is a mean, so that picture and lens end without a rim.
FN rvec3 gathered_light(Gathered g) {
    rvec3 cover = max(g.front_share, rvec3(LIT(1.0), LIT(1.0), LIT(1.0)));
    rvec3 free = max(rvec3(LIT(1.0), LIT(1.0), LIT(1.0)) - g.front_share, rvec3(LIT(0.0), LIT(0.0), LIT(0.0)));
    return g.front / cover + free * (g.behind / max(g.behind_share, rvec3(LIT(1e-20), LIT(1e-20), LIT(1e-20))));
}

// Step of a first-order low-pass: the focus dt_s after `before`, on its way to `target` (dioptres). dt_s <= 0 or NaN: no change.
// The way that is left shrinks by exp(-dt/tau), so that two half steps are one step.
FN real followed(real before, real target, real dt_s, real tau_s) {
    if (!(dt_s > LIT(0.0))) return before;
    return target + (before - target) * exp(-dt_s / tau_s);
}

ENTOPTIC_MATH_END

#endif
