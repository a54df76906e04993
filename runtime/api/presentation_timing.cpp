// XR_ENTOPTICX_presentation_timing.
#include "entoptic/XR_ENTOPTICX_presentation_timing.h"

#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/verify.h"
#include "runtime/objects/session.h"

#include <algorithm>
#include <vector>

namespace entoptic::runtime::api {

namespace {

// `last_shown`: the newest frame whose light left the panel. What is older and was not shown will not be.
XrPresentationStatusENTOPTICX status_of(const PresentationRecord& record, std::uint64_t last_shown) {
    if (record.refreshes_shown > 0) return XR_PRESENTATION_STATUS_SHOWN_ENTOPTICX;
    return record.frame_id < last_shown ? XR_PRESENTATION_STATUS_NEVER_ENTOPTICX : XR_PRESENTATION_STATUS_PENDING_ENTOPTICX;
}

std::vector<XrPresentationTimingENTOPTICX> timings_after(const std::vector<PresentationRecord>& records, XrTime after) {
    std::uint64_t last_shown = 0;
    for (const PresentationRecord& record : records) {
        if (record.refreshes_shown > 0) last_shown = std::max(last_shown, record.frame_id);
    }
    std::vector<XrPresentationTimingENTOPTICX> timings;
    for (const PresentationRecord& record : records) {
        if (record.predicted_display_time <= after) continue;
        timings.push_back({record.predicted_display_time, record.submitted_time, record.display_time, record.refreshes_shown,
                           status_of(record, last_shown)});
    }
    return timings;
}

}  // namespace

XrResult XRAPI_CALL enumerate_presentation_timings(XrSession handle, const XrPresentationTimingGetInfoENTOPTICX* info, uint32_t capacity,
                                                   uint32_t* count, XrPresentationTimingENTOPTICX* timings) {
    return call("xrEnumeratePresentationTimingsENTOPTICX", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_PRESENTATION_TIMING_GET_INFO_ENTOPTICX, "getInfo"));
        if (info->after < 0) return error(XR_ERROR_TIME_INVALID, "after is {}; it must be 0 or a predicted display time", info->after);
        const auto records = session->host().frames().presentation_records(XR_ENTOPTICX_PRESENTATION_TIMING_HISTORY);
        return two_call_values(capacity, count, timings, timings_after(records, info->after));
    });
}

}  // namespace entoptic::runtime::api
