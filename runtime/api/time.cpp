// XR_KHR_convert_timespec_time: XrTime is the session clock's nanoseconds: CLOCK_MONOTONIC's, or the virtual clock's in lockstep.
#include "base/time.h"

#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/verify.h"

#include <limits>

namespace entoptic::runtime::api {

XrResult XRAPI_CALL convert_timespec_time_to_time(XrInstance handle, const struct timespec* from, XrTime* to) {
    return call("xrConvertTimespecTimeToTimeKHR", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require_pointer(from, "timespecTime"));
        ENTOPTIC_XR_TRY(require_pointer(to, "time"));
        constexpr auto last_second = std::numeric_limits<XrTime>::max() / ns_per_s - 1;
        if (from->tv_sec < 0 || from->tv_sec > last_second || from->tv_nsec < 0 || from->tv_nsec >= ns_per_s) {
            return error(XR_ERROR_TIME_INVALID, "{} s and {} ns are not a time of CLOCK_MONOTONIC", from->tv_sec, from->tv_nsec);
        }
        const XrTime time = from->tv_sec * ns_per_s + from->tv_nsec;
        ENTOPTIC_XR_TRY(check_time(time));
        *to = time;
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL convert_time_to_timespec_time(XrInstance handle, XrTime from, struct timespec* to) {
    return call("xrConvertTimeToTimespecTimeKHR", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require_pointer(to, "timespecTime"));
        ENTOPTIC_XR_TRY(check_time(from));
        to->tv_sec = from / ns_per_s;
        to->tv_nsec = from % ns_per_s;
        return XR_SUCCESS;
    });
}

}  // namespace entoptic::runtime::api
