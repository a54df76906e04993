// krawczyk_tint in double from the paper, with none of the shader's code: a blend of two whole pictures in CIE XYZ, and the scene's
// luminance by bisection of the tone curve.
#include "perception/mesopic/mesopic.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace entoptic::perception {
namespace {

// IEC 61966-2-1: linear RGB to XYZ, with the luminance row of BT.709.
const glm::dmat3 xyz_of_rgb = glm::transpose(glm::dmat3(0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505));

double scene_of(const ReferenceFrame& frame, double displayed) {
    if (!frame.displayed) return displayed;
    double low = 1e-6, high = 1e8;
    for (int i = 0; i < 200; ++i) {
        const double middle = std::sqrt(low * high);
        (frame.displayed(middle) < displayed ? low : high) = middle;
    }
    return high;
}

class KrawczykTintReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto parameter = [&](std::size_t i) { return static_cast<double>(values[i]); };
        const double black = static_cast<double>(frame.display.black_cd_m2), white = static_cast<double>(frame.display.white_cd_m2);
        const glm::dvec3 tint = xyz_of_rgb * glm::dvec3(parameter(2), parameter(3), parameter(4));
        const glm::dmat3 rgb_of_xyz = glm::inverse(xyz_of_rgb);
        for (std::size_t i = 0; i < frame.image.data.size(); i += 3) {
            double* pixel = &frame.image.data[i];
            const glm::dvec3 all = xyz_of_rgb * glm::dvec3(pixel[0], pixel[1], pixel[2]), xyz = all - xyz_of_rgb * glm::dvec3(black);
            double panel = std::max(all.y, 1e-9), scene = scene_of(frame, panel);
            if (panel < black) scene *= black / panel, panel = black;
            double cones = scene / (0.04 + scene);
            if (parameter(1) < 0.5) cones = std::min(1.0, cones / (panel / (0.04 + panel)));
            const double rods = parameter(0) * (1 - cones);
            const glm::dvec3 rgb = rgb_of_xyz * ((1 - rods) * xyz + rods * xyz.y / tint.y * tint);
            for (int c = 0; c < 3; ++c) pixel[c] = rods > 0 ? std::clamp(rgb[c] + black, black, white) : pixel[c];
        }
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_krawczyk_tint_reference() { return std::make_unique<KrawczykTintReference>(); }

}  // namespace entoptic::perception
