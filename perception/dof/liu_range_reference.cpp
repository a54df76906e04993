// liu_range in double, from Liu et al. 2021, equations 4, 5 and 13, in millimetres; light is scattered, not gathered.
#include "perception/dof/dof.h"
#include "perception/dof/dof_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace entoptic::perception {
namespace {

constexpr double f = 22.3;                                           // mm
const double criterion = f * std::tan(std::numbers::pi / 180 / 60);  // c, mm

struct Limits {
    double near, far;  // mm
};
// Equations 4 and 5; where the denominator of 4 is not positive, all that is far is sharp (trap Li2).
Limits limits(double focus, double pupil) {
    const double infinity = std::numeric_limits<double>::infinity();
    if (std::isinf(focus)) return {f * pupil / criterion, infinity};
    const double square = f * f, term = criterion * square / pupil, slope = criterion * f * focus / pupil;
    const double below = square + term - slope;
    return {square * focus / (square - term + slope), below > 0 ? square * focus / below : infinity};
}

class LiuRangeReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto parameter = [&](std::size_t i) { return static_cast<double>(values[i]); };
        if (frame.dioptre.data.empty() || parameter(0) == 0) return;
        if (!follow_focus(frame, parameter(1), parameter(2) > 0.5, parameter(3))) return;
        const double focus = millimetres(frame.focus_dioptre);
        const Limits sharp = limits(focus, static_cast<double>(frame.eye.pupil_diameter_mm));
        const auto disc_of = [&](double dioptre, double pixel_rad) {
            ReferenceDisc disc;
            disc.dioptre = dioptre;
            const double depth = millimetres(dioptre);
            disc.side = depth > focus ? -1 : depth < focus ? 1 : 0;
            if (depth >= sharp.near && depth <= sharp.far) return disc;
            const double ppd = std::numbers::pi / 180 / pixel_rad;
            const double place =
                std::min(1.0, std::abs(parameter(7) > 0.5 ? in_metres(depth, focus, sharp) : in_dioptres(depth, focus, sharp)));
            for (double& radius : disc.radius_px) radius = std::min(32.0, parameter(0) * parameter(4) * place * ppd / 13.85);
            return disc;
        };
        scatter(frame, disc_of, parameter(5) > 0.5);
    }

private:
    static double millimetres(double dioptre) { return dioptre == 0 ? std::numeric_limits<double>::infinity() : 1000 / dioptre; }
    // Equation 13 with the maximum depth of 1000 m.
    static double in_metres(double depth, double focus, const Limits& sharp) {
        const double end = 1e6;
        return (std::min(depth, end) - std::min(focus, end)) / (std::min(sharp.far, end) - std::min(sharp.near, end / 2));
    }
    static double in_dioptres(double depth, double focus, const Limits& sharp) {
        return (1 / focus - 1 / depth) / (1 / sharp.near - 1 / sharp.far);
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_liu_range_reference() { return std::make_unique<LiuRangeReference>(); }

}  // namespace entoptic::perception
