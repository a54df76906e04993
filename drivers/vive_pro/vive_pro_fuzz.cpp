// Every parser of the headset's bytes, its panel's EDID among them. The first byte chooses.
#include "drivers/display/edid.h"
#include "drivers/lighthouse/lighthouse_v1.h"
#include "drivers/vive_pro/vive_pro_calibration.h"
#include "drivers/vive_pro/vive_pro_tracker.h"

#include <string>

using namespace entoptic::drivers;

namespace {

// Reports as a stream: length, report, length, report.
void run_tracker(vive_pro::Bytes data) {
    vive_pro::Calibration calibration;
    for (int i = 0; i < 32; ++i) {
        calibration.channel_map[static_cast<std::size_t>(i)] = i;
        calibration.sensors.push_back({{0.01 * i, 0.05, -0.03 * (i % 3)}, {0, 0, -1}});
    }
    vive_pro::Tracker tracker(calibration, {});
    entoptic::TimeNs now = entoptic::ns_per_s;
    while (data.size() > 1) {
        const std::size_t length = std::min<std::size_t>(data[0] & 127u, data.size() - 1);
        const vive_pro::Bytes report = data.subspan(1, length);
        now += 500'000;
        tracker.imu_report(report, now);
        tracker.light_report(report, now);
        tracker.mainboard_report(report, now);
        data = data.subspan(1 + length);
    }
    const auto pose = tracker.pose_at(now);
    if (!(pose.pose.position.x == pose.pose.position.x)) __builtin_trap();  // NaN must never come out
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const vive_pro::Bytes rest(data + 1, size - 1);
    switch (data[0]) {
        case 'r':
            run_tracker(rest);
            break;
        case 'z':
            if (const auto text = vive_pro::inflate_configuration(rest)) (void)vive_pro::parse_calibration(*text);
            break;
        case 'j':
            (void)vive_pro::parse_calibration(std::string(rest.begin(), rest.end()));
            break;
        case 'e':
            if (const auto edid = parse_edid(rest)) (void)headset_of_edid(*edid);
            break;
        case 'o': {
            lighthouse::OotxDecoder decoder;
            for (const std::uint8_t byte : rest)
                for (int bit = 7; bit >= 0; --bit)
                    if (const auto payload = decoder.add((byte >> bit) & 1)) (void)lighthouse::parse_station(*payload);
            break;
        }
        default:
            (void)vive_pro::parse_imu(rest);
            (void)vive_pro::parse_imu_ranges(rest);
            (void)vive_pro::parse_light(rest);
            (void)vive_pro::parse_light_v2(rest);
            (void)vive_pro::parse_configuration_start(rest);
            (void)vive_pro::parse_configuration_block(rest);
            (void)vive_pro::parse_firmware(rest);
            (void)vive_pro::parse_mainboard(rest);
    }
    return 0;
}
