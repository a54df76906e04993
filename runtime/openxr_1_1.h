// What OpenXR 1.1.41 and its extensions declare and Debian 12's headers (1.0.20) do not: numbers, structures and function types, facts of
// the public registry. The one include of this file, in runtime/openxr.h, goes when newer headers are there; with them it is empty.
#pragma once

#include <openxr/openxr.h>

#if XR_CURRENT_API_VERSION < XR_MAKE_VERSION(1, 1, 0)

#define XR_API_VERSION_1_0 XR_MAKE_VERSION(1, 0, XR_VERSION_PATCH(XR_CURRENT_API_VERSION))
#define XR_API_VERSION_1_1 XR_MAKE_VERSION(1, 1, XR_VERSION_PATCH(XR_CURRENT_API_VERSION))

// Enumerants that the old headers' enumerations lack, by name and number: the reflection lists of those headers do not hold them either.
#define ENTOPTIC_XR_NEWER_RESULTS(X)                 \
    X(XR_ERROR_PERMISSION_INSUFFICIENT, -1000710000) \
    X(XR_ERROR_EXTENSION_DEPENDENCY_NOT_ENABLED, -1000710001)
#define ENTOPTIC_XR_NEWER_STRUCTURES(X)                         \
    X(XR_TYPE_SPACES_LOCATE_INFO, 1000471000)                   \
    X(XR_TYPE_SPACE_LOCATIONS, 1000471001)                      \
    X(XR_TYPE_SPACE_VELOCITIES, 1000471002)                     \
    X(XR_TYPE_EVENT_DATA_USER_PRESENCE_CHANGED_EXT, 1000470000) \
    X(XR_TYPE_SYSTEM_USER_PRESENCE_PROPERTIES_EXT, 1000470001)  \
    X(XR_TYPE_INTERACTION_PROFILE_DPAD_BINDING_EXT, 1000078000)

#define ENTOPTIC_XR_RESULT(name, number) inline constexpr XrResult name = static_cast<XrResult>(number);
#define ENTOPTIC_XR_STRUCTURE(name, number) inline constexpr XrStructureType name = static_cast<XrStructureType>(number);
ENTOPTIC_XR_NEWER_RESULTS(ENTOPTIC_XR_RESULT)
ENTOPTIC_XR_NEWER_STRUCTURES(ENTOPTIC_XR_STRUCTURE)
#undef ENTOPTIC_XR_RESULT
#undef ENTOPTIC_XR_STRUCTURE

inline constexpr XrReferenceSpaceType XR_REFERENCE_SPACE_TYPE_LOCAL_FLOOR = static_cast<XrReferenceSpaceType>(1000426000);
inline constexpr XrViewConfigurationType XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO_WITH_FOVEATED_INSET =
    static_cast<XrViewConfigurationType>(1000037000);

// xrLocateSpaces (XR_KHR_locate_spaces; core in 1.1)
#define XR_KHR_LOCATE_SPACES_EXTENSION_NAME "XR_KHR_locate_spaces"
struct XrSpacesLocateInfo {
    XrStructureType type;
    const void* next;
    XrSpace baseSpace;
    XrTime time;
    uint32_t spaceCount;
    const XrSpace* spaces;
};
struct XrSpaceLocationData {
    XrSpaceLocationFlags locationFlags;
    XrPosef pose;
};
struct XrSpaceLocations {
    XrStructureType type;
    void* next;
    uint32_t locationCount;
    XrSpaceLocationData* locations;
};
struct XrSpaceVelocityData {
    XrSpaceVelocityFlags velocityFlags;
    XrVector3f linearVelocity;
    XrVector3f angularVelocity;
};
struct XrSpaceVelocities {
    XrStructureType type;
    void* next;
    uint32_t velocityCount;
    XrSpaceVelocityData* velocities;
};
using PFN_xrLocateSpaces = XrResult(XRAPI_PTR*)(XrSession session, const XrSpacesLocateInfo* locateInfo, XrSpaceLocations* spaceLocations);

#define XR_EXT_LOCAL_FLOOR_EXTENSION_NAME "XR_EXT_local_floor"
#define XR_EXT_PALM_POSE_EXTENSION_NAME "XR_EXT_palm_pose"
#define XR_EXT_UUID_EXTENSION_NAME "XR_EXT_uuid"
#define XR_EXT_HAND_INTERACTION_EXTENSION_NAME "XR_EXT_hand_interaction"
#define XR_KHR_MAINTENANCE1_EXTENSION_NAME "XR_KHR_maintenance1"

#define XR_EXT_USER_PRESENCE_EXTENSION_NAME "XR_EXT_user_presence"
struct XrEventDataUserPresenceChangedEXT {
    XrStructureType type;
    const void* next;
    XrSession session;
    XrBool32 isUserPresent;
};
struct XrSystemUserPresencePropertiesEXT {
    XrStructureType type;
    void* next;
    XrBool32 supportsUserPresence;
};

#define XR_EXT_DPAD_BINDING_EXTENSION_NAME "XR_EXT_dpad_binding"
struct XrInteractionProfileDpadBindingEXT {
    XrStructureType type;
    const void* next;
    XrPath binding;
    XrActionSet actionSet;
    float forceThreshold;
    float forceThresholdReleased;
    float centerRegion;
    float wedgeAngle;
    XrBool32 isSticky;
    const XrHapticBaseHeader* onHaptic;
    const XrHapticBaseHeader* offHaptic;
};

#else
#define ENTOPTIC_XR_NEWER_RESULTS(X)
#define ENTOPTIC_XR_NEWER_STRUCTURES(X)
#endif
