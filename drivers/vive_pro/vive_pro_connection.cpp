#include "drivers/vive_pro/vive_pro_connection.h"

#include "base/log.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace entoptic::drivers::vive_pro {

namespace {

constexpr int configuration_tries = 5, range_tries = 5;
constexpr std::size_t feature_bytes = 65;  // with the id; hidraw wants room for one more than the report

using FeatureBuffer = std::array<std::uint8_t, feature_bytes>;

Result<Bytes> feature(HidDevice& device, std::uint8_t id, FeatureBuffer& buffer) {
    buffer.fill(0);
    buffer[0] = id;
    ENTOPTIC_TRY(count, device.get_feature(buffer));
    return Bytes(buffer.data(), std::min(count, buffer.size()));
}

std::size_t common_prefix(const std::string& a, const std::string& b) {
    return static_cast<std::size_t>(
        std::mismatch(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(std::min(a.size(), b.size())), b.begin()).first - a.begin());
}

// In one headset both hang on the same hub: the mainboard whose place in the tree is most like the tracking unit's.
HidInfo nearest_mainboard(const std::vector<HidInfo>& boards, const HidInfo& unit) {
    HidInfo best;
    std::size_t most = 0;
    for (const HidInfo& board : boards) {
        const std::size_t same = common_prefix(board.usb_path, unit.usb_path);
        if (best.path.empty() || same > most) {
            best = board;
            most = same;
        }
    }
    return best;
}

bool same_device(const HidInfo& a, const HidInfo& b) { return a.usb_path == b.usb_path && a.product == b.product && a.serial == b.serial; }

ImuRanges read_ranges(HidDevice& device) {
    FeatureBuffer buffer;
    for (int i = 0; i < range_tries; ++i) {
        const auto answer = feature(device, feature_imu_ranges, buffer);
        if (!answer) continue;
        if (const auto ranges = parse_imu_ranges(*answer)) return *ranges;
    }
    log::warn("The headset did not say its sensors' ranges; taking 500 degrees a second and 4 g, which every one seen so far has.");
    return {};
}

}  // namespace

std::vector<Functions> find_headsets(HidBus& bus) {
    const std::vector<HidInfo> valve = bus.list(vendor_valve), htc = bus.list(vendor_htc);
    std::vector<HidInfo> boards;
    for (const HidInfo& info : htc)
        if (info.product == mainboard_vive_pro || (info.product == mainboard_vive && info.interface <= 0)) boards.push_back(info);
    std::vector<Functions> out;
    for (const HidInfo& unit : valve) {
        if ((unit.product != tracking_vive && unit.product != tracking_vive_pro) || unit.interface != imu_interface) continue;
        Functions functions;
        functions.imu = unit;
        functions.is_vive = unit.product == tracking_vive;
        for (const HidInfo& other : valve)
            if (same_device(unit, other) && other.interface == light_interface) functions.light = other;
        functions.mainboard = nearest_mainboard(boards, unit);
        out.push_back(functions);
    }
    return out;
}

Result<std::string> download_configuration(HidDevice& device) {
    FeatureBuffer buffer;
    ENTOPTIC_TRY(start, feature(device, feature_configuration_start, buffer));
    const auto length = parse_configuration_start(start);
    if (!length) return failure("The headset says that its configuration is empty.");
    std::vector<std::uint8_t> compressed;
    for (;;) {
        ENTOPTIC_TRY(answer, feature(device, feature_configuration_block, buffer));
        const auto block = parse_configuration_block(answer);
        if (!block)
            return failure(
                fmt::format("A block of the headset's configuration is malformed, after {} of {} bytes.", compressed.size(), *length));
        if (block->empty()) break;
        compressed.insert(compressed.end(), block->begin(), block->end());
        if (compressed.size() > max_compressed_bytes) return failure("The headset's configuration does not end.");
    }
    // Real streams have been seen two bytes longer than announced, never shorter.
    if (compressed.size() < *length)
        return failure(fmt::format("The headset's configuration came short: {} of {} bytes.", compressed.size(), *length));
    return inflate_configuration(compressed);
}

Result<Connection> connect(HidBus& bus, const Functions& functions) {
    Connection out;
    out.functions = functions;
    ENTOPTIC_TRY(imu, bus.open(functions.imu));
    out.imu = std::move(imu);
    Result<std::string> text = failure("");
    for (int i = 0; i < configuration_tries && !text; ++i) {
        text = download_configuration(*out.imu);
        if (!text) log::debug("Try {} at the headset's configuration: {}", i + 1, text.error().message);
    }
    if (!text) return forward_error(text.error());
    out.configuration = *text;
    ENTOPTIC_TRY(calibration, parse_calibration(out.configuration));
    out.calibration = calibration;
    if (!calibration.is_headset) return missing(fmt::format("{} ({}) is not a headset.", functions.imu.path, calibration.model));
    FeatureBuffer buffer;
    if (const auto answer = feature(*out.imu, feature_firmware, buffer))
        if (const auto firmware = parse_firmware(*answer)) out.firmware = *firmware;
    out.ranges = read_ranges(*out.imu);
    const auto open_optional = [&](const HidInfo& info, const char* what) -> std::unique_ptr<HidDevice> {
        if (info.path.empty()) {
            log::warn("The headset's {} was not found.", what);
            return nullptr;
        }
        auto device = bus.open(info);
        if (device) return std::move(*device);
        log::warn("The headset's {}: {}", what, device.error().message);
        return nullptr;
    };
    out.light = open_optional(functions.light, "light receiver (position)");
    out.mainboard = open_optional(functions.mainboard, "mainboard (display, proximity, lens distance)");
    return out;
}

bool complete(HidBus& bus, Connection& connection) {
    if (connection.light && connection.mainboard) return false;
    bool more = false;
    const auto add = [&](std::unique_ptr<HidDevice>& device, HidInfo& known, const HidInfo& info) {
        if (device || info.path.empty()) return;
        auto opened = bus.open(info);
        if (!opened) return log::debug("{}", opened.error().message);
        device = std::move(*opened);
        known = info;
        more = true;
    };
    for (const Functions& now : find_headsets(bus)) {
        if (now.imu.path != connection.functions.imu.path) continue;
        add(connection.light, connection.functions.light, now.light);
        add(connection.mainboard, connection.functions.mainboard, now.mainboard);
    }
    return more;
}

Result<void> switch_on(Connection& connection) {
    if (connection.mainboard) {
        const auto on = display_power(true);
        if (const auto sent = connection.mainboard->send_feature(on); !sent)
            log::warn("The display was not switched on: {}", sent.error().message);
    }
    if (!connection.light) return {};
    // libsurvive sends these to the first function; where that refuses, the light function may take them.
    const auto send = [](HidDevice& device) -> Result<void> {
        ENTOPTIC_CHECK(device.send_feature(light_on));
        return device.send_feature(light_reset);
    };
    if (send(*connection.imu)) return {};
    return send(*connection.light);
}

void switch_off(Connection& connection) {
    if (!connection.mainboard) return;
    const auto off = display_power(false);
    if (const auto sent = connection.mainboard->send_feature(off); !sent) log::debug("{}", sent.error().message);
}

}  // namespace entoptic::drivers::vive_pro
