// pattanaik_slow in double: the pigments by many small explicit steps of their differential equations instead of the closed form.
#include "perception/adaptation/adaptation.h"
#include "perception/adaptation/reference_target.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

class PattanaikSlowReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto parameter = [&](std::size_t i) { return static_cast<double>(values[i]); };
        const double floor = parameter(2);
        const double target = std::max(reference_target(frame, {parameter(0), parameter(1), parameter(3), parameter(4) > 0.5}), floor);
        if (frame.snap || frame.adaptation_cd_m2 <= 0) {
            settle(target);
            frame.adaptation_cd_m2 = target;
            return;
        }
        if (frame.eye.eyelid_open < 0.5f || !(frame.dt_s > 0)) return;
        if (neural_ <= 0) settle(frame.adaptation_cd_m2);
        const double rod = 0.04 / (0.04 + target), tau = rod * parameter(6) + (1 - rod) * parameter(7);
        neural_ = std::max(floor, target * std::pow(neural_ / target, std::exp(-frame.dt_s * parameter(5) / tau)));
        integrate(rods_, 400, 16, target, frame.dt_s * parameter(8));
        integrate(cones_, 110, 2.2e8, target, frame.dt_s * parameter(8));
        const double rod_light = 0.04 * (1 - rods_) / rods_, cone_light = 2e6 * (1 - cones_) / cones_;
        frame.adaptation_cd_m2 = std::max(neural_, std::min(rod_light, cone_light));
    }

private:
    void settle(double y) {
        neural_ = y;
        rods_ = 1 / (1 + y * 400 / 16);
        cones_ = 1 / (1 + y * 110 / 2.2e8);
    }
    // du/dt = (1 - u)/t0 - u Y/K by the classical Runge-Kutta method, with steps of at most a hundredth of the time constant.
    static void integrate(double& u, double t0, double k, double y, double dt) {
        const auto slope = [&](double v) { return (1 - v) / t0 - v * y / k; };
        const double tau = 1 / (1 / t0 + y / k);
        if (dt > 40 * tau) {
            u = 1 / (1 + y * t0 / k);
            return;
        }
        const int steps = std::max(1, static_cast<int>(std::ceil(dt / (0.01 * tau))));
        for (int i = 0; i < steps; ++i) {
            const double h = dt / steps, a = slope(u), b = slope(u + h / 2 * a), c = slope(u + h / 2 * b), d = slope(u + h * c);
            u += h / 6 * (a + 2 * b + 2 * c + d);
        }
    }
    double neural_ = 0, rods_ = 1, cones_ = 1;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_pattanaik_slow_reference() { return std::make_unique<PattanaikSlowReference>(); }

}  // namespace entoptic::perception
