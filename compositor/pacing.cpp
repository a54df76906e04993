#include "compositor/pacing.h"

#include <algorithm>

namespace entoptic::compositor {
namespace {

constexpr std::size_t remembered = 8;
constexpr DurationNs margin = 1'000'000;          // for waking up and for what estimates do not know
// choice, refreshes: an application that fills the period it is told would make a slow pace slower without end.
constexpr std::int64_t longest_told_period = 16;
constexpr std::int64_t prediction_was_wrong = 2;  // refreshes: a frame promised later than this is not held back

std::int64_t median(const std::deque<std::int64_t>& values) {
    std::vector<std::int64_t> sorted(values.begin(), values.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    return *middle;
}

}  // namespace

std::int64_t RefreshGrid::first_at(TimeNs time) const {
    const DurationNs since = time - start;
    if (since <= 0) return 0;
    return (since + period - 1) / period;
}

std::int64_t RefreshGrid::nearest(TimeNs time) const {
    const DurationNs since = time - start + period / 2;
    return since >= 0 ? since / period : -((-since + period - 1) / period);
}

void DurationEstimate::add(DurationNs duration) {
    last_.push_back(duration);
    if (last_.size() > remembered) last_.pop_front();
}

DurationNs DurationEstimate::value() const {
    if (last_.empty()) return before_any_;
    std::vector<DurationNs> sorted(last_.begin(), last_.end());
    std::sort(sorted.begin(), sorted.end());
    return sorted.size() == 1 ? sorted[0] : sorted[sorted.size() - 2];
}

FramePacing::FramePacing(const RefreshGrid& grid) : grid_(grid), composition_(grid.period / 4), application_(grid.period / 4) {}

DurationNs FramePacing::lead() const { return composition_.value() + margin; }

bool FramePacing::keeps_up() const { return lead() <= grid_.period; }

FramePacing::Prediction FramePacing::predict(TimeNs now) {
    TimeNs free = now + application_.value();
    if (composing_) free = std::max(free, composing_since_ + composition_.value());
    Prediction p;
    p.refresh = std::max(grid_.first_at(free + lead()), last_promised_ + 1);
    p.display_time = grid_.light(p.refresh);
    p.start_time = grid_.deadline(p.refresh) - lead() - application_.value() - margin;
    steps_.push_back(last_promised_ < 0 ? 1 : p.refresh - last_promised_);
    if (steps_.size() > remembered) steps_.pop_front();
    p.period = grid_.period * std::clamp<std::int64_t>(median(steps_), 1, longest_told_period);
    last_promised_ = p.refresh;
    return p;
}

FramePacing::Plan FramePacing::plan(TimeNs now) const {
    Plan plan;
    plan.refresh = std::max({grid_.first_at(now + composition_.value()), last_taken_ + 1, last_shown_ + 1});
    plan.wake_time = keeps_up() ? grid_.deadline(plan.refresh) - lead() : now;
    return plan;
}

bool FramePacing::may_show(std::int64_t promised, std::int64_t refresh) const {
    return !keeps_up() || promised <= refresh || promised > refresh + prediction_was_wrong;
}

void FramePacing::taken(std::int64_t refresh, TimeNs now, bool composing) {
    last_taken_ = refresh;
    composing_ = composing;
    composing_since_ = now;
}

// The refresh at `vblank` keeps its number, and so do those near it; far ones, which nobody asks for, move with the period.
void FramePacing::follow(TimeNs vblank, DurationNs period) {
    const std::int64_t refresh = grid_.nearest(vblank);
    grid_.period = period;
    grid_.start = vblank - refresh * period;
}

std::int64_t FramePacing::composed(TimeNs now, TimeNs vblank, DurationNs period) {
    composing_ = false;
    if (!first_composition_) composition_.add(now - composing_since_);
    first_composition_ = false;  // it compiled the shaders
    if (vblank && period > 0) {
        follow(vblank, period);
        last_shown_ = std::max(grid_.nearest(vblank), last_shown_ + 1);
    } else {
        last_shown_ = std::max({last_taken_, grid_.first_at(now), last_shown_ + 1});
    }
    last_taken_ = std::max(last_taken_, last_shown_);
    return last_shown_;
}

PresentationRecord* PresentationLog::find(std::uint64_t frame_id) {
    const auto found = std::find_if(records_.rbegin(), records_.rend(), [&](const auto& r) { return r.frame_id == frame_id; });
    return found == records_.rend() ? nullptr : &*found;
}

void PresentationLog::predicted(std::uint64_t frame_id, TimeNs display_time) {
    records_.push_back({frame_id, display_time, 0, 0, 0});
    if (records_.size() > capacity_) records_.pop_front();
}

void PresentationLog::submitted(std::uint64_t frame_id, TimeNs time) {
    ++counts_.submitted;
    if (PresentationRecord* record = find(frame_id)) record->submitted_time = time;
}

void PresentationLog::discarded(std::uint64_t) { ++counts_.discarded; }

void PresentationLog::shown(std::uint64_t frame_id, std::int64_t refresh, TimeNs light) {
    if (current_) {
        const auto stood = static_cast<std::uint64_t>(std::max<std::int64_t>(refresh - current_->refresh - 1, 0));
        counts_.missed += stood;
        if (PresentationRecord* before = find(current_->frame_id)) before->refreshes_shown += static_cast<std::uint32_t>(stood);
    }
    PresentationRecord* record = find(frame_id);
    const bool again = (current_ && current_->frame_id == frame_id) || (record && record->refreshes_shown > 0);
    if (again)
        ++counts_.reused;
    else
        ++counts_.displayed;
    if (record) {
        if (record->refreshes_shown == 0) record->display_time = light;
        ++record->refreshes_shown;
    }
    current_ = Current{frame_id, refresh};
}

std::vector<PresentationRecord> PresentationLog::records(std::size_t count) const {
    const std::size_t n = std::min(count, records_.size());
    return {records_.end() - static_cast<std::ptrdiff_t>(n), records_.end()};
}

}  // namespace entoptic::compositor
