// XR_EXT_debug_utils: messengers, names of objects, labels of sessions. Thread-safe; callbacks run without a lock held.
#pragma once

#include "runtime/objects/handle_table.h"
#include "runtime/openxr.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace entoptic::runtime {

class Messenger final : public Object {
public:
    Messenger(std::shared_ptr<Instance> instance, const XrDebugUtilsMessengerCreateInfoEXT& info);
    Instance& instance() override { return *instance_; }
    void retire() override;
    const XrDebugUtilsMessengerCreateInfoEXT& info() const { return info_; }

private:
    std::shared_ptr<Instance> instance_;
    const XrDebugUtilsMessengerCreateInfoEXT info_;
};

struct DebugObject {
    XrObjectType type = XR_OBJECT_TYPE_UNKNOWN;
    std::uint64_t handle = 0;
    std::string name = {};  // as the sender of a message calls it; a name that was set comes before
};

class DebugUtils {
public:
    void add(const Messenger* messenger);
    // A messenger chained to xrCreateInstance hears what happens in that call. Afterwards the loader makes a real one of it.
    void add_for_creation(const XrDebugUtilsMessengerCreateInfoEXT& info);
    void creation_done();
    void remove(const Messenger* messenger);

    void set_name(DebugObject object, const char* name);  // null or empty forgets it
    void begin_region(std::uint64_t session, const char* name);
    void end_region(std::uint64_t session);
    void insert_label(std::uint64_t session, const char* name);
    void forget_session(std::uint64_t session);

    // Adds the names of `objects` and the labels of sessions among them, and calls every messenger that asked for such messages.
    void submit(XrDebugUtilsMessageSeverityFlagsEXT severity, XrDebugUtilsMessageTypeFlagsEXT types, const char* id, const char* function,
                const char* message, const std::vector<DebugObject>& objects);

private:
    struct Label {
        std::string name;
        bool region = false;
    };
    struct Receiver {
        const Messenger* messenger = nullptr;  // null: for the creation of the instance
        XrDebugUtilsMessengerCreateInfoEXT info{};
    };
    void drop_individual(std::vector<Label>& labels);

    std::mutex mutex_;
    std::vector<Receiver> receivers_;
    std::map<std::pair<XrObjectType, std::uint64_t>, std::string> names_;
    std::map<std::uint64_t, std::vector<Label>> labels_;  // by session, oldest first
};

}  // namespace entoptic::runtime
