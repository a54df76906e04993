// foveal_scotoma in double, pixel by pixel over the whole picture, with none of the shader's code.
#include "perception/scotoma/scotoma.h"

#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace entoptic::perception {
namespace {

double smooth(double t) {
    t = std::clamp(t, 0.0, 1.0);
    return t * t * (3 - 2 * t);
}
// CIE 191:2010: cones alone from 5 cd/m² on, rods alone below 0.005.
double cones(double y) { return std::clamp(std::log10(y / 0.005) / std::log10(5 / 0.005), 0.0, 1.0); }

class FovealScotomaReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto parameter = [&](std::size_t i) { return static_cast<double>(values[i]); };
        const double dim = smooth(std::log10(0.1 / frame.adaptation_cd_m2) / std::log10(0.1 / 0.03));
        const glm::dvec3 gaze(frame.eye.gaze_direction);
        for (int y = 0; y < frame.image.height; ++y)
            for (int x = 0; x < frame.image.width; ++x) {
                if (!geometry::geometry_visible(frame.geometry, {x + 0.5, y + 0.5})) continue;
                double* pixel = &frame.image.at(x, y, 0);
                const glm::dvec3 direction = geometry::geometry_direction(frame.geometry, {x + 0.5, y + 0.5});
                const double degrees =
                    std::atan2(glm::length(glm::cross(direction, gaze)), glm::dot(direction, gaze)) * 180 / std::numbers::pi;
                const double blind = 1 - smooth((degrees - parameter(2)) / (parameter(3) - parameter(2)));
                const double own = 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2];
                const double scene = std::max({own, frame.adaptation_cd_m2, 1e-6});
                double share = cones(scene);
                if (parameter(1) < 0.5) {
                    const double panel =
                        frame.displayed ? frame.displayed(scene) : std::min(scene, static_cast<double>(frame.display.white_cd_m2));
                    const double lift = std::max(1.0, static_cast<double>(frame.display.black_cd_m2) / panel);
                    const double wearer = cones(panel * lift);
                    share = cones(scene * lift) < wearer ? cones(scene * lift) / wearer : 1;
                }
                for (int c = 0; c < 3; ++c) pixel[c] *= 1 - parameter(0) * dim * (1 - share) * blind;
            }
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_foveal_scotoma_reference() { return std::make_unique<FovealScotomaReference>(); }

}  // namespace entoptic::perception
