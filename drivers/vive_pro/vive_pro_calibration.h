// What a headset says of itself: its configuration (zlib-compressed JSON, downloaded in blocks) to lenses, sensor calibration and geometry,
// with units. Two generations of the file exist; both are read. Nothing in it is trusted: sizes are bounded, every number is checked.
//
// Frames: `trackref` is the file's own (x left, y up, z forward), in which lighthouse sensors stand; `head` is OpenXR's (x right, y up,
// -z forward), its origin between the eyes; `imu` is the chip's, as its counts come.
#pragma once

#include "base/pose.h"
#include "base/result.h"
#include "drivers/vive_pro/vive_pro_protocol.h"
#include "interfaces/headset.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace entoptic::drivers::vive_pro {

constexpr std::size_t max_compressed_bytes = 64 * 1024, max_configuration_bytes = 256 * 1024;

struct ImuCalibration {
    // a = scale * counts / 32768 * range - bias, in the chip's axes. Source: facts/devices.md 1.2.
    glm::dvec3 acceleration_scale{1}, acceleration_bias{0};   // bias in m/s²
    glm::dvec3 angular_rate_scale{1}, angular_rate_bias{0};   // bias in rad/s
    glm::dmat3 head_from_imu{1};                              // rotation
    glm::dvec3 position_in_head{0};                           // of the chip, m

    glm::dvec3 acceleration(const ImuSample& sample, const ImuRanges& ranges) const;   // m/s², head axes; at rest +9.8 along up
    glm::dvec3 angular_rate(const ImuSample& sample, const ImuRanges& ranges) const;   // rad/s, head axes
};

struct LighthouseSensor {
    glm::dvec3 position{0}, normal{0};   // m and unit vector, head coordinates
};

struct Calibration {
    std::string model, serial, mainboard_serial;
    bool is_headset = false;             // device_class says so; trackers speak the same protocol
    std::array<Lens, 2> lenses;
    int panel_width = 1440, panel_height = 1600;   // pixels, one eye
    double lens_separation_m = 0.063;
    double persistence_s = 0;            // how long a frame's light lasts
    double vsync_to_photons_s = 0;       // 0 where the file does not say
    ImuCalibration imu;
    std::array<int, 32> channel_map{};   // channel of the receiver -> sensor; -1 none
    std::vector<LighthouseSensor> sensors;
    std::optional<std::uint16_t> edid_vendor, edid_product;   // as in an EDID, e.g. 0x22d2 (HVR), 0xaa02
};

// The compressed stream to text. Errors: not zlib, cut short, larger than max_configuration_bytes.
Result<std::string> inflate_configuration(Bytes compressed);

// Errors name the key and what was expected of it.
Result<Calibration> parse_calibration(const std::string& json);

}  // namespace entoptic::drivers::vive_pro
