// What a display says of itself (EDID 1.4, VESA E-EDID A.2), as far as finding a headset's panel needs it. Pure; the bytes are untrusted.
#pragma once

#include "base/result.h"

#include <cstdint>
#include <span>
#include <string>

namespace entoptic::drivers {

struct EdidMode {
    int width = 0, height = 0;              // active pixels
    int total_width = 0, total_height = 0;  // with blanking
    std::int64_t pixel_clock_hz = 0;
    double refresh_hz() const;  // 0 when the mode is none
};

struct Edid {
    std::string vendor;  // three letters: "HVR"
    std::uint16_t product = 0;
    std::uint32_t serial = 0;
    std::string name;  // descriptor FC; may be empty
    int version = 0, revision = 0;
    EdidMode preferred;  // the first detailed timing
};

// Errors: too short, not an EDID, a wrong check sum. Extensions are not looked at.
Result<Edid> parse_edid(std::span<const std::uint8_t> bytes);

// A headset that this project knows by its panel; null for any other display.
const char* headset_of_edid(const Edid& edid);

}  // namespace entoptic::drivers
