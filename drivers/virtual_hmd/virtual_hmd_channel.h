// A keyframed quantity: N numbers over time, with exact derivatives. A pure function of time.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace entoptic::drivers {

enum class Interpolation {
    linear,  // straight between keys
    smooth,  // monotone cubic (Fritsch and Carlson 1980): continuous velocity, no overshoot, at rest at turning points and at both ends
    hold,    // the key's value until the next key
    saccade  // holds, then jumps to the key's value starting at the key's time, taking saccade_duration_s() (gaze only)
};

// Duration of a saccade of `amplitude_deg`: 21 ms + 2.2 ms/deg, the main sequence (Bahill, Clark and Stark 1975; Carpenter 1988).
constexpr double saccade_duration_s(double amplitude_deg) { return 0.021 + 0.0022 * amplitude_deg; }

// Minimum-jerk course of a movement, 0..1 (Flash and Hogan 1985): at rest at both ends, peak velocity 1.875 of the mean.
constexpr double minimum_jerk(double x) { return x <= 0 ? 0 : x >= 1 ? 1 : x * x * x * (10 + x * (6 * x - 15)); }
constexpr double minimum_jerk_slope(double x) { return x <= 0 || x >= 1 ? 0 : 30 * x * x * (1 - x) * (1 - x); }

template <std::size_t N> struct Key {
    double time = 0;  // s
    std::array<double, N> value{};
};

template <std::size_t N> struct ChannelValue {
    std::array<double, N> value{};
    std::array<double, N> rate{};  // per second
};

// Derivatives at the keys of one component, by Fritsch and Carlson's monotone scheme with harmonic means (Fritsch and Butland 1984).
std::vector<double> monotone_slopes(const std::vector<double>& times, const std::vector<double>& values);

template <std::size_t N> class Channel {
public:
    // A channel that always has `value`.
    explicit Channel(std::array<double, N> value = {}) : keys_{{0.0, value}} {}
    // `keys`: at least one, times finite and strictly increasing.
    Channel(Interpolation interpolation, std::vector<Key<N>> keys) : interpolation_(interpolation), keys_(std::move(keys)) {
        if (interpolation_ == Interpolation::smooth) compute_slopes();
    }

    double end_time() const {
        const Key<N>& last = keys_.back();
        return interpolation_ == Interpolation::saccade && keys_.size() > 1 ? last.time + saccade_duration_s(amplitude(keys_.size() - 1))
                                                                            : last.time;
    }
    const std::vector<Key<N>>& keys() const { return keys_; }
    Interpolation interpolation() const { return interpolation_; }
    // Euclidean distance from key i-1 to key i.
    double amplitude(std::size_t i) const {
        double sum = 0;
        for (std::size_t c = 0; c < N; ++c)
            sum += (keys_[i].value[c] - keys_[i - 1].value[c]) * (keys_[i].value[c] - keys_[i - 1].value[c]);
        return std::sqrt(sum);
    }

    // Before the first key: its value; after the last: its value; there the rate is 0. At a key: the course that follows it.
    ChannelValue<N> at(double time) const {
        const std::size_t next = first_after(time);
        if (next == 0) return {keys_.front().value, {}};
        if (interpolation_ == Interpolation::saccade) return saccade_at(next - 1, time);
        if (next == keys_.size() || interpolation_ == Interpolation::hold) return {keys_[next - 1].value, {}};
        return interpolation_ == Interpolation::linear ? linear_at(next, time) : smooth_at(next, time);
    }

private:
    std::size_t first_after(double time) const {
        std::size_t low = 0, high = keys_.size();
        while (low < high) {
            const std::size_t middle = (low + high) / 2;
            if (keys_[middle].time <= time)
                low = middle + 1;
            else
                high = middle;
        }
        return low;
    }

    ChannelValue<N> linear_at(std::size_t next, double time) const {
        const Key<N>&a = keys_[next - 1], &b = keys_[next];
        const double duration = b.time - a.time, x = (time - a.time) / duration;
        ChannelValue<N> result;
        for (std::size_t c = 0; c < N; ++c) {
            result.value[c] = a.value[c] + x * (b.value[c] - a.value[c]);
            result.rate[c] = (b.value[c] - a.value[c]) / duration;
        }
        return result;
    }

    ChannelValue<N> smooth_at(std::size_t next, double time) const {
        const Key<N>&a = keys_[next - 1], &b = keys_[next];
        const double duration = b.time - a.time, x = (time - a.time) / duration;
        const double x2 = x * x, x3 = x2 * x;
        ChannelValue<N> result;
        for (std::size_t c = 0; c < N; ++c) {
            const double start = a.value[c], change = b.value[c] - a.value[c];
            const double ma = slopes_[next - 1][c] * duration, mb = slopes_[next][c] * duration;
            result.value[c] = start + (3 * x2 - 2 * x3) * change + (x3 - 2 * x2 + x) * ma + (x3 - x2) * mb;
            result.rate[c] = ((6 * x - 6 * x2) * change + (3 * x2 - 4 * x + 1) * ma + (3 * x2 - 2 * x) * mb) / duration;
        }
        return result;
    }

    ChannelValue<N> saccade_at(std::size_t i, double time) const {
        if (i == 0) return {keys_[0].value, {}};
        const double duration = saccade_duration_s(amplitude(i)), x = (time - keys_[i].time) / duration;
        const double share = minimum_jerk(x), slope = minimum_jerk_slope(x) / duration;
        ChannelValue<N> result;
        for (std::size_t c = 0; c < N; ++c) {
            const double from = keys_[i - 1].value[c], to = keys_[i].value[c];
            result.value[c] = share >= 1 ? to : from + share * (to - from);
            result.rate[c] = slope * (to - from);
        }
        return result;
    }

    void compute_slopes() {
        slopes_.resize(keys_.size());
        std::vector<double> times, values(keys_.size());
        for (const Key<N>& key : keys_) times.push_back(key.time);
        for (std::size_t c = 0; c < N; ++c) {
            for (std::size_t i = 0; i < keys_.size(); ++i) values[i] = keys_[i].value[c];
            const std::vector<double> slopes = monotone_slopes(times, values);
            for (std::size_t i = 0; i < keys_.size(); ++i) slopes_[i][c] = slopes[i];
        }
    }

    Interpolation interpolation_ = Interpolation::hold;
    std::vector<Key<N>> keys_;
    std::vector<std::array<double, N>> slopes_;
};

}  // namespace entoptic::drivers
