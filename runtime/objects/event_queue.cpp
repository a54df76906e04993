#include "runtime/objects/event_queue.h"

namespace entoptic::runtime {

void EventQueue::push_entry(const Entry& entry) {
    std::lock_guard lock(mutex_);
    if (entries_.size() == capacity) {
        entries_.pop_front();
        ++lost_;
    }
    entries_.push_back(entry);
}

XrResult EventQueue::poll(XrEventDataBuffer& out) {
    std::lock_guard lock(mutex_);
    if (lost_ > 0) {
        const XrEventDataEventsLost lost{XR_TYPE_EVENT_DATA_EVENTS_LOST, nullptr, lost_};
        std::memcpy(&out, &lost, sizeof(lost));
        lost_ = 0;
        return XR_SUCCESS;
    }
    if (entries_.empty()) return XR_EVENT_UNAVAILABLE;
    out = entries_.front().data;
    entries_.pop_front();
    return XR_SUCCESS;
}

void EventQueue::forget(XrSession session) {
    std::lock_guard lock(mutex_);
    std::erase_if(entries_, [&](const Entry& entry) { return entry.session == session; });
}

}  // namespace entoptic::runtime
