#include "drivers/lighthouse/lighthouse_v1.h"

#include <algorithm>
#include <utility>
#include <zlib.h>

namespace entoptic::drivers::lighthouse {

namespace {

// Lengths of pulses in ticks. A flash has 3000 + 500 code, weaker sensors see it shorter; a sweep is over a sensor for 30 to 1200.
constexpr unsigned shortest_flash = 2400, longest_flash = 6700, longest_sweep = 2000;
constexpr std::int32_t same_flash = 500;  // how much later weak sensors see it begin
constexpr std::size_t flash_sensors = 3;
constexpr std::int32_t disorder = 240'000;                     // 5 ms; at most 4.2 ms in recordings
constexpr std::int32_t pair_near = 18'000, pair_far = 21'500;  // from station 0's flash to station 1's; 19 000..20 000 in recordings
constexpr std::int32_t phase_slack = 3'000;
constexpr std::int32_t forget_pair = 48'000'000;  // a second
constexpr std::int32_t sweep_begin = 40'000, sweep_end = 360'000;
constexpr std::size_t longest_payload = 64, station_payload = 33;

std::int32_t after(std::uint32_t a, std::uint32_t b) { return static_cast<std::int32_t>(a - b); }

// IEEE 754 binary16.
double half_float(std::uint16_t h) {
    const double sign = h & 0x8000u ? -1 : 1;
    const int exponent = (h >> 10) & 31, mantissa = h & 1023;
    if (exponent == 31) return std::nan("");
    if (exponent == 0) return sign * std::ldexp(mantissa, -24);
    return sign * std::ldexp(1024 + mantissa, exponent - 25);
}

}  // namespace

std::optional<StationInfo> parse_station(std::span<const std::uint8_t> p) {
    if (p.size() < station_payload) return std::nullopt;
    const auto u16 = [&](std::size_t at) { return static_cast<std::uint16_t>(p[at] | p[at + 1] << 8); };
    const auto i8 = [&](std::size_t at) { return static_cast<double>(static_cast<std::int8_t>(p[at])); };
    if ((u16(0) & 63u) != 6) return std::nullopt;
    StationInfo s;
    s.firmware = u16(0) >> 6;
    s.id = u16(2) | static_cast<std::uint32_t>(u16(4)) << 16;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        s.phase[axis] = half_float(u16(6 + 2 * axis));
        s.tilt[axis] = half_float(u16(10 + 2 * axis));
        s.curve[axis] = half_float(u16(16 + 2 * axis));
        s.gibbous_phase[axis] = half_float(u16(23 + 2 * axis));
        s.gibbous_magnitude[axis] = half_float(u16(27 + 2 * axis));
        // A calibration is a correction: real ones are below 0.1 rad, phases of the gibbous term go round.
        for (const double v : {s.phase[axis], s.tilt[axis], s.curve[axis], s.gibbous_magnitude[axis]})
            if (!(std::abs(v) < 0.5)) return std::nullopt;
        if (!(std::abs(s.gibbous_phase[axis]) < 10)) return std::nullopt;
    }
    s.up = {i8(20), i8(21), i8(22)};
    const double length = std::hypot(s.up[0], s.up[1], s.up[2]);
    if (length < 60) return std::nullopt;  // 127 is 1 g
    for (double& u : s.up) u /= length;
    s.mode = p[31];
    s.faults = p[32];
    return s;
}

// ---- OOTX ---------------------------------------------------------------------------------------------------------------------------------

void OotxDecoder::reset() {
    zeros_ = 0;
    in_frame_ = false;
}

void OotxDecoder::begin_frame() {
    in_frame_ = true;
    word_bits_ = 0;
    word_ = 0;
    bytes_.clear();
}

// 17 zeros and a one begin a frame; then words of 16 bits, high bit first, each followed by a one.
std::optional<std::vector<std::uint8_t>> OotxDecoder::add(bool bit) {
    if (bit && zeros_ >= 17) {  // also inside a frame: no frame has 17 zeros in a row
        if (in_frame_) ++damaged_;
        zeros_ = 0;
        begin_frame();
        return std::nullopt;
    }
    zeros_ = bit ? 0 : zeros_ + 1;
    if (!in_frame_) return std::nullopt;
    if (word_bits_ == 16) {
        if (!bit) {
            ++damaged_;
            in_frame_ = false;
            return std::nullopt;
        }
        word_bits_ = 0;
        word_ = 0;
        return std::nullopt;
    }
    word_ = word_ << 1 | (bit ? 1u : 0u);
    if (++word_bits_ < 16) return std::nullopt;
    bytes_.push_back(static_cast<std::uint8_t>(word_ >> 8));
    bytes_.push_back(static_cast<std::uint8_t>(word_));
    return finish();
}

// Length (2 bytes), payload padded to even, check sum (4 bytes).
std::optional<std::vector<std::uint8_t>> OotxDecoder::finish() {
    const std::size_t length = bytes_[0] | static_cast<std::size_t>(bytes_[1]) << 8;
    if (length == 0 || length > longest_payload) {
        ++damaged_;
        in_frame_ = false;
        return std::nullopt;
    }
    const std::size_t padded = length + length % 2;
    if (bytes_.size() < 2 + padded + 4) return std::nullopt;
    in_frame_ = false;
    const std::uint8_t* sum = bytes_.data() + 2 + padded;
    const std::uint32_t expected = sum[0] | sum[1] << 8 | sum[2] << 16 | static_cast<std::uint32_t>(sum[3]) << 24;
    if (crc32(0, bytes_.data() + 2, static_cast<uInt>(length)) != expected) {
        ++damaged_;
        return std::nullopt;
    }
    return std::vector<std::uint8_t>(bytes_.begin() + 2, bytes_.begin() + 2 + static_cast<std::ptrdiff_t>(length));
}

// ---- Sweeps -----------------------------------------------------------------------------------------------------------------------------

void SweepDecoder::add(const Pulse& pulse) {
    // A time far from the others is a damaged record, or the counter began anew: then nothing before it counts.
    if (!waiting_.empty() && std::abs(static_cast<double>(after(pulse.ticks, waiting_.back().ticks))) > forget_pair) {
        waiting_.clear();
        cluster_.clear();
        sweep_.reset();
    }
    auto place = waiting_.end();
    while (place != waiting_.begin() && after(pulse.ticks, (place - 1)->ticks) < 0) --place;
    waiting_.insert(place, pulse);
    while (after(waiting_.back().ticks, waiting_.front().ticks) > disorder) {
        process(waiting_.front());
        waiting_.pop_front();
    }
}

std::vector<Hit> SweepDecoder::take_hits() { return std::exchange(hits_, {}); }

void SweepDecoder::process(const Pulse& pulse) {
    if (!cluster_.empty() && after(pulse.ticks, cluster_.front().ticks) > same_flash) close_cluster();
    if (pulse.duration >= shortest_flash) {
        if (pulse.duration <= longest_flash) cluster_.push_back(pulse);
        return;
    }
    if (pulse.duration >= longest_sweep || !sweep_ || two_sweep_) return;
    const std::int32_t since = after(pulse.ticks, sweep_->start);
    const double ticks = since + pulse.duration / 2.0;
    if (since < sweep_begin || since > sweep_end) return;
    hits_.push_back({sweep_->station, sweep_->axis, pulse.sensor, ticks * std::numbers::pi / subframe_ticks - std::numbers::pi / 2,
                     pulse.ticks + pulse.duration / 2u});
    if (hits_.size() > 10'000) hits_.erase(hits_.begin(), hits_.begin() + 5'000);  // nobody takes them
}

// The best-lit sensors see the flash's true length; the upper quartile is sure to be one of them and no outlier.
void SweepDecoder::close_cluster() {
    if (cluster_.size() >= flash_sensors) {
        std::vector<unsigned> lengths;
        for (const Pulse& pulse : cluster_) lengths.push_back(pulse.duration);
        const auto upper = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() * 3 / 4);
        std::nth_element(lengths.begin(), upper, lengths.end());
        const double code = std::clamp(std::ceil((double(*upper) - 3060) / 500), 0.0, 7.0);
        flash(cluster_.front().ticks, static_cast<unsigned>(code));
    }
    cluster_.clear();
}

// Which station flashed. A flash about 20 000 ticks after another is the second one's. A lone flash is told by its phase against the last
// pair: the other station may be hidden.
int SweepDecoder::station_of(std::uint32_t start) {
    if (last_flash_) {
        const std::int32_t since = after(start, *last_flash_);
        if (since > pair_near && since < pair_far) {
            pair_start_ = *last_flash_;
            pair_distance_ = start - *last_flash_;
            return 1;
        }
    }
    if (pair_start_ && after(start, *pair_start_) < forget_pair) {
        const double since = after(start, *pair_start_);
        const double phase = since - std::round(since / subframe_ticks) * subframe_ticks;
        if (std::abs(phase) < phase_slack) return 0;
        if (std::abs(phase - pair_distance_) < phase_slack) return 1;
        ++unpaired_;
    }
    return 0;
}

void SweepDecoder::flash(std::uint32_t start, unsigned code) {
    const int index = station_of(start);
    const int axis = static_cast<int>(code & 1u);
    const bool data = (code & 2u) != 0, skips = (code & 4u) != 0;
    ++flashes_;
    const bool same_subframe = index == 1 && last_flash_ && after(start, *last_flash_) < pair_far;
    last_flash_ = start;
    Station& station = stations_[static_cast<std::size_t>(index)];
    if (station.last_flash && after(start, *station.last_flash) > 1.5 * subframe_ticks) station.ootx.reset();
    station.last_flash = start;
    if (const auto payload = station.ootx.add(data))
        if (const auto info = parse_station(*payload)) station.info = info;
    if (!same_subframe) {
        sweep_.reset();
        two_sweep_ = false;
    }
    if (skips) return;
    two_sweep_ = sweep_.has_value();
    sweep_ = Sweep{index, axis, start};
}

}  // namespace entoptic::drivers::lighthouse
