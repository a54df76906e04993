// XR_ENTOPTICX_observer.
#include "entoptic/XR_ENTOPTICX_observer.h"

#include "interfaces/vergence.h"
#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/verify.h"
#include "runtime/objects/session.h"
#include "runtime/objects/space.h"

namespace entoptic::runtime::api {

namespace {

XrObserverProvenanceENTOPTICX to_xr(Provenance provenance) {
    switch (provenance) {
        case Provenance::measured:
            return XR_OBSERVER_PROVENANCE_MEASURED_ENTOPTICX;
        case Provenance::modelled:
            return XR_OBSERVER_PROVENANCE_MODELLED_ENTOPTICX;
        default:
            return XR_OBSERVER_PROVENANCE_ABSENT_ENTOPTICX;
    }
}

// The tracker's newest sample that had arrived by now: it cannot be asked for the future.
XrObserverRawSampleENTOPTICX raw_sample(EyeSource& tracker, int eye, TimeNs now) {
    const auto sample = tracker.raw_at(eye, now);
    if (!sample) return {};
    return {XR_TRUE, sample->time, sample->arrival, api::to_xr(sample->gaze_direction), sample->pupil_diameter_mm, sample->confidence};
}

// The resolved angle doubles at 3.3 degrees (E2; Strasburger, Rentschler and Jüttner 2011).
constexpr float eccentricity_factor = 57.29578f / 3.3f;

void describe_detail(RuntimeHost& host, const Observer& seen, XrObserverDetailENTOPTICX& out) {
    const auto& eyes = host.headset().eyes;
    const std::array<double, 2> angles = host.resolved_angles_rad();
    for (std::size_t eye = 0; eye < 2; ++eye) out.resolvedAngle[eye] = static_cast<float>(angles[eye]);
    out.eccentricityFactor = eccentricity_factor;
    out.focusVergence = vergence_dioptre(seen, {eyes[0].head_from_eye, eyes[1].head_from_eye});
}

XrObserverEyeENTOPTICX describe(Session& session, int eye, const EyeState& state, const Pose& base_from_head) {
    RuntimeHost& host = session.host();
    const EyeOptics& optics = host.headset().eyes[static_cast<std::size_t>(eye)];
    XrObserverEyeENTOPTICX out{};
    out.gazeOrigin = api::to_xr((base_from_head * optics.head_from_eye).position);
    out.gazeDirection = api::to_xr(base_from_head.rotate(state.gaze_direction));
    out.gazeProvenance = to_xr(state.gaze_provenance);
    out.pupilDiameter = state.pupil_diameter_mm;
    out.pupilProvenance = to_xr(state.pupil_provenance);
    out.eyelidOpening = state.eyelid_open;
    out.confidence = state.confidence;
    out.sampleTime = state.sample_time;
    if (const auto adaptation = host.frames().adaptation_cd_m2()) {
        out.isAdaptationKnown = XR_TRUE;
        out.adaptationLuminance = (*adaptation)[static_cast<std::size_t>(eye)];
    }
    out.raw = raw_sample(*host.headset().eye_tracker, eye, host.clock().now());
    return out;
}

}  // namespace

XrResult XRAPI_CALL get_observer(XrSession handle, const XrObserverGetInfoENTOPTICX* info, XrObserverENTOPTICX* observer) {
    return call("xrGetObserverENTOPTICX", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        std::shared_ptr<Space> base;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_OBSERVER_GET_INFO_ENTOPTICX, "getInfo"));
        ENTOPTIC_XR_TRY(require(observer, XR_TYPE_OBSERVER_ENTOPTICX, "observer"));
        ENTOPTIC_XR_TRY(find(info->baseSpace, base));
        if (base->session() != session) return invalid("the base space belongs to another session");
        ENTOPTIC_XR_TRY(check_time(info->time));
        const PoseState head = locate(Space(session, XR_REFERENCE_SPACE_TYPE_VIEW, {}), *base, info->time);
        const Pose base_from_head = head.orientation_valid && head.position_valid ? head.pose : Pose{};
        const Observer seen = session->host().headset().eye_tracker->observer_at(info->time);
        observer->headLocationFlags = location_flags(head);
        observer->combinedGazeDirection = api::to_xr(base_from_head.rotate(seen.gaze_direction));
        for (int eye = 0; eye < 2; ++eye) {
            observer->eyes[eye] = describe(*session, eye, seen.eyes[static_cast<std::size_t>(eye)], base_from_head);
        }
        if (auto* detail = chained<XrObserverDetailENTOPTICX>(observer->next, XR_TYPE_OBSERVER_DETAIL_ENTOPTICX)) {
            describe_detail(session->host(), seen, *detail);
        }
        return XR_SUCCESS;
    });
}

}  // namespace entoptic::runtime::api
