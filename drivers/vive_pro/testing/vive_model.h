// For tests: a Vive Pro as its USB functions show it. Answers feature reports, makes input reports from a known motion in a known room, and
// fails to order. It is the device's side of drivers/vive_pro/vive_pro.md, written from there and not from the driver.
#pragma once

#include "drivers/fusion/testing/head_motion.h"
#include "drivers/lighthouse/testing/lighthouse_room.h"
#include "drivers/vive_pro/vive_pro_calibration.h"

#include <atomic>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <stdexcept>
#include <zlib.h>

namespace entoptic::drivers::vive_pro::testing {

using Report = std::vector<std::uint8_t>;

// An invented headset's configuration, in the form that Vive Pros have.
inline std::string example_configuration() {
    std::ifstream file(std::string(ENTOPTIC_SOURCE_DIR) + "/drivers/vive_pro/testing/vive_pro_example.json");
    if (!file) throw std::runtime_error("drivers/vive_pro/testing/vive_pro_example.json is missing");
    return {std::istreambuf_iterator<char>(file), {}};
}

inline Report deflate_text(const std::string& text) {
    Report out(compressBound(text.size()));
    uLongf size = out.size();
    if (compress2(out.data(), &size, reinterpret_cast<const Bytef*>(text.data()), text.size(), 9) != Z_OK) throw std::runtime_error("zlib");
    out.resize(size);
    return out;
}

class ViveModel {
public:
    explicit ViveModel(std::string configuration = example_configuration())
        : compressed_(deflate_text(configuration)), calibration_(*parse_calibration(configuration)) {
        for (const LighthouseSensor& s : calibration_.sensors)
            room.sensors.push_back({{s.position.x, s.position.y, s.position.z}, {s.normal.x, s.normal.y, s.normal.z}});
        room.world_from_head = [this](double t) {
            return Eigen::Isometry3d(Eigen::Translation3d(motion.position(t)) * motion.orientation(t));
        };
    }
    ViveModel(const ViveModel&) = delete;
    ViveModel& operator=(const ViveModel&) = delete;

    drivers::testing::HeadMotion motion;
    drivers::testing::SensorErrors errors;
    lighthouse::testing::Room room;           // no stations: no light
    std::uint32_t clock_offset = 0x4ca08a5a;  // ticks at time 0
    double clock_ppm = 0;
    std::uint8_t sequence_offset = 0;
    std::uint16_t ipd_10um = 6480, proximity = 37;
    bool system_button = false;

    // Faults.
    int stalled_configurations = 0;  // the first so many queries are refused
    int short_configurations = 0;    // the first so many downloads end early
    int corrupt_configurations = 0;  // ... come with a wrong byte
    bool empty_ranges_first = true;  // as real ones do

    // What the host has set.
    std::atomic<bool> display_on = false, light_is_on = false;
    std::atomic<int> feature_sets = 0;

    const Calibration& calibration() const { return calibration_; }

    // nullopt: STALL. Function 0 IMU, 1 light, 2 mainboard.
    std::optional<Report> get_feature(int function, std::uint8_t id) {
        Report out(64, 0);
        out[0] = id;
        if (function == 2) return std::nullopt;
        if (id == 0x10) {
            if (stalled_configurations > 0) {
                --stalled_configurations;
                return std::nullopt;
            }
            at_ = 0;
            out[1] = static_cast<std::uint8_t>(compressed_.size() >> 8);
            out[2] = static_cast<std::uint8_t>(compressed_.size());
            return out;
        }
        if (id == 0x11) return configuration_block(std::move(out));
        if (id == 0x01) {
            if (empty_ranges_first)
                empty_ranges_first = false;
            else
                out[1] = out[2] = out[3] = 1;
            return out;
        }
        if (id == 0x05) {
            out[41] = 3, out[42] = 2, out[43] = 1, out[49] = 7, out[50] = 8;
            return out;
        }
        return std::nullopt;
    }
    bool set_feature(int function, std::span<const std::uint8_t> report) {
        ++feature_sets;
        if (function == 2) {
            constexpr std::uint8_t on[] = {0x04, 0x78, 0x29, 0x38, 1, 0, 0, 0, 0, 0, 2, 0, 1},
                                   off[] = {0x04, 0x78, 0x29, 0x38, 0, 0, 0, 0, 0, 0, 2, 0, 0};
            if (report.size() < sizeof on) return false;
            if (std::memcmp(report.data(), on, sizeof on) == 0) return display_on = true;
            if (std::memcmp(report.data(), off, sizeof off) == 0) return display_on = false, true;
            return false;
        }
        if (report.empty()) return false;
        if (report[0] == 0x04) return light_is_on = report.size() >= 2 && report[1] == 0, true;
        return report[0] == 0x07;
    }

    // After sample n (n/1000 s): the last three samples in a ring.
    Report imu_report(std::int64_t n) const {
        Report out(52, 0);
        out[0] = 0x20;
        for (std::int64_t back = 0; back < 3; ++back) {
            const std::int64_t k = std::max<std::int64_t>(0, n - back);
            put_sample(out, 1 + 17 * static_cast<std::size_t>(k % 3), k);
        }
        return out;
    }
    // All of sub-frame k (k/120 s), nine events a report, not quite in order.
    std::vector<Report> light_reports(std::int64_t k) const {
        std::vector<Report> out;
        if (room.stations.empty()) return out;
        std::vector<lighthouse::Pulse> pulses = room.subframe(k);
        for (std::size_t i = 1; i + 1 < pulses.size(); i += 3) std::swap(pulses[i], pulses[i + 1]);
        for (std::size_t i = 0; i < pulses.size(); i += 9) {
            Report report(64, 0xff);
            report[0] = 0x25;
            for (std::size_t j = 0; j < 9 && i + j < pulses.size(); ++j) {
                const lighthouse::Pulse& p = pulses[i + j];
                std::uint8_t* at = &report[1 + 7 * j];
                at[0] = p.sensor;
                put(at + 1, p.duration, 2);
                put(at + 3,
                    clock_offset + static_cast<std::uint32_t>(static_cast<std::int64_t>(static_cast<double>(p.ticks) * clock_ppm * 1e-6)) +
                        p.ticks,
                    4);
            }
            out.push_back(std::move(report));
        }
        return out;
    }
    Report mainboard_report() const {
        Report out(64, 0);
        const std::uint8_t head[] = {0x03, 0xd0, 0x2c, 0x3c, 0x27, 0x06};
        std::copy(std::begin(head), std::end(head), out.begin());
        out[8] = system_button ? 1 : 0;
        put(&out[14], proximity, 2);
        put(&out[16], ipd_10um, 2);
        return out;
    }

private:
    static void put(std::uint8_t* at, std::uint32_t value, int bytes) {
        for (int i = 0; i < bytes; ++i) at[i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
    static std::int16_t count(double value) { return static_cast<std::int16_t>(std::lround(std::clamp(value, -32768.0, 32767.0))); }

    Report configuration_block(Report out) {
        std::size_t size = compressed_.size();
        if (short_configurations > 0) size /= 2;
        const std::size_t length = std::min<std::size_t>(62, size - std::min(size, at_));
        out[1] = static_cast<std::uint8_t>(length);
        std::copy_n(compressed_.begin() + static_cast<std::ptrdiff_t>(at_), length, out.begin() + 2);
        if (corrupt_configurations > 0 && at_ > 600 && at_ < 700) out[20] ^= 0x55;
        at_ += length;
        if (length == 0) {
            short_configurations = std::max(0, short_configurations - 1);
            corrupt_configurations = std::max(0, corrupt_configurations - 1);
        }
        return out;
    }
    void put_sample(Report& out, std::size_t at, std::int64_t k) const {
        const double t = static_cast<double>(k) * 1e-3;
        const ImuCalibration& c = calibration_.imu;
        const Eigen::Vector3d place(c.position_in_head.x, c.position_in_head.y, c.position_in_head.z);
        const InertialSample s = drivers::testing::inertial_sample(motion, errors, t, place);
        const glm::dmat3 imu_from_head = glm::transpose(c.head_from_imu);
        const glm::dvec3 a = imu_from_head * glm::dvec3(s.acceleration.x(), s.acceleration.y(), s.acceleration.z());
        const glm::dvec3 w = imu_from_head * glm::dvec3(s.rate.x(), s.rate.y(), s.rate.z());
        for (int axis = 0; axis < 3; ++axis) {
            const double acc = (a[axis] + c.acceleration_bias[axis]) / c.acceleration_scale[axis] * 32768 / 39.2266;
            const double rate = (w[axis] + c.angular_rate_bias[axis]) / c.angular_rate_scale[axis] * 32768 / 8.726646;
            put(&out[at + 2 * static_cast<std::size_t>(axis)], static_cast<std::uint16_t>(count(acc)), 2);
            put(&out[at + 6 + 2 * static_cast<std::size_t>(axis)], static_cast<std::uint16_t>(count(rate)), 2);
        }
        put(&out[at + 12],
            clock_offset + static_cast<std::uint32_t>(std::llround(static_cast<double>(k) * 48'000 * (1 + clock_ppm * 1e-6))), 4);
        out[at + 16] = static_cast<std::uint8_t>(k + sequence_offset);
    }

    Report compressed_;
    Calibration calibration_;
    std::size_t at_ = 0;
};

}  // namespace entoptic::drivers::vive_pro::testing
