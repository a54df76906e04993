// The tone map of the residual law: what the panel can show is shown as it is; only scenes that leave the panel's range are exposed
// otherwise, and only highlights above its white are compressed. Compiled in float and in double.
#ifndef ENTOPTIC_PERCEPTION_TONE_DISPLAY_IDENTITY_MATH_GLSL
#define ENTOPTIC_PERCEPTION_TONE_DISPLAY_IDENTITY_MATH_GLSL

#include "perception/tone/display_identity_params.h"
#include "perception/tone/tone_colour.glsl"
#include "shaders/scene_statistics.h"

ENTOPTIC_MATH_BEGIN(perception::display_identity)

// x²(3 - 2x) from `low` to `high`: exactly 0 up to `low`.
FN real smooth_step(real low, real high, real v) {
    real x = clamp((v - low) / (high - low), LIT(0.0), LIT(1.0));
    return x * x * (LIT(3.0) - LIT(2.0) * x);
}

FN real log2_of(real x) { return log(x) * LIT(1.4426950408889634); }

// What the curve depends on besides the state of adaptation; smoothed over time.
struct ToneLevels {
    real bright_y;        // 99.9th percentile of luminance, cd/m²
    real night_weight;    // how far the picture is exposed for the dark, 0..1
    real day_weight;      // and for the light
    real shoulder;        // how far highlights are compressed rather than clipped, 0..1
};

// The 99.9th percentile of tile luminance, interpolated in its bin on log10 Y, at most the largest luminance.
FN real bright_luminance(SceneStatistics s) {
    real total = LIT(0.0);
    for (uint b = 0u; b < histogram_bins; ++b) total += real(s.histogram[b]);
    real below = LIT(0.0);
    for (uint b = 0u; b < histogram_bins; ++b) {
        real count = real(s.histogram[b]);
        if (count > LIT(0.0) && below + count >= LIT(0.999) * total) {
            real inside = (LIT(0.999) * total - below) / count;
            return min(exp(LIT(2.302585092994046) * (LIT(14.0) * (real(b) + inside) / real(histogram_bins) - LIT(6.0))), real(s.max_y));
        }
        below += count;
    }
    return real(s.max_y);
}

const float weight_counts_as_none = 1e-4f;

// One step of a weight towards `now`, `rate` of the way; exactly 0 in the end.
FN real smoothed(real before, real now, real rate) {
    real next = mix(before, now, rate);
    return now == LIT(0.0) && next < real(weight_counts_as_none) ? LIT(0.0) : next;
}

// 0 while no more than a fiftieth of the field is darker than the panel's black.
FN real night_weight(real dark_share) { return smooth_step(LIT(0.02), LIT(0.3), dark_share); }
// 0 while the bright parts are within the panel's range.
FN real day_weight(real bright_y, real white) { return smooth_step(LIT(0.0), LIT(1.5), log2_of(max(bright_y, LIT(1e-9)) / (LIT(1.004) * white))); }
// 0 while nothing is above white.
FN real shoulder(real peak_channel, real e, real white) { return smooth_step(LIT(0.01), LIT(1.0), log2_of(max(e * peak_channel, LIT(1e-9)) / white)); }

// Exposure e: displayed over scene luminance. Exactly 1 while both weights are 0.
// Night: an eye adapted to A < 1 cd/m² is shown A^(1 - exponent), but the scene's bright parts not above the knee.
// Day: A lands at day·(A/day)^exponent.
FN real exposure(DisplayIdentityParams p, ToneLevels s, real adaptation, real white) {
    if (s.night_weight == LIT(0.0) && s.day_weight == LIT(0.0)) return LIT(1.0);
    real a = max(adaptation, LIT(1e-6));
    real night = a >= LIT(1.0) ? LIT(1.0) : min(exp(-real(p.night_exponent) * log(a)), max(LIT(1.0), real(p.knee) * white / max(s.bright_y, LIT(1e-6))));
    real day = min(LIT(1.0), real(p.day_cd_m2) * exp(real(p.day_exponent) * log(a / real(p.day_cd_m2))) / a);
    return exp(s.night_weight * log(night) + s.day_weight * log(day));
}

// Displayed luminance of scene luminance y, cd/m².
FN real displayed(DisplayIdentityParams p, real y, real e, real shoulder_share, real white) {
    real exposed = e * y, knee = real(p.knee) * white;
    real clipped = min(exposed, white);
    if (exposed <= knee || shoulder_share <= LIT(0.0)) return clipped;
    real soft = knee + (white - knee) * (LIT(1.0) - exp((knee - exposed) / (white - knee)));
    return mix(clipped, soft, shoulder_share);
}

ENTOPTIC_MATH_END

#endif
