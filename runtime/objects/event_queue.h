// Events of one instance, oldest first. Bounded: when the application does not poll, the oldest are lost and counted. Thread-safe.
#pragma once

#include "runtime/openxr.h"

#include <cstddef>
#include <cstring>
#include <deque>
#include <mutex>

namespace entoptic::runtime {

class EventQueue {
public:
    static constexpr std::size_t capacity = 256;

    template <class Event> void push(XrSession session, const Event& event) {
        static_assert(sizeof(Event) <= sizeof(XrEventDataBuffer));
        Entry entry{session, {}};
        std::memcpy(&entry.data, &event, sizeof(Event));
        push_entry(entry);
    }
    // XR_EVENT_UNAVAILABLE when there is none. Lost events are told first.
    XrResult poll(XrEventDataBuffer& out);
    // Events about a session that is gone mean nothing any more.
    void forget(XrSession session);

private:
    struct Entry {
        XrSession session;
        XrEventDataBuffer data;
    };
    void push_entry(const Entry& entry);

    std::mutex mutex_;
    std::deque<Entry> entries_;
    std::uint32_t lost_ = 0;
};

}  // namespace entoptic::runtime
