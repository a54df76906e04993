// Thin-lens depth of field in dioptres: a point out of focus becomes a disc of pupil times defocus. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_DOF_DIOPTRIC_DISC_MATH_GLSL
#define ENTOPTIC_PERCEPTION_DOF_DIOPTRIC_DISC_MATH_GLSL

#include "perception/dof/dioptric_disc_params.h"
#include "perception/dof/dof_math.glsl"

ENTOPTIC_MATH_BEGIN(perception::dioptric_disc)
#ifdef __cplusplus
using namespace entoptic::perception::dof;
#endif

// Defocus that is left to simulate. The wearer's own eye tolerates `deadband` of it unseen, as if it always had a disc of that defocus;
// variances of blurs add up, so that the rest is the root of the difference: 0 at the deadband, the whole defocus far from it.
FN real seen_defocus(real defocus, real deadband) { return sqrt(max(defocus * defocus - deadband * deadband, LIT(0.0))); }

// Radius of a pixel's disc in red, green and blue, pixels. Distances in dioptres; pixel_rad: what angle a pixel covers.
FN rvec3 blur_radii_px(DioptricDiscParams p, real dioptre, real focus, real pupil_mm, real pixel_rad) {
    rvec3 colours = p.lca > 0.5 ? chromatic_dioptres() : rvec3(LIT(0.0), LIT(0.0), LIT(0.0));
    // Li [Thibos]: the eye, focused at 580 nm, is short-sighted for blue: what is beyond the focus blurs more in blue.
    rvec3 defocus = rvec3(dioptre - focus, dioptre - focus, dioptre - focus) + colours;
    real scale = LIT(0.5) * real(p.strength) / pixel_rad;
    rvec3 radius = scale * rvec3(disc_angle_rad(pupil_mm, seen_defocus(defocus.x, real(p.deadband_dioptre))),
                                 disc_angle_rad(pupil_mm, seen_defocus(defocus.y, real(p.deadband_dioptre))),
                                 disc_angle_rad(pupil_mm, seen_defocus(defocus.z, real(p.deadband_dioptre))));
    real most = real(p.max_radius_px);
    return min(radius, rvec3(most, most, most));
}

ENTOPTIC_MATH_END

#endif
