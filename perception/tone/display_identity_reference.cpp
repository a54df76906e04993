// display_identity in double, with none of the shader's code: percentile and dark share of pixels instead of tiles. The statistics are not
// smoothed: the reference shows the picture as it is when nothing has changed for a while.
#include "perception/tone/reference_gamut.h"
#include "perception/tone/tone.h"
#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>
#include <vector>

namespace entoptic::perception {
namespace {

double smooth(double low, double high, double v) {
    const double x = std::clamp((v - low) / (high - low), 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

// Means of squares of about the size of the GPU's tiles: a lamp of a few pixels is no percentile.
struct Levels {
    double bright = 0, peak = 0, dark_share = 0;
};
Levels levels_of(const ReferenceFrame& frame) {
    const ImageD& image = frame.image;
    Levels levels;
    std::vector<double> means;
    double dark = 0, all = 0, brightest = 0;
    for (int top = 0; top < image.height; top += 8)
        for (int left = 0; left < image.width; left += 32) {
            double light = 0, sr = 0;
            for (int y = top; y < std::min(top + 8, image.height); ++y)
                for (int x = left; x < std::min(left + 32, image.width); ++x) {
                    const double w = geometry::geometry_solid_angle(frame.geometry, {x + 0.5, y + 0.5});
                    if (w <= 0 || !geometry::geometry_visible(frame.geometry, {x + 0.5, y + 0.5})) continue;
                    const double* pixel = &image.at(x, y, 0);
                    light += w * reference_luminance(pixel);
                    sr += w;
                    brightest = std::max(brightest, reference_luminance(pixel));
                    levels.peak = std::max({levels.peak, pixel[0], pixel[1], pixel[2]});
                }
            if (sr <= 0) continue;
            means.push_back(light / sr);
            all += sr;
            if (light / sr < 0.999 * static_cast<double>(frame.display.black_cd_m2)) dark += sr;
        }
    if (means.empty()) return levels;
    std::sort(means.begin(), means.end());
    levels.bright = std::min(brightest, means[std::min(means.size() - 1, static_cast<std::size_t>(0.999 * static_cast<double>(means.size())))]);
    levels.dark_share = dark / all;
    return levels;
}

class DisplayIdentityReference final : public ReferenceModel {
public:
    void plan(ReferenceFrame& frame, std::span<const float> values) override {
        const Levels levels = levels_of(frame);
        const double white = static_cast<double>(frame.display.white_cd_m2), a = std::max(frame.adaptation_cd_m2, 1e-6);
        const double knee = static_cast<double>(values[3]) * white, landing = static_cast<double>(values[1]);
        double night = 1, day = 1;
        if (a < 1) night = std::min(std::pow(a, -static_cast<double>(values[0])), std::max(1.0, knee / std::max(levels.bright, 1e-6)));
        day = std::min(1.0, landing * std::pow(a / landing, static_cast<double>(values[2])) / a);
        const double e = std::pow(night, smooth(0.02, 0.3, levels.dark_share)) * std::pow(day, smooth(0, 1.5, std::log2(std::max(levels.bright, 1e-9) / (1.004 * white))));
        const double soft = smooth(0.01, 1, std::log2(std::max(e * levels.peak, 1e-9) / white));
        frame.exposure = e;
        frame.scene_white_cd_m2 = white / e;
        frame.displayed = [=](double y) {
            const double exposed = e * y, clipped = std::min(exposed, white);
            if (exposed <= knee) return clipped;
            return (1 - soft) * clipped + soft * (white - (white - knee) * std::exp(-(exposed - knee) / (white - knee)));
        };
    }
    void apply(ReferenceFrame& frame, std::span<const float>) override {
        for (std::size_t i = 0; i < frame.image.data.size(); i += 3) {
            const double y = reference_luminance(&frame.image.data[i]);
            show_in_gamut(&frame.image.data[i], y, frame.displayed(y), static_cast<double>(frame.display.white_cd_m2));
        }
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_display_identity_reference() { return std::make_unique<DisplayIdentityReference>(); }

}  // namespace entoptic::perception
