// XR_FB_display_refresh_rate: the panel has one rate.
#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/verify.h"
#include "runtime/objects/session.h"

#include <array>
#include <cmath>

namespace entoptic::runtime::api {

namespace {

float rate_of(Session& session) {
    const DisplayIdentity& display = session.host().headset().display;
    return static_cast<float>(double(display.refresh_numerator) / double(display.refresh_denominator));
}

}  // namespace

XrResult XRAPI_CALL enumerate_display_refresh_rates(XrSession handle, uint32_t capacity, uint32_t* count, float* rates) {
    return call("xrEnumerateDisplayRefreshRatesFB", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        return two_call_values(capacity, count, rates, std::array{rate_of(*session)});
    });
}

XrResult XRAPI_CALL get_display_refresh_rate(XrSession handle, float* rate) {
    return call("xrGetDisplayRefreshRateFB", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require_pointer(rate, "displayRefreshRate"));
        *rate = rate_of(*session);
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL request_display_refresh_rate(XrSession handle, float rate) {
    return call("xrRequestDisplayRefreshRateFB", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        const bool keeps = rate == 0.0f;  // no preference
        if (keeps || std::abs(rate - rate_of(*session)) < 0.01f) return XR_SUCCESS;
        return error(XR_ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB, "{} Hz is not offered; the display has {} Hz", rate, rate_of(*session));
    });
}

}  // namespace entoptic::runtime::api
