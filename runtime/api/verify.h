// Checks shared by the functions of the C ABI. Each returns an error with a sentence, or success.
#pragma once

#include "base/pose.h"
#include "runtime/objects/handle_table.h"
#include "runtime/objects/instance.h"
#include "runtime/objects/outcome.h"
#include "runtime/openxr.h"

#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <string>

namespace entoptic::runtime {
class Session;
class Space;
class Swapchain;
class Action;
class ActionSet;
class Messenger;
}  // namespace entoptic::runtime

namespace entoptic::runtime::api {

template <class T> struct ObjectTypeOf;
template <> struct ObjectTypeOf<Instance> { static constexpr ObjectType value = ObjectType::instance; };
template <> struct ObjectTypeOf<Session> { static constexpr ObjectType value = ObjectType::session; };
template <> struct ObjectTypeOf<Space> { static constexpr ObjectType value = ObjectType::space; };
template <> struct ObjectTypeOf<Swapchain> { static constexpr ObjectType value = ObjectType::swapchain; };
template <> struct ObjectTypeOf<Action> { static constexpr ObjectType value = ObjectType::action; };
template <> struct ObjectTypeOf<ActionSet> { static constexpr ObjectType value = ObjectType::action_set; };
template <> struct ObjectTypeOf<Messenger> { static constexpr ObjectType value = ObjectType::messenger; };

Outcome handle_error(std::uint64_t handle, ObjectType type);

// XR_ERROR_HANDLE_INVALID.
template <class T, class Handle> Outcome find(Handle handle, std::shared_ptr<T>& object) {
    constexpr ObjectType type = ObjectTypeOf<T>::value;
    object = std::static_pointer_cast<T>(HandleTable::global().find(handle_value(handle), type));
    return object ? Outcome() : handle_error(handle_value(handle), type);
}

// Registers a new object below its parent and writes its handle.
template <class Handle> Outcome publish(std::shared_ptr<Object> object, std::uint64_t parent, Handle* handle) {
    const std::uint64_t value = HandleTable::global().insert(std::move(object), parent);
    if (value == 0) return error(XR_ERROR_HANDLE_INVALID, "the parent was destroyed during the call");
    *handle = to_handle<Handle>(value);
    return XR_SUCCESS;
}

template <class T> Outcome destroy(std::uint64_t handle) {
    constexpr ObjectType type = ObjectTypeOf<T>::value;
    return HandleTable::global().remove(handle, type) ? Outcome() : handle_error(handle, type);
}

// A structure the caller must give: not null, of the right type.
Outcome type_error(const char* name, XrStructureType found, XrStructureType wanted);
template <class Struct> Outcome require(const Struct* structure, XrStructureType type, const char* name) {
    if (!structure) return invalid("{} is null", name);
    return structure->type == type ? Outcome() : type_error(name, structure->type, type);
}
// One of an array that the call fills. An application with the quirk untyped_arrays may have left it as it came.
template <class Struct> Outcome require_element(Instance& instance, Struct& element, XrStructureType type, const char* name) {
    if (element.type != type && instance.host().quirks().untyped_arrays) {
        element.type = type;
        element.next = nullptr;
    }
    return require(&element, type, name);
}
// One the caller may leave out.
template <class Struct> Outcome optional(const Struct* structure, XrStructureType type, const char* name) {
    return structure ? require(structure, type, name) : Outcome();
}
inline Outcome require_pointer(const void* pointer, const char* name) { return pointer ? Outcome() : invalid("{} is null", name); }

// The first structure of this type in a chain, or null. Unknown ones are skipped; a chain that goes round is given up.
const void* find_in_chain(const void* next, XrStructureType type);
template <class Struct> Struct* chained(void* next, XrStructureType type) {
    return static_cast<Struct*>(const_cast<void*>(find_in_chain(next, type)));
}
template <class Struct> const Struct* chained(const void* next, XrStructureType type) {
    return static_cast<const Struct*>(find_in_chain(next, type));
}

// The two-call idiom. Writes `count` to `*count_output`. Success with `fill` set when the caller's array takes all elements,
// success without when the capacity is 0; XR_ERROR_SIZE_INSUFFICIENT, XR_ERROR_VALIDATION_FAILURE.
Outcome two_call(std::uint32_t capacity, std::uint32_t* count_output, const void* array, std::size_t count, bool& fill);
// For strings, with the terminating zero.
Outcome two_call_string(std::uint32_t capacity, std::uint32_t* count_output, char* buffer, const std::string& text);
template <class Element, class Range>
Outcome two_call_values(std::uint32_t capacity, std::uint32_t* count_output, Element* array, const Range& values) {
    bool fill = false;
    ENTOPTIC_XR_TRY(two_call(capacity, count_output, array, std::size(values), fill));
    if (fill) std::copy(std::begin(values), std::end(values), array);
    return XR_SUCCESS;
}

Outcome check_system(XrSystemId system);
// XR_ERROR_TIME_INVALID unless positive.
Outcome check_time(XrTime time);
// XR_ERROR_POSE_INVALID unless finite and of unit length within 1 %.
Outcome check_pose(const XrPosef& pose);
// XR_ERROR_VALIDATION_FAILURE for a number that is no such enumerant, XR_ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED for one
// that this application is not offered.
Outcome check_view_configuration(const Instance& instance, XrViewConfigurationType type);
// The text in a fixed array; empty when it is not terminated.
template <std::size_t size> std::string bounded_text(const char (&text)[size]) {
    const std::size_t length = strnlen(text, size);
    return length == size ? std::string() : std::string(text, length);
}

XrSpaceLocationFlags location_flags(const PoseState& state);
Pose to_pose(const XrPosef& pose);  // normalised
XrPosef to_xr(const Pose& pose);
inline XrVector3f to_xr(glm::vec3 v) { return {v.x, v.y, v.z}; }

}  // namespace entoptic::runtime::api
