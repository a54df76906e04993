#include "runtime/api/verify.h"

#include "runtime/api/structure_names.h"
#include "runtime/objects/views.h"

#include <algorithm>

#include <openxr/openxr_reflection.h>

namespace entoptic::runtime::api {

namespace {

constexpr int longest_chain = 256;

const char* name_or_unknown(XrStructureType type) {
    const char* name = structure_name(type);
    return name ? name : "an unknown type";
}

bool known_view_configuration(XrViewConfigurationType type) {
#define ENTOPTIC_KNOWN(name, value) \
    case name:                      \
        return name != XR_VIEW_CONFIGURATION_TYPE_MAX_ENUM;
    switch (type) { XR_LIST_ENUM_XrViewConfigurationType(ENTOPTIC_KNOWN) default : return false; }
#undef ENTOPTIC_KNOWN
}

}  // namespace

Outcome handle_error(std::uint64_t handle, ObjectType type) {
    return error(XR_ERROR_HANDLE_INVALID, "{:#x} is not a valid {}; it was never created or has been destroyed", handle,
                 object_type_name(type));
}

Outcome type_error(const char* name, XrStructureType found, XrStructureType wanted) {
    return invalid("{}->type is {} ({}); it must be {}", name, static_cast<int>(found), name_or_unknown(found), name_or_unknown(wanted));
}

const void* find_in_chain(const void* next, XrStructureType type) {
    const auto* structure = static_cast<const XrBaseInStructure*>(next);
    for (int i = 0; structure && i < longest_chain; ++i, structure = structure->next) {
        if (structure->type == type) return structure;
    }
    return nullptr;
}

Outcome two_call(std::uint32_t capacity, std::uint32_t* count_output, const void* array, std::size_t count, bool& fill) {
    fill = false;
    if (!count_output) return invalid("the count output is null");
    *count_output = static_cast<std::uint32_t>(count);
    if (capacity == 0) return XR_SUCCESS;
    if (!array) return invalid("the array is null though its capacity is {}", capacity);
    if (capacity < count) return error(XR_ERROR_SIZE_INSUFFICIENT, "capacity {} is too small for {} elements", capacity, count);
    fill = true;
    return XR_SUCCESS;
}

Outcome two_call_string(std::uint32_t capacity, std::uint32_t* count_output, char* buffer, const std::string& text) {
    bool fill = false;
    ENTOPTIC_XR_TRY(two_call(capacity, count_output, buffer, text.size() + 1, fill));
    if (fill) std::memcpy(buffer, text.c_str(), text.size() + 1);
    return XR_SUCCESS;
}

Outcome check_system(XrSystemId system) {
    if (system == headset_system) return XR_SUCCESS;
    return error(XR_ERROR_SYSTEM_INVALID, "{} is not a system; get one from xrGetSystem", system);
}

Outcome check_time(XrTime time) {
    return time > 0 ? Outcome() : error(XR_ERROR_TIME_INVALID, "time {} is not positive; use a predicted display time", time);
}

Outcome check_pose(const XrPosef& pose) {
    const XrQuaternionf& q = pose.orientation;
    const float norm = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    const bool finite = std::isfinite(pose.position.x) && std::isfinite(pose.position.y) && std::isfinite(pose.position.z);
    if (finite && std::abs(norm - 1.0f) <= 0.01f) return XR_SUCCESS;  // false for NaN
    return error(XR_ERROR_POSE_INVALID,
                 "the pose's orientation must be a unit quaternion within 1 % (it has length {}) and its position finite", norm);
}

Outcome check_view_configuration(const Instance& instance, XrViewConfigurationType type) {
    const auto offered = view_configurations(instance.features());
    if (std::find(offered.begin(), offered.end(), type) != offered.end()) return XR_SUCCESS;
    if (!known_view_configuration(type)) return invalid("{} is not a view configuration type", static_cast<int>(type));
    return error(XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED, "view configuration {} is not offered; see xrEnumerateViewConfigurations",
                 static_cast<int>(type));
}

XrSpaceLocationFlags location_flags(const PoseState& state) {
    XrSpaceLocationFlags flags = 0;
    if (state.orientation_valid) flags |= XR_SPACE_LOCATION_ORIENTATION_VALID_BIT;
    if (state.position_valid) flags |= XR_SPACE_LOCATION_POSITION_VALID_BIT;
    if (state.orientation_tracked) flags |= XR_SPACE_LOCATION_ORIENTATION_TRACKED_BIT;
    if (state.position_tracked) flags |= XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
    return flags;
}

Pose to_pose(const XrPosef& pose) {
    const XrQuaternionf& q = pose.orientation;
    return {glm::normalize(glm::quat(q.w, q.x, q.y, q.z)), {pose.position.x, pose.position.y, pose.position.z}};
}

XrPosef to_xr(const Pose& pose) {
    return {{pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w}, to_xr(pose.position)};
}

}  // namespace entoptic::runtime::api
