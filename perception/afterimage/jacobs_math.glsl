// Jacobs et al. 2015, section 2.2: afterimages by bleached pigment and by calcium, for L, M and S cones. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_AFTERIMAGE_JACOBS_MATH_GLSL
#define ENTOPTIC_PERCEPTION_AFTERIMAGE_JACOBS_MATH_GLSL

#include "perception/afterimage/jacobs_params.h"
#include "perception/decay.glsl"
#include "shaders/colour_math.glsl"
#include "shaders/scene_statistics.h"

ENTOPTIC_MATH_BEGIN(perception::jacobs)
#ifdef __cplusplus
using namespace entoptic::colour;
using namespace decay;
#endif

// ---- Colour ----

// Linear BT.709 to the cones' L, M, S and back: Hunt, Pointer and Estevez for D65, each row's sum 1, so that white of luminance Y is
// L = M = S = Y. The paper gives no matrix (trap J13).
FN rvec3 lms_of_rgb(rvec3 c) {
    return rvec3(LIT(0.313947576) * c.x + LIT(0.63954264) * c.y + LIT(0.0465097845) * c.z,
                 LIT(0.155350447) * c.x + LIT(0.757925749) * c.y + LIT(0.0867238036) * c.z,
                 LIT(0.0177500401) * c.x + LIT(0.109447621) * c.y + LIT(0.872802339) * c.z);
}
FN rvec3 rgb_of_lms(rvec3 c) {
    return rvec3(LIT(5.4729538369466635) * c.x - LIT(4.6426133105876435) * c.y + LIT(0.1696594690304916) * c.z,
                 LIT(-1.125188922527227) * c.x + LIT(2.293075676566009) * c.y - LIT(0.16788675254216887) * c.z,
                 LIT(0.029793802689277792) * c.x - LIT(0.1931309044548639) * c.y + LIT(1.1633371015571032) * c.z);
}
// Appendix A, the matrix H: bleaching of L, M, S to the RGB of its afterimage; negative light is no light.
FN rvec3 bleached_colour(rvec3 c) {
    return max(rvec3(LIT(1.14) * c.x - LIT(1.18) * c.y + LIT(0.36) * c.z, LIT(-0.08) * c.x + LIT(1.02) * c.y + LIT(0.18) * c.z,
                     LIT(0.30) * c.x - LIT(0.11) * c.y + LIT(1.25) * c.z),
               rvec3(LIT(0.0), LIT(0.0), LIT(0.0)));
}

// ---- What drives a cell of the retina ----

const float rounded_up = 1.00001f;   // a white that came out a few digits too bright is still white

struct Drive {
    rvec3 light;      // I of equations 4-6, LMS, cd/m²
    rvec3 response;   // R of equations 8-12, LMS, 0..1
};

FN Drive no_drive() {
    Drive d;
    d.light = d.response = rvec3(LIT(0.0), LIT(0.0), LIT(0.0));
    return d;
}

// What the lids let through, RGB; `open` from 0 to 1.
FN rvec3 lid_transmission(JacobsParams p, real open) {
    rvec3 closed = rvec3(real(p.lid_red), real(p.lid_green_blue), real(p.lid_green_blue));
    real part = clamp(open, LIT(0.0), LIT(1.0));
    return closed * (LIT(1.0) - part) + rvec3(part, part, part);
}

// The drive by one pixel: scene light (RGB, cd/m²), displayed as `scale` times as much on a panel of this white (cd/m²), behind a lid.
// `exposure`: that of the tone curve. photographic = 1 is the paper: all light bleaches, and R is what is displayed, over white. 0 is the residual law: the
// panel's own light bleaches and adapts the wearer's own eye, so what is left is the light that the panel does not send. It bleaches by
// what is missing in cd/m², and adapts by what is missing at the picture's exposure, over white, compressed like R by x/(1 + x): a
// scene that is only shown brighter or darker as a whole leaves local adaptation to the wearer.
FN Drive drive_of(JacobsParams p, rvec3 scene, real scale, real exposure, real white, rvec3 lid) {
    real brightest = white * real(rounded_up);
    rvec3 displayed = min(scene * scale, rvec3(brightest, brightest, brightest));
    Drive d;
    if (p.photographic > 0.5) {
        d.light = lms_of_rgb(scene * lid);
        d.response = lms_of_rgb(displayed * lid) / white;
        return d;
    }
    const rvec3 none = rvec3(LIT(0.0), LIT(0.0), LIT(0.0));
    d.light = lms_of_rgb(max(scene - displayed, none) * lid);
    rvec3 missing = lms_of_rgb(max(scene * exposure - displayed, none) * lid) / white;
    d.response = missing / (missing + LIT(1.0));
    return d;
}

FN Drive added(Drive a, Drive b) {
    a.light += b.light;
    a.response += b.response;
    return a;
}

// The mean of `count` pixels from their sum.
FN Drive mean_drive(Drive sum, real count) {
    Drive d;
    real scale = LIT(1.0) / max(count, LIT(1.0));
    const real brightest = real(max_scene_cd_m2);
    d.light = clamp(sum.light * scale, rvec3(LIT(0.0), LIT(0.0), LIT(0.0)), rvec3(brightest, brightest, brightest));
    d.response = clamp(sum.response * scale, rvec3(LIT(0.0), LIT(0.0), LIT(0.0)), rvec3(LIT(1.0), LIT(1.0), LIT(1.0)));
    return d;
}

// ---- States of a cell ----

struct Cell {
    rvec3 bleached;   // B: share of bleached pigment, L, M, S
    rvec3 depleted;   // 1 - C/C_max: calcium that is missing. At rest both are 0, where floats are dense; C itself stalls near C_max
};

FN Cell rested() {
    Cell cell;
    cell.bleached = cell.depleted = rvec3(LIT(0.0), LIT(0.0), LIT(0.0));
    return cell;
}

FN rvec3 b1(JacobsParams p) { return rvec3(real(p.b1_l), real(p.b1_m), real(p.b1_s)); }
FN rvec3 b2(JacobsParams p) { return rvec3(real(p.b2_l), real(p.b2_m), real(p.b2_s)); }

// Equations 6 and 10: where the states stay under constant light. C_inf/C_max = 1 - R.
FN Cell steady(JacobsParams p, Drive drive) {
    Cell cell;
    rvec3 rise = b1(p) * drive.light;
    cell.bleached = rise / (rise + b2(p));
    cell.depleted = drive.response;
    return cell;
}

const float rested_below = 1e-7f;      // 1/1000 of what can be seen; from here a state is 0, so that it can be left alone

FN real moved(real before, real target, real rate, real dt_s) {
    real after = before + (target - before) * share_gone(rate * dt_s);
    return target <= LIT(0.0) && after < real(rested_below) ? LIT(0.0) : clamp(after, LIT(0.0), LIT(1.0));
}

// Equations 5 and 9: the states dt_s on. Exact for constant light: two half steps are one step. dt_s <= 0 or NaN: no change.
FN Cell advanced(JacobsParams p, Cell before, Drive drive, real dt_s) {
    if (!(dt_s > LIT(0.0))) return before;
    Cell goal = steady(p, drive);
    rvec3 rate = b1(p) * drive.light + b2(p);
    Cell after;
    for (int i = 0; i < 3; ++i) {
        after.bleached[i] = moved(before.bleached[i], goal.bleached[i], rate[i], dt_s);
        after.depleted[i] = moved(before.depleted[i], goal.depleted[i], real(p.c2), dt_s);
    }
    return after;
}

FN bool is_rested(Cell cell) {
    return cell.bleached.x + cell.bleached.y + cell.bleached.z + cell.depleted.x + cell.depleted.y + cell.depleted.z <= LIT(0.0);
}

// Share of a cell that each of its four neighbours gets in dt_s: the kernel of a walk, whose variance, 2 share cells² an axis, is
// (diffusion_deg)² dt, whatever the frame rate. At most 0.2, which is stable.
FN real diffusion_share(JacobsParams p, real cell_rad, real dt_s) {
    real sigma = real(p.diffusion_deg) * LIT(0.017453292519943295) / cell_rad;
    return dt_s > LIT(0.0) ? min(LIT(0.5) * sigma * sigma * min(dt_s, LIT(0.1)), LIT(0.2)) : LIT(0.0);
}

// ---- What is seen of it ----

struct Afterimage {
    rvec3 gain;   // of the response of L, M, S, minus 1
    rvec3 added;  // RGB, share of the display's range
};

FN Afterimage no_afterimage() {
    Afterimage a;
    a.gain = a.added = rvec3(LIT(0.0), LIT(0.0), LIT(0.0));
    return a;
}

// Equation 11 to the power of j2, minus 1, with e on both sides (trap J15): C_max - C_inf = C_max R.
FN real adaptation_gain(JacobsParams p, real response, real depleted) {
    if (response == depleted) return LIT(0.0);
    real e = real(p.alpha_floor);
    return exp(real(p.j2) * log((response + e) / (depleted + e))) - LIT(1.0);
}

// The two terms of equation 12, seen with `weight`.
FN Afterimage afterimage_of(JacobsParams p, Cell cell, Drive drive, real weight) {
    rvec3 settled = steady(p, drive).bleached;
    rvec3 left = max(cell.bleached - settled, rvec3(LIT(0.0), LIT(0.0), LIT(0.0))) * (rvec3(LIT(1.0), LIT(1.0), LIT(1.0)) - cell.depleted);
    Afterimage a;
    a.added = bleached_colour(left) * (real(p.j1) * weight);
    for (int i = 0; i < 3; ++i) a.gain[i] = adaptation_gain(p, drive.response[i], cell.depleted[i]) * weight;
    return a;
}

// Display light (RGB, cd/m²) with the afterimage: equation 12 with R and J as shares of the display's range. Unchanged to the bit where
// there is none.
FN rvec3 with_afterimage(rvec3 light, Afterimage a, real black, real white) {
    rvec3 response = max(light - rvec3(black, black, black), rvec3(LIT(0.0), LIT(0.0), LIT(0.0)));
    rvec3 changed = light + rgb_of_lms(a.gain * lms_of_rgb(response)) + a.added * (white - black);
    rvec3 lowest = min(light, rvec3(black, black, black)), highest = max(light, rvec3(white, white, white));
    return clamp(changed, lowest, highest);
}

// Largest change of an 8-bit sRGB code of any colour: from the largest added share, the largest |mean gain of the cones|, and the largest
// difference of two cones' gains. What is added counts most on black, where the curve is 12.92 steep; a common gain on white, where its
// slope over the light is at most 1.055/2.4. Different gains move light of saturated colours into dark channels, at most 7.85 of
// their difference (rgb_of_lms times lms_of_rgb, absolute values, off the diagonal).
FN real bound_codes(real added_share, real common_gain, real gain_spread) {
    return LIT(255.0) * (LIT(12.92) * (added_share + LIT(7.85) * gain_spread) + LIT(0.4396) * common_gain);
}

// ---- The retina's map ----
// Lambert's azimuthal equal-area projection around the gaze: all cells see the same solid angle, and no angle functions are needed. `at` in
// radians near the fovea; its length is 2 sin(eccentricity/2).

// Turns a direction so that `from` comes to lie on `to` (unit vectors; opposite ones have no answer, but finite numbers), around the axis that is normal to both: Listing's law.
FN rvec3 turned(rvec3 d, rvec3 from, rvec3 to) {
    rvec3 sum = from + to;
    return d - sum * (dot(sum, d) / max(LIT(1.0) + dot(from, to), LIT(1e-6))) + to * (LIT(2.0) * dot(from, d));
}

FN rvec2 retina_of_direction(rvec3 gaze, rvec3 direction) {
    rvec3 d = turned(direction, gaze, rvec3(LIT(0.0), LIT(0.0), LIT(-1.0)));
    real scale = sqrt(LIT(2.0) / max(LIT(1.0) - d.z, LIT(1e-6)));
    return rvec2(d.x * scale, d.y * scale);
}

FN rvec3 direction_of_retina(rvec3 gaze, rvec2 at) {
    real square = dot(at, at);
    real scale = sqrt(max(LIT(1.0) - LIT(0.25) * square, LIT(0.0)));
    return turned(rvec3(at.x * scale, at.y * scale, LIT(0.5) * square - LIT(1.0)), rvec3(LIT(0.0), LIT(0.0), LIT(-1.0)), gaze);
}

const float fall_off_reach = 3.5f;     // standard deviations; there the Gaussian, 0.0022, is taken to be 0

// Weight of what is seen at this place: a Gaussian of the eccentricity, less its value at its reach, so that it ends without a step.
FN real fall_off(JacobsParams p, rvec2 at) {
    real eccentricity = LIT(2.0) * asin(min(length(at) * LIT(0.5), LIT(1.0)));
    real angle = eccentricity / (real(p.fovea_sigma_deg) * LIT(0.017453292519943295));
    real end = exp(LIT(-0.5) * real(fall_off_reach) * real(fall_off_reach));
    return max((exp(LIT(-0.5) * angle * angle) - end) / (LIT(1.0) - end), LIT(0.0));
}

ENTOPTIC_MATH_END

#endif
