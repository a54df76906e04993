// Devices that the application plays itself (XR_EXT_conformance_automation): which are there, and what their inputs hold. Thread-safe.
#pragma once

#include "base/pose.h"
#include "runtime/objects/interaction_profiles.h"

#include <array>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace entoptic::runtime {

// A device that stands in for the real one of a user path.
struct DeviceOverride {
    bool active = false;
    const Profile* profile = nullptr;
};

// Where a pose input is: in the world, or, head-locked, relative to the head.
struct OverriddenLocation {
    bool head_locked = false;
    Pose pose;
};

class DeviceOverrides {
public:
    void set_active(UserPath user, const Profile& profile, bool active);
    // `path` is a full binding path: "/user/hand/left/input/trigger/value".
    void set_value(const std::string& path, ComponentValue value);
    void set_location(const std::string& path, const OverriddenLocation& location);

    // Nothing while nobody has overridden the user path's device.
    std::optional<DeviceOverride> device(UserPath user) const;
    std::optional<ComponentValue> value(const std::string& path) const;
    std::optional<OverriddenLocation> location(const std::string& path) const;

private:
    mutable std::mutex mutex_;
    std::array<std::optional<DeviceOverride>, user_path_count> devices_;
    std::map<std::string, ComponentValue> values_;
    std::map<std::string, OverriddenLocation> locations_;
};

}  // namespace entoptic::runtime
