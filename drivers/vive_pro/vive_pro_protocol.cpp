#include "drivers/vive_pro/vive_pro_protocol.h"

#include <algorithm>
#include <numbers>

namespace entoptic::drivers::vive_pro {

namespace {

constexpr std::size_t imu_slot_bytes = 17, light_event_bytes = 7;
constexpr std::uint16_t half_event = 0xffff;
constexpr double standard_gravity = 9.80665;   // m/s², CGPM 1901

// Callers have checked that the bytes are there.
std::uint16_t u16(Bytes b, std::size_t at) { return static_cast<std::uint16_t>(b[at] | b[at + 1] << 8); }
std::int16_t i16(Bytes b, std::size_t at) { return static_cast<std::int16_t>(u16(b, at)); }
std::uint32_t u32(Bytes b, std::size_t at) { return u16(b, at) | static_cast<std::uint32_t>(u16(b, at + 2)) << 16; }

bool is(Bytes report, std::uint8_t id, std::size_t bytes) { return report.size() >= bytes && report[0] == id; }

void add_light(LightReport& out, LightEvent event) {
    const bool sensor = event.id < light_channels, stamp = event.id == light_vsync || event.id == light_camera;
    if ((!sensor && !stamp) || event.duration == half_event) return;
    out.events[out.count++] = event;
}

LightReport parse_headset_light(Bytes report) {
    LightReport out;
    for (std::size_t at = 1; at + light_event_bytes <= 64; at += light_event_bytes)
        add_light(out, {report[at], u16(report, at + 1), u32(report, at + 3)});
    return out;
}

LightReport parse_wired_light(Bytes report) {
    LightReport out;
    for (std::size_t at = 1; at + 8 <= 57; at += 8) {
        const std::uint16_t id = u16(report, at);
        if (id <= 0xff) add_light(out, {static_cast<std::uint8_t>(id), u16(report, at + 2), u32(report, at + 4)});
    }
    return out;
}

LightV2Item v2_word(std::uint32_t word) {
    LightV2Item item;
    if (word & 2u) {
        item.kind = LightV2Item::Kind::sweep;
        item.sensor = static_cast<std::uint8_t>(word >> 27);
        item.ticks24 = (word >> 3) & 0xffffffu;
        item.half_clock = (word & 4u) != 0;
    } else {
        item.kind = LightV2Item::Kind::sync;
        item.ootx_bit = ((word >> 26) & 1u) != 0;
        item.ticks24 = (word >> 2) & 0xffffffu;
    }
    return item;
}

}  // namespace

std::optional<ImuReport> parse_imu(Bytes report) {
    if (!is(report, report_imu, 1 + 3 * imu_slot_bytes)) return std::nullopt;
    ImuReport samples;
    for (std::size_t slot = 0; slot < samples.size(); ++slot) {
        const std::size_t at = 1 + slot * imu_slot_bytes;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            samples[slot].acceleration[axis] = i16(report, at + 2 * axis);
            samples[slot].angular_rate[axis] = i16(report, at + 6 + 2 * axis);
        }
        samples[slot].ticks = u32(report, at + 12);
        samples[slot].sequence = report[at + 16];
    }
    return samples;
}

std::optional<ImuRanges> parse_imu_ranges(Bytes report) {
    if (!is(report, feature_imu_ranges, 3)) return std::nullopt;
    const unsigned gyro_mode = report[1], acceleration_mode = report[2];
    // An unanswered query is all zeros, which would also be +-250 deg/s and +-2 g; no headset seen uses those.
    if (gyro_mode > 4 || acceleration_mode > 4 || (gyro_mode == 0 && acceleration_mode == 0)) return std::nullopt;
    return ImuRanges{2 * standard_gravity * (1u << acceleration_mode), 250 * std::numbers::pi / 180 * (1u << gyro_mode)};
}

std::optional<LightReport> parse_light(Bytes report) {
    if (is(report, report_light, 64)) return parse_headset_light(report);
    if (is(report, report_light_wired, 57)) return parse_wired_light(report);
    return std::nullopt;
}

std::optional<LightV2Report> parse_light_v2(Bytes report) {
    if (!is(report, report_light_v2, 2)) return std::nullopt;
    const std::size_t length = report[1];
    if (length + 2 > report.size() || length > 62) return std::nullopt;
    const Bytes payload = report.subspan(2, length);
    LightV2Report out;
    for (std::size_t at = 0; at < payload.size();) {
        if (payload[at] & 1u) {
            LightV2Item item;
            item.channel = payload[at] >> 4;
            item.conflict = (payload[at] & 4u) != 0;
            out.items[out.count++] = item;
            ++at;
        } else {
            if (at + 4 > payload.size()) return std::nullopt;
            out.items[out.count++] = v2_word(u32(payload, at));
            at += 4;
        }
    }
    return out;
}

std::optional<std::uint16_t> parse_configuration_start(Bytes report) {
    if (!is(report, feature_configuration_start, 3)) return std::nullopt;
    const auto length = static_cast<std::uint16_t>(report[1] << 8 | report[2]);   // the one big-endian number of the protocol
    return length > 0 ? std::optional(length) : std::nullopt;
}

std::optional<Bytes> parse_configuration_block(Bytes report) {
    if (!is(report, feature_configuration_block, 2)) return std::nullopt;
    const std::size_t length = report[1];
    if (length > configuration_block_bytes || length + 2 > report.size()) return std::nullopt;
    return report.subspan(2, length);
}

std::optional<Firmware> parse_firmware(Bytes report) {
    if (!is(report, feature_firmware, 51)) return std::nullopt;
    Firmware firmware;
    firmware.version = u32(report, 1);
    firmware.hardware_micro = report[41];
    firmware.hardware_minor = report[42];
    firmware.hardware_major = report[43];
    firmware.fpga_minor = report[49];
    firmware.fpga_major = report[50];
    return firmware;
}

std::optional<MainboardState> parse_mainboard(Bytes report) {
    constexpr std::uint16_t state_type = 0x2cd0;
    constexpr std::uint8_t state_length = 0x3c;
    if (!is(report, report_mainboard, 18) || u16(report, 1) != state_type || report[3] != state_length) return std::nullopt;
    return MainboardState{report[8] == 1, report[9], u16(report, 14), u16(report, 16)};
}

std::array<std::uint8_t, display_power_bytes> display_power(bool on) {
    std::array<std::uint8_t, display_power_bytes> report{0x04, 0x78, 0x29, 0x38};
    report[4] = on ? 1 : 0;
    report[10] = 2;
    report[12] = on ? 1 : 0;
    return report;
}

bool WornState::update(std::uint16_t proximity) {
    constexpr std::uint16_t put_on = 80, taken_off = 60;
    worn_ = worn_ ? proximity >= taken_off : proximity >= put_on;
    return worn_;
}

}  // namespace entoptic::drivers::vive_pro
