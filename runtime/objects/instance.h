// One XrInstance: the host's services, what the application said about itself, and everything that is shared by its objects.
#pragma once

#include "interfaces/runtime_host.h"
#include "runtime/objects/binding_suggestions.h"
#include "runtime/objects/debug_utils.h"
#include "runtime/objects/event_queue.h"
#include "runtime/objects/features.h"
#include "runtime/objects/handle_table.h"
#include "runtime/objects/name_registry.h"
#include "runtime/objects/path_table.h"

#include <atomic>
#include <memory>
#include <string_view>

namespace entoptic::runtime {

// The only system there is: the host's headset.
constexpr XrSystemId headset_system = 1;

enum class GraphicsApi : unsigned { vulkan = 1, opengl = 2 };

class Instance final : public Object {
public:
    explicit Instance(ApplicationIdentity application)
        : Object(ObjectType::instance),
          application_(std::move(application)),
          features_(features_of(application_.api_version, application_.extensions)) {}
    // The host is made after the instance's own debug messengers, so that they hear why it could not be.
    void set_host(std::unique_ptr<RuntimeHost> host) { host_ = std::move(host); }

    Instance& instance() override { return *this; }
    XrInstance xr() const { return to_handle<XrInstance>(handle()); }

    RuntimeHost& host() { return *host_; }
    const ApplicationIdentity& application() const { return application_; }
    bool enabled(std::string_view extension) const;
    Features features() const { return features_; }
    // True with any of these.
    bool has(Features any) const { return available(any, features_); }

    PathTable& paths() { return paths_; }
    EventQueue& events() { return events_; }
    DebugUtils& debug() { return debug_; }
    NameRegistry& action_set_names() { return action_set_names_; }
    BindingSuggestions& suggestions() { return suggestions_; }

    // The application asked for the API's graphics requirements: it may create a session with it.
    void note_graphics_requirements(GraphicsApi api) { graphics_requirements_asked_ |= static_cast<unsigned>(api); }
    bool graphics_requirements_asked(GraphicsApi api) const { return (graphics_requirements_asked_ & static_cast<unsigned>(api)) != 0; }
    // The application's own vkGetInstanceProcAddr (XR_KHR_vulkan_enable2), and the VkInstance made through it; null before. Opaque here.
    std::atomic<void*> vk_get_instance_proc_addr{nullptr};
    std::atomic<void*> vk_instance{nullptr};

    // One session at a time. False when there is one.
    bool claim_session() { return !session_taken_.exchange(true); }
    void free_session() { session_taken_ = false; }

private:
    const ApplicationIdentity application_;
    const Features features_;
    std::unique_ptr<RuntimeHost> host_;
    PathTable paths_;
    EventQueue events_;
    DebugUtils debug_;
    NameRegistry action_set_names_;
    BindingSuggestions suggestions_;
    std::atomic<unsigned> graphics_requirements_asked_{0};  // bits of GraphicsApi
    std::atomic<bool> session_taken_{false};
};

}  // namespace entoptic::runtime
