// blink in double: the pupil's uncovered area counted out in thin strips.
#include "perception/eyelid/eyelid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace entoptic::perception {
namespace {

class BlinkReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const double radius = static_cast<double>(frame.eye.pupil_diameter_mm) / 2;
        const double edge = (static_cast<double>(frame.eye.eyelid_open) - 0.5) * static_cast<double>(values[0]);
        const int strips = 20000;
        double area = 0;
        for (int i = 0; i < strips; ++i) {
            const double y = radius * (2 * (i + 0.5) / strips - 1);
            if (y < edge) area += 2 * std::sqrt(radius * radius - y * y) * 2 * radius / strips;
        }
        const double past = std::min(area / (std::numbers::pi * radius * radius), 1.0);
        for (std::size_t i = 0; i < frame.image.data.size(); ++i)
            frame.image.data[i] *= past + (1 - past) * static_cast<double>(values[i % 3 == 0 ? 1 : 2]);
    }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_blink_reference() { return std::make_unique<BlinkReference>(); }

}  // namespace entoptic::perception
