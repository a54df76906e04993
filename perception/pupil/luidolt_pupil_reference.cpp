// luidolt_pupil in double, by the two-point form of a line.
#include "perception/pupil/pupil.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

class LuidoltPupilReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> v) override {
        const double white = static_cast<double>(v[0]), black = static_cast<double>(v[1]), least = static_cast<double>(v[2]), most = static_cast<double>(v[3]);
        const double d = std::clamp(static_cast<double>(frame.eye.pupil_diameter_mm), std::min(white, black), std::max(white, black));
        const double line = std::abs(black - white) < 0.05 ? 0.5 * (least + most) : ((black - d) * least + (d - white) * most) / (black - white);
        frame.eye.pupil_diameter_mm = static_cast<float>(line);
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_luidolt_pupil_reference() { return std::make_unique<LuidoltPupilReference>(); }

}  // namespace entoptic::perception
