// key_reinhard in double from the papers' equations, with none of the shader's code: Krawczyk 2005 for the key, Reinhard 2002 eq. 3 for
// the curve, gamut mapping by bisection towards grey instead of the closed form.
#include "perception/tone/tone.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

double display_luminance(double y, double a, double key_scale, bool as_printed) {
    const double key = 1.03 - 2.0 / (2.0 + std::log10(a + 1.0));
    const double scaled = as_printed ? key_scale * y * a : key_scale * key / a * y;
    return 1.0 - 1.0 / (1.0 + scaled);
}

// Largest saturation 0..1 at which all channels stay within 1.
double saturation_in_gamut(const double (&colour)[3], double grey) {
    const auto fits = [&](double s) { return std::all_of(colour, colour + 3, [&](double c) { return grey + s * (c - grey) <= 1.0; }); };
    if (fits(1.0)) return 1.0;
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) (fits(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    return low;
}

class KeyReinhardReference final : public ReferenceModel {
public:
    void plan(ReferenceFrame& frame, std::span<const float> parameters) override {
        const double black = static_cast<double>(frame.display.black_cd_m2), white = static_cast<double>(frame.display.white_cd_m2);
        const double a = std::max(frame.adaptation_cd_m2, 1e-6), scale = static_cast<double>(parameters[0]);
        const bool printed = parameters[1] > 0.5f;
        frame.displayed = [=](double y) { return black + (white - black) * display_luminance(y, a, scale, printed); };
        frame.exposure = frame.displayed(a) / a;
        frame.scene_white_cd_m2 = white / frame.exposure;
    }
    void apply(ReferenceFrame& frame, std::span<const float> parameters) override {
        const double black = static_cast<double>(frame.display.black_cd_m2), white = static_cast<double>(frame.display.white_cd_m2);
        for (std::size_t i = 0; i < frame.image.data.size(); i += 3) {
            double* pixel = &frame.image.data[i];
            const double y = 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2];
            const double r = display_luminance(y, std::max(frame.adaptation_cd_m2, 1e-6), static_cast<double>(parameters[0]), parameters[1] > 0.5f);
            double colour[3];
            for (int c = 0; c < 3; ++c) colour[c] = y > 0 ? pixel[c] * r / y : 0.0;
            const double s = saturation_in_gamut(colour, r);
            for (int c = 0; c < 3; ++c) pixel[c] = black + (white - black) * (r + s * (colour[c] - r));
        }
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_key_reinhard_reference() { return std::make_unique<KeyReinhardReference>(); }

}  // namespace entoptic::perception
