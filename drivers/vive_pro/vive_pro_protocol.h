// Reports of the HTC Vive family, bytes to structs and back. Pure: no input or output, no clock, no allocation. Everything is untrusted;
// a report that is too short or of another kind is std::nullopt. Byte by byte and how each is known: vive_pro.md.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace entoptic::drivers::vive_pro {

using Bytes = std::span<const std::uint8_t>;

// ---- USB identities ------------------------------------------------------------------------------------------------------------

constexpr std::uint16_t vendor_htc = 0x0bb4, vendor_valve = 0x28de;
constexpr std::uint16_t mainboard_vive = 0x2c87, mainboard_vive_pro = 0x0309;   // of vendor_htc
constexpr std::uint16_t tracking_vive = 0x2000, tracking_vive_pro = 0x2300;     // of vendor_valve; trackers and the Index have 0x2300, too
constexpr int imu_interface = 0, light_interface = 1;                           // of the tracking unit

// ---- Tracking unit: motion --------------------------------------------------------------------------------------------------------

constexpr std::uint8_t report_imu = 0x20;
constexpr double ticks_per_second = 48e6;   // of every time stamp of the tracking unit

struct ImuSample {
    std::array<std::int16_t, 3> acceleration{}, angular_rate{};   // counts; see ImuRanges
    std::uint32_t ticks = 0;    // wraps after 89.5 s
    std::uint8_t sequence = 0;  // counts samples, wraps
};
// The last three samples in no order: a ring.
using ImuReport = std::array<ImuSample, 3>;
std::optional<ImuReport> parse_imu(Bytes report);

constexpr std::uint8_t feature_imu_ranges = 0x01;
struct ImuRanges {
    double acceleration = 39.2266;      // m/s² at full scale, 32768 counts: 4 g
    double angular_rate = 8.726646;     // rad/s at full scale: 500 degrees a second
};
// nullopt also when the modes are none that exist: the first answer after power-on can be empty.
std::optional<ImuRanges> parse_imu_ranges(Bytes report);

// ---- Tracking unit: light ---------------------------------------------------------------------------------------------------------

constexpr std::uint8_t report_light = 0x25, report_light_wired = 0x21, report_light_v2 = 0x28;
constexpr std::uint8_t light_vsync = 0xfe, light_camera = 0xfd, light_none = 0xff;
constexpr std::uint8_t light_channels = 32;

struct LightEvent {
    std::uint8_t id = light_none;   // 0..31 a channel of the receiver, or light_vsync, light_camera
    std::uint16_t duration = 0;     // ticks of light; 0 for time stamps
    std::uint32_t ticks = 0;        // when it began
};
struct LightReport {
    std::array<LightEvent, 9> events;
    std::size_t count = 0;   // events that are real; empty and half ones are left out
};
// Reports 0x25 (headset) and 0x21 (wired controllers and trackers).
std::optional<LightReport> parse_light(Bytes report);

// Report 0x28, which base stations 2.0 cause: items of a channel's sync and sweeps.
struct LightV2Item {
    enum class Kind { channel, sync, sweep } kind = Kind::channel;
    std::uint8_t channel = 0;     // Kind::channel: 0..15, of the items that follow
    bool conflict = false;        // Kind::channel: two stations on it
    bool ootx_bit = false;        // Kind::sync
    std::uint8_t sensor = 0;      // Kind::sweep: 0..31
    bool half_clock = false;      // Kind::sweep
    std::uint32_t ticks24 = 0;    // Kind::sync, Kind::sweep: low 24 bits of the time
};
struct LightV2Report {
    std::array<LightV2Item, 62> items;
    std::size_t count = 0;
};
std::optional<LightV2Report> parse_light_v2(Bytes report);

// ---- Tracking unit: configuration -----------------------------------------------------------------------------------------------

constexpr std::uint8_t feature_configuration_start = 0x10, feature_configuration_block = 0x11;
constexpr std::size_t configuration_block_bytes = 62;
// Length of the compressed configuration; nullopt for an answer that holds none.
std::optional<std::uint16_t> parse_configuration_start(Bytes report);
// The block's bytes, a part of `report`; empty at the end of the configuration.
std::optional<Bytes> parse_configuration_block(Bytes report);

constexpr std::uint8_t feature_firmware = 0x05;
struct Firmware {
    std::uint32_t version = 0;                    // a date or a hash
    std::uint8_t hardware_major = 0, hardware_minor = 0, hardware_micro = 0;
    std::uint8_t fpga_major = 0, fpga_minor = 0;
};
std::optional<Firmware> parse_firmware(Bytes report);

// What turns the light receiver on, in this order.
constexpr std::array<std::uint8_t, 5> light_on{0x04, 0x00, 0, 0, 0};
constexpr std::array<std::uint8_t, 5> light_reset{0x07, 0x02, 0, 0, 0};

// ---- Mainboard ------------------------------------------------------------------------------------------------------------------

constexpr std::uint8_t report_mainboard = 0x03;
struct MainboardState {
    bool system_button = false;
    std::uint8_t audio_keys = 0;     // Vive Pro: 1 louder, 2 quieter, 4 microphone off
    std::uint16_t proximity = 0;     // raw: about 36 with nobody near, up to 1900
    std::uint16_t ipd_10um = 0;      // lens distance, 0.01 mm
};
// Other types of report with this id are nullopt.
std::optional<MainboardState> parse_mainboard(Bytes report);

constexpr std::size_t display_power_bytes = 64;
// The feature report that switches the display on or off.
std::array<std::uint8_t, display_power_bytes> display_power(bool on);

// Whether somebody wears the headset, with hysteresis. choice: worn from 80 (Monado's threshold) on, off again below 60; idle is 35..40.
class WornState {
public:
    bool update(std::uint16_t proximity);

private:
    bool worn_ = false;
};

}  // namespace entoptic::drivers::vive_pro
