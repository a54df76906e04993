// luidolt_tint in double from the paper, with none of the shader's code. Equation 14 is a blend of two pictures: the tone-mapped one and
// its grey version in the tint's chromaticity; here they are made and blended as whole pictures, in CIE XYZ.
#include "perception/mesopic/mesopic.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

namespace entoptic::perception {
namespace {

// IEC 61966-2-1: linear RGB to XYZ, with the luminance row of BT.709.
const glm::dmat3 xyz_of_rgb = glm::transpose(glm::dmat3(0.4124, 0.3576, 0.1805, 0.2126, 0.7152, 0.0722, 0.0193, 0.1192, 0.9505));

class LuidoltTintReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto parameter = [&](std::size_t i) { return static_cast<double>(values[i]); };
        const double black = static_cast<double>(frame.display.black_cd_m2), white = static_cast<double>(frame.display.white_cd_m2);
        glm::dvec3 tint_xyz = xyz_of_rgb * glm::dvec3(parameter(1), parameter(2), parameter(3));
        if (parameter(5) < 0.5) tint_xyz /= tint_xyz.y;
        const double cones = cone_share(frame.adaptation_cd_m2, parameter(0), parameter(4));
        const glm::dmat3 rgb_of_xyz = glm::inverse(xyz_of_rgb);
        for (std::size_t i = 0; i < frame.image.data.size(); i += 3) {
            double* pixel = &frame.image.data[i];
            const glm::dvec3 xyz = xyz_of_rgb * (glm::dvec3(pixel[0], pixel[1], pixel[2]) - black);
            const glm::dvec3 rgb = rgb_of_xyz * (cones * xyz + (1 - cones) * xyz.y * tint_xyz);
            for (int c = 0; c < 3; ++c) pixel[c] = std::clamp(rgb[c] + black, black, white);
        }
    }

private:
    // 1 - s is the cones' share Y/(0.04 + Y).
    static double cone_share(double y, double strength, double cut) {
        double cones = y / (0.04 + y);
        if (cut > 0) cones = std::min(1.0, cones / (cut / (0.04 + cut)));
        return 1 - strength * (1 - cones);
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_luidolt_tint_reference() { return std::make_unique<LuidoltTintReference>(); }

}  // namespace entoptic::perception
