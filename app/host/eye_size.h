// The size of picture that applications should render for one eye.
#pragma once

#include "interfaces/headset.h"

#include <cstdint>

namespace entoptic::app {

struct EyeSize {
    std::uint32_t width = 0, height = 0;
};

// So large that a flat picture over the eye's whole field has at the lens's centre as many pixels a degree as the panel has there, times
// `scale`; the larger of both eyes, even numbers. A lens packs the panel's pixels towards its centre, so this is more than the panel's size.
EyeSize recommended_eye_size(const Headset& headset, double scale);

}  // namespace entoptic::app
