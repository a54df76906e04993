// Base stations 1.0: from flashes and sweeps as sensors see them to bearings. Each station flashes, then sweeps a laser line over the room;
// the time from flash to hit is an angle. Protocol, constants and how they are known: lighthouse.md. No input or output, no clock.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

namespace entoptic::drivers::lighthouse {

constexpr double subframe_ticks = 400'000;  // of 48 MHz: a flash and a sweep, 8.33 ms

// A pulse of light on a sensor.
struct Pulse {
    std::uint8_t sensor = 0;     // 0..31
    std::uint16_t duration = 0;  // ticks
    std::uint32_t ticks = 0;     // beginning, wraps
};

// A sweep of a station over a sensor.
struct Hit {
    int station = 0;  // 0 the one that flashes first, 1 the other
    int axis = 0;     // 0 the sweep that tells left from right, 1 up from down
    std::uint8_t sensor = 0;
    double angle = 0;  // rad, of the rotor from the middle of its sweep; the axis' reading before calibration
    std::uint32_t ticks = 0;
};

// What a station says of itself through its flashes.
struct StationInfo {
    std::uint32_t id = 0;
    std::uint16_t firmware = 0;
    std::uint8_t mode = 0;  // 0 A, 1 B, 2 C
    std::uint8_t faults = 0;
    // Of axis 0 and 1, rad but for the magnitudes' ratio.
    std::array<double, 2> phase{}, tilt{}, curve{}, gibbous_phase{}, gibbous_magnitude{};
    std::array<double, 3> up{};  // in the station's coordinates, unit
};
// The payload of a frame. nullopt: too short, another protocol than 6, numbers that are none.
std::optional<StationInfo> parse_station(std::span<const std::uint8_t> payload);

// The slow channel in the flashes: one bit a flash; frames with a check sum.
class OotxDecoder {
public:
    // The frame's payload, when this bit completed one whose check sum is right.
    std::optional<std::vector<std::uint8_t>> add(bool bit);
    void reset();                                       // a bit was missed
    std::uint64_t damaged() const { return damaged_; }  // frames with a wrong check sum or form

private:
    void begin_frame();
    std::optional<std::vector<std::uint8_t>> finish();

    int zeros_ = 0;
    bool in_frame_ = false;
    int word_bits_ = 0;
    std::uint32_t word_ = 0;
    std::vector<std::uint8_t> bytes_;
    std::uint64_t damaged_ = 0;
};

// Pulses, in any order within 5 ms, to hits.
class SweepDecoder {
public:
    void add(const Pulse& pulse);
    // What has been decoded since the last call. Hits come about 5 ms after their light.
    std::vector<Hit> take_hits();
    // The newest description of a station (0 or 1).
    const std::optional<StationInfo>& station(int index) const { return stations_[static_cast<std::size_t>(index)].info; }
    std::uint64_t flashes() const { return flashes_; }
    std::uint64_t unpaired() const { return unpaired_; }  // flashes that belong to no station that was seen before

private:
    struct Station {
        OotxDecoder ootx;
        std::optional<StationInfo> info;
        std::optional<std::uint32_t> last_flash;
    };
    struct Sweep {
        int station = 0, axis = 0;
        std::uint32_t start = 0;
    };
    void process(const Pulse& pulse);
    void close_cluster();
    void flash(std::uint32_t start, unsigned code);
    int station_of(std::uint32_t start);

    std::deque<Pulse> waiting_;   // by time
    std::vector<Pulse> cluster_;  // one flash as several sensors see it
    std::array<Station, 2> stations_;
    std::optional<std::uint32_t> pair_start_, last_flash_;  // of station 0; of any
    std::uint32_t pair_distance_ = 0;
    std::optional<Sweep> sweep_;
    bool two_sweep_ = false;  // both stations say that they sweep: neither can be believed
    std::vector<Hit> hits_;
    std::uint64_t flashes_ = 0, unpaired_ = 0;
};

// The reading of a sweep for a point in the station's coordinates (x right, y up, z backward: it looks along -z). With a default
// StationInfo it is that of a perfect station. T: double or an automatic derivative.
template <class T> T sweep_reading(int axis, const T& x, const T& y, const T& z, const StationInfo& s) {
    using std::asin;
    using std::atan2;
    using std::cos;
    using std::sqrt;
    const auto i = static_cast<std::size_t>(axis);
    const T depth = -z;
    const T& across = axis == 0 ? x : y;
    const T& along = axis == 0 ? y : x;
    const double sign = axis == 0 ? 1 : -1;
    T a = T(std::numbers::pi / 2) - sign * atan2(across, depth);
    a -= T(s.phase[i]);
    T slant = s.tilt[i] * along / sqrt(across * across + depth * depth);
    if (slant > T(0.99)) slant = T(0.99);
    if (slant < T(-0.99)) slant = T(-0.99);
    a -= asin(slant);
    a -= s.gibbous_magnitude[i] * cos(s.gibbous_phase[i] + a);
    const T elevation = atan2(along, depth);
    a += s.curve[i] * elevation * elevation;
    return a - T(std::numbers::pi / 2);
}

}  // namespace entoptic::drivers::lighthouse
