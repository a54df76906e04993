#include "runtime/objects/device_overrides.h"

namespace entoptic::runtime {

namespace {

template <class Map> auto found(const Map& map, const std::string& key) {
    const auto entry = map.find(key);
    return entry == map.end() ? std::nullopt : std::optional(entry->second);
}

}  // namespace

void DeviceOverrides::set_active(UserPath user, const Profile& profile, bool active) {
    std::lock_guard lock(mutex_);
    devices_[static_cast<std::size_t>(user)] = DeviceOverride{active, &profile};
}

void DeviceOverrides::set_value(const std::string& path, ComponentValue value) {
    std::lock_guard lock(mutex_);
    values_[path] = value;
}

void DeviceOverrides::set_location(const std::string& path, const OverriddenLocation& location) {
    std::lock_guard lock(mutex_);
    locations_[path] = location;
}

std::optional<DeviceOverride> DeviceOverrides::device(UserPath user) const {
    std::lock_guard lock(mutex_);
    return devices_[static_cast<std::size_t>(user)];
}

std::optional<ComponentValue> DeviceOverrides::value(const std::string& path) const {
    std::lock_guard lock(mutex_);
    return found(values_, path);
}

std::optional<OverriddenLocation> DeviceOverrides::location(const std::string& path) const {
    std::lock_guard lock(mutex_);
    return found(locations_, path);
}

}  // namespace entoptic::runtime
