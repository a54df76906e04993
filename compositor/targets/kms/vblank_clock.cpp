#include "compositor/targets/kms/vblank_clock.h"

#include <cmath>

namespace entoptic::compositor::kms {
namespace {

constexpr std::size_t remembered = 128;      // choice: over a second of refreshes; one stamp's microsecond is a tenth of that in the line
constexpr std::int64_t measured_after = 32;  // refreshes that a period is measured over at least
constexpr double period_tolerance = 0.01;    // choice: crystals keep 1e-4; a mode's rate that is off by more is not this mode's
constexpr double stamp_tolerance = 0.25;     // periods
constexpr int line_is_wrong_after = 4;       // disbelieved stamps in a row: then the line was wrong, not they

}  // namespace

double VblankClock::expected(std::int64_t sequence) const {
    const Stamp& newest = stamps_.back();
    return static_cast<double>(newest.time) + phase_ns_ + static_cast<double>(sequence - newest.sequence) * period_ns_;
}

VblankClock::Refresh VblankClock::add(const Vblank& vblank) {
    if (!any_) {
        any_ = true;
        last_ = {vblank.sequence, vblank.time};
        stamps_ = {last_};
        return {vblank.time, 0, true};
    }
    const auto passed = static_cast<std::int32_t>(vblank.sequence - static_cast<std::uint32_t>(last_.sequence));
    if (passed == 0) return {0, 0, false};  // flips come without their number going up: nobody counts
    const Stamp stamp{last_.sequence + passed, vblank.time};
    const double off = passed > 0 ? static_cast<double>(stamp.time) - expected(stamp.sequence) : 0;
    if (passed < 0 || std::abs(off) > stamp_tolerance * period_ns_) {
        ++disbelieved_;
        if (++disbelieved_in_a_row_ < line_is_wrong_after) {
            const std::int64_t forward = passed > 0 ? passed : 1;
            last_ = {last_.sequence + forward, static_cast<TimeNs>(std::llround(expected(last_.sequence + forward)))};
            return {last_.time, forward, false};
        }
        *this = [&] {
            VblankClock fresh(nominal_period_ns_);
            fresh.disbelieved_ = disbelieved_;
            return fresh;
        }();
        return add(vblank);
    }
    disbelieved_in_a_row_ = 0;
    stamps_.push_back(stamp);
    if (stamps_.size() > remembered) stamps_.pop_front();
    fit();
    last_ = {stamp.sequence, static_cast<TimeNs>(std::llround(expected(stamp.sequence)))};
    return {last_.time, passed, true};
}

// Relative to the newest stamp, so that doubles keep nanoseconds.
void VblankClock::fit() {
    const Stamp newest = stamps_.back();
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (const Stamp& stamp : stamps_) {
        const auto x = static_cast<double>(stamp.sequence - newest.sequence);
        const auto y = static_cast<double>(stamp.time - newest.time);
        n += 1, sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    period_ns_ = nominal_period_ns_;
    phase_ns_ = 0;  // too few stamps for a line: the newest itself
    if (newest.sequence - stamps_.front().sequence < measured_after) return;
    const double slope = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    if (std::abs(slope / nominal_period_ns_ - 1) > period_tolerance) return;
    period_ns_ = slope;
    phase_ns_ = (sy - period_ns_ * sx) / n;
}

}  // namespace entoptic::compositor::kms
