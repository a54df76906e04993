// XR_EXT_hand_tracking, honestly unsupported: xrGetSystemProperties says so, and no tracker can be made.
#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/verify.h"
#include "runtime/objects/session.h"

namespace entoptic::runtime::api {

XrResult XRAPI_CALL create_hand_tracker(XrSession handle, const XrHandTrackerCreateInfoEXT* info, XrHandTrackerEXT* tracker) {
    return call("xrCreateHandTrackerEXT", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_HAND_TRACKER_CREATE_INFO_EXT, "createInfo"));
        ENTOPTIC_XR_TRY(require_pointer(tracker, "handTracker"));
        return error(XR_ERROR_FEATURE_UNSUPPORTED, "this headset does not track hands; ask xrGetSystemProperties first");
    });
}

XrResult XRAPI_CALL destroy_hand_tracker(XrHandTrackerEXT tracker) {
    return call("xrDestroyHandTrackerEXT", tracker, [&] { return handle_error(handle_value(tracker), ObjectType::none); });
}

XrResult XRAPI_CALL locate_hand_joints(XrHandTrackerEXT tracker, const XrHandJointsLocateInfoEXT*, XrHandJointLocationsEXT*) {
    return call("xrLocateHandJointsEXT", tracker, [&] { return handle_error(handle_value(tracker), ObjectType::none); });
}

}  // namespace entoptic::runtime::api
