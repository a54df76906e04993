// For tests: a room with base stations 1.0, as a set of sensors sees it: flashes with their slow channel, and sweeps.
#pragma once

#include "base/noise.h"
#include "drivers/lighthouse/lighthouse_pose.h"
#include "drivers/lighthouse/lighthouse_v1.h"

#include <Eigen/Geometry>
#include <functional>
#include <zlib.h>

namespace entoptic::drivers::lighthouse::testing {

// The slow channel's bits for a payload: the encoder to OotxDecoder.
inline std::vector<bool> ootx_bits(const std::vector<std::uint8_t>& payload) {
    std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(payload.size()), static_cast<std::uint8_t>(payload.size() >> 8)};
    bytes.insert(bytes.end(), payload.begin(), payload.end());
    if (payload.size() % 2) bytes.push_back(0);
    const auto sum = static_cast<std::uint32_t>(crc32(0, payload.data(), static_cast<uInt>(payload.size())));
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(sum >> (8 * i)));
    std::vector<bool> bits(17, false);
    bits.push_back(true);
    for (std::size_t i = 0; i < bytes.size(); i += 2) {
        for (int b = 15; b >= 0; --b) bits.push_back(((bytes[i] << 8 | bytes[i + 1]) >> b) & 1);
        bits.push_back(true);
    }
    return bits;
}

struct RoomStation {
    Eigen::Isometry3d world_from_station = Eigen::Isometry3d::Identity();
    StationInfo model;              // what its light really does
    std::vector<bool> bits{false};  // slow channel, repeated
};

// Looks from `at` to `target`; its own z points backward.
inline Eigen::Isometry3d looking(const Eigen::Vector3d& at, const Eigen::Vector3d& target) {
    const Eigen::Vector3d z = (at - target).normalized(), x = Eigen::Vector3d::UnitY().cross(z).normalized();
    Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
    out.linear() << x, z.cross(x), z;
    out.translation() = at;
    return out;
}

// A station that looks from `at` to `target` and whose light is as `payload`, the slow channel's 33 bytes, says; where it feels up is written into it.
inline RoomStation station_of(std::vector<std::uint8_t> payload, const Eigen::Vector3d& at, const Eigen::Vector3d& target) {
    RoomStation s;
    s.world_from_station = looking(at, target);
    const Eigen::Vector3d up = s.world_from_station.linear().transpose() * Eigen::Vector3d::UnitY();
    for (int axis = 0; axis < 3; ++axis)
        payload[20 + static_cast<std::size_t>(axis)] = static_cast<std::uint8_t>(static_cast<std::int8_t>(std::lround(up[axis] * 127)));
    s.model = *parse_station(payload);
    s.bits = ootx_bits(payload);
    return s;
}

// One of protocol 6 with perfect rotors that looks at a standing person's chest.
inline RoomStation perfect_station(const Eigen::Vector3d& at, std::uint8_t id) {
    std::vector<std::uint8_t> payload(33, 0);
    payload[0] = 6;
    payload[2] = id;
    return station_of(std::move(payload), at, {0, 1.4, 0});
}

struct Room {
    std::vector<RoomStation> stations;  // one or two
    std::vector<Sensor> sensors;        // head coordinates
    double angle_noise = 5e-5;          // rad, 1 sigma
    std::uint64_t seed = 1;
    std::function<Eigen::Isometry3d(double)> world_from_head;  // at a time, s
    std::vector<bool> hidden = std::vector<bool>(32, false);   // sensors that see nothing

    // Every pulse of sub-frame k, which begins at k / 120 s. In order of time.
    std::vector<Pulse> subframe(std::int64_t k) const {
        std::vector<Pulse> out;
        const std::size_t count = stations.size();
        const std::size_t role = static_cast<std::size_t>(k) % (2 * count);
        const std::size_t sweeping = role / 2;
        const int axis = static_cast<int>(role % 2);
        for (std::size_t s = 0; s < count; ++s) {
            const double start = static_cast<double>(k) * subframe_ticks + static_cast<double>(s) * 19'500;
            const auto& bits = stations[s].bits;
            const bool data = bits[static_cast<std::size_t>(k) % bits.size()];
            const double length = 3000 + 500 * axis + (data ? 1000 : 0) + (s == sweeping ? 0 : 2000);
            for (std::size_t i = 0; i < sensors.size(); ++i) {
                if (!sees(i, stations[s], start)) continue;
                const double weak = 60 * noise01(k, i, s);  // a weak sensor notices late and lets go early
                out.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint16_t>(length - weak), wrap(start + weak / 2)});
            }
        }
        for (std::size_t i = 0; i < sensors.size(); ++i) add_sweep(out, k, i, sweeping, axis);
        std::sort(out.begin(), out.end(), [](const Pulse& a, const Pulse& b) { return static_cast<std::int32_t>(a.ticks - b.ticks) < 0; });
        return out;
    }

private:
    static std::uint32_t wrap(double ticks) { return static_cast<std::uint32_t>(static_cast<std::uint64_t>(std::llround(ticks))); }
    double noise01(std::int64_t k, std::size_t i, std::size_t s) const {
        return uniform01(seed, static_cast<std::uint64_t>(k) * 128 + i * 2 + s);
    }
    Eigen::Vector3d in_station(std::size_t i, const RoomStation& station, double ticks) const {
        return station.world_from_station.inverse() * (world_from_head(ticks / 48e6) * sensors[i].position);
    }
    bool sees(std::size_t i, const RoomStation& station, double ticks) const {
        const Eigen::Vector3d p = in_station(i, station, ticks);
        const Eigen::Vector3d normal =
            station.world_from_station.linear().transpose() * (world_from_head(ticks / 48e6).linear() * sensors[i].normal);
        return !hidden[i] && p.z() < 0 && normal.dot(p.normalized()) < -0.2;
    }
    void add_sweep(std::vector<Pulse>& out, std::int64_t k, std::size_t i, std::size_t sweeping, int axis) const {
        const RoomStation& station = stations[sweeping];
        const double start = static_cast<double>(k) * subframe_ticks + static_cast<double>(sweeping) * 19'500;
        double ticks = start + 200'000;
        for (int pass = 0; pass < 3; ++pass) {  // where the sensor is when the sweep comes by
            const Eigen::Vector3d p = in_station(i, station, ticks);
            ticks = start +
                    (sweep_reading(axis, p.x(), p.y(), p.z(), station.model) + std::numbers::pi / 2) * subframe_ticks / std::numbers::pi;
        }
        if (!sees(i, station, ticks)) return;
        ticks += angle_noise * normal(seed + 1, static_cast<std::uint64_t>(k) * 64 + i) * subframe_ticks / std::numbers::pi;
        const double width = 60 + 500 / std::max(0.3, in_station(i, station, ticks).norm());
        out.push_back({static_cast<std::uint8_t>(i), static_cast<std::uint16_t>(width), wrap(ticks - width / 2)});
    }
};

// A headset's sensors: `count` on the front of an ellipsoid shell, as a Vive Pro has them.
inline std::vector<Sensor> shell_sensors(std::size_t count) {
    std::vector<Sensor> out;
    for (std::size_t i = 0; i < count; ++i) {
        const double y = 1 - 2 * (static_cast<double>(i) + 0.5) / static_cast<double>(count), turn = static_cast<double>(i) * 2.39996;
        const double r = std::sqrt(1 - y * y);
        const Eigen::Vector3d n = Eigen::Vector3d(r * std::cos(turn), y, -std::abs(r * std::sin(turn)) - 0.1).normalized();
        out.push_back({Eigen::Vector3d(0.09, 0.06, 0.07).cwiseProduct(n), n});
    }
    return out;
}

}  // namespace entoptic::drivers::lighthouse::testing
