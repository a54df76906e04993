// labels: gpu
// XR_ENTOPTICX_observer and XR_ENTOPTICX_presentation_timing, as a client sees them.
#include "entoptic/XR_ENTOPTICX_observer.h"
#include "entoptic/XR_ENTOPTICX_presentation_timing.h"
#include "runtime/testing/client.h"

#include <cmath>

namespace entoptic::runtime::testing {
namespace {

class Own : public SessionTest {
public:
    Own() : SessionTest({"XR_KHR_vulkan_enable2", "XR_ENTOPTICX_observer", "XR_ENTOPTICX_presentation_timing"}, XR_MAKE_VERSION(1, 0, 0)) {}
    XrObserverENTOPTICX observer(XrSpace space) {
        const XrObserverGetInfoENTOPTICX info{XR_TYPE_OBSERVER_GET_INFO_ENTOPTICX, nullptr, space, now()};
        XrObserverENTOPTICX out{XR_TYPE_OBSERVER_ENTOPTICX};
        EXPECT_EQ(xr.get<PFN_xrGetObserverENTOPTICX>("xrGetObserverENTOPTICX")(session, &info, &out), XR_SUCCESS);
        return out;
    }
};

TEST_F(Own, ObserverIsTheTrackersInTheSpaceAskedFor) {
    EyeState& left = xr.host->eyes.state.eyes[0];
    left = {{0.6f, 0, -0.8f}, Provenance::measured, 5.5f, Provenance::modelled, 0.9f, 0.75f, 123};
    xr.host->eyes.state.gaze_direction = {0, 0.6f, -0.8f};
    xr.host->eyes.raw[1] = RawEyeSample{1000, 4000, {0, 0, -2}, NAN, 7};
    xr.host->service.adaptation = {{12.5f, 13}};
    // A space turned by a quarter to the left of the head, two metres behind it.
    const XrSpace turned = reference_space(XR_REFERENCE_SPACE_TYPE_VIEW, {{0, std::sqrt(0.5f), 0, std::sqrt(0.5f)}, {0, 0, 2}});
    const XrObserverENTOPTICX seen = observer(turned);
    EXPECT_NEAR(seen.eyes[0].gazeDirection.x, 0.8, 1e-6) << "ahead of the head is right of the space";
    EXPECT_NEAR(seen.eyes[0].gazeDirection.z, 0.6, 1e-6);
    EXPECT_NEAR(seen.eyes[0].gazeOrigin.x, 2, 1e-6);
    EXPECT_NEAR(seen.eyes[0].gazeOrigin.z, -0.0315, 1e-6) << "half the distance of the eyes";
    EXPECT_NEAR(seen.combinedGazeDirection.y, 0.6, 1e-6);
    EXPECT_EQ(seen.eyes[0].gazeProvenance, XR_OBSERVER_PROVENANCE_MEASURED_ENTOPTICX);
    EXPECT_EQ(seen.eyes[0].pupilProvenance, XR_OBSERVER_PROVENANCE_MODELLED_ENTOPTICX);
    EXPECT_EQ(seen.eyes[1].gazeProvenance, XR_OBSERVER_PROVENANCE_ABSENT_ENTOPTICX);
    EXPECT_FLOAT_EQ(seen.eyes[0].pupilDiameter, 5.5f);
    EXPECT_FLOAT_EQ(seen.eyes[0].confidence, 0.75f);
    EXPECT_EQ(seen.eyes[0].sampleTime, 123);
    EXPECT_TRUE(seen.eyes[0].isAdaptationKnown);
    EXPECT_FLOAT_EQ(seen.eyes[1].adaptationLuminance, 13);
    EXPECT_FALSE(seen.eyes[0].raw.isAvailable);
    EXPECT_EQ(seen.eyes[1].raw.arrivalTime, 4000);
    EXPECT_TRUE(std::isnan(seen.eyes[1].raw.pupilDiameter)) << "raw is as reported";
    xr.host->service.adaptation.reset();
    EXPECT_FALSE(observer(turned).eyes[0].isAdaptationKnown);
}

TEST_F(Own, ObserverTellsWhichDetailIsSeen) {
    const XrSpace view = reference_space(XR_REFERENCE_SPACE_TYPE_VIEW);
    const auto detail = [&] {
        XrObserverDetailENTOPTICX out{XR_TYPE_OBSERVER_DETAIL_ENTOPTICX, nullptr, {-7, -7}, -7, -7};
        const XrObserverGetInfoENTOPTICX info{XR_TYPE_OBSERVER_GET_INFO_ENTOPTICX, nullptr, view, now()};
        XrObserverENTOPTICX observer{XR_TYPE_OBSERVER_ENTOPTICX, &out};
        EXPECT_EQ(xr.get<PFN_xrGetObserverENTOPTICX>("xrGetObserverENTOPTICX")(session, &info, &observer), XR_SUCCESS);
        return out;
    };
    // Both look at a point half a metre ahead; the eyes are 63 mm apart, and this host's resolve half a milliradian and a quarter.
    for (std::size_t eye = 0; eye < 2; ++eye) {
        xr.host->eyes.state.eyes[eye].gaze_direction = glm::normalize(glm::vec3(eye == 0 ? 0.0315f : -0.0315f, 0, -0.5f));
        xr.host->eyes.state.eyes[eye].gaze_provenance = Provenance::measured;
    }
    EXPECT_NEAR(detail().focusVergence, 2, 1e-4);
    EXPECT_FLOAT_EQ(detail().resolvedAngle[0], 0.5e-3f);
    EXPECT_FLOAT_EQ(detail().resolvedAngle[1], 0.25e-3f);
    EXPECT_NEAR(detail().eccentricityFactor * 3.3 / 57.29578, 1, 1e-5) << "twice as coarse at 3.3 degrees";
    xr.host->eyes.state.eyes[1].gaze_provenance = Provenance::modelled;
    EXPECT_LT(detail().focusVergence, 0);
}

TEST_F(Own, ObserverRefusesBadCalls) {
    const auto get = xr.get<PFN_xrGetObserverENTOPTICX>("xrGetObserverENTOPTICX");
    XrObserverGetInfoENTOPTICX info{XR_TYPE_OBSERVER_GET_INFO_ENTOPTICX, nullptr, XR_NULL_HANDLE, now()};
    XrObserverENTOPTICX out{XR_TYPE_OBSERVER_ENTOPTICX};
    EXPECT_EQ(get(session, &info, &out), XR_ERROR_HANDLE_INVALID);
    info.baseSpace = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
    info.time = 0;
    EXPECT_EQ(get(session, &info, &out), XR_ERROR_TIME_INVALID);
    info.time = now();
    out.type = XR_TYPE_VIEW;
    EXPECT_EQ(get(session, &info, &out), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(get(session, nullptr, &out), XR_ERROR_VALIDATION_FAILURE);
    const Client without(std::vector<const char*>{});
    EXPECT_EQ(without.get<PFN_xrGetObserverENTOPTICX>("xrGetObserverENTOPTICX"), nullptr);
}

TEST_F(Own, TimingsSayWhatBecameOfEachFrame) {
    xr.host->service.records = {{1, 100, 90, 101, 2}, {2, 200, 190, 0, 0}, {3, 300, 290, 302, 1}, {4, 400, 0, 0, 0}};
    const auto enumerate = xr.get<PFN_xrEnumeratePresentationTimingsENTOPTICX>("xrEnumeratePresentationTimingsENTOPTICX");
    XrPresentationTimingGetInfoENTOPTICX info{XR_TYPE_PRESENTATION_TIMING_GET_INFO_ENTOPTICX, nullptr, 0};
    std::uint32_t count = 0;
    ASSERT_EQ(enumerate(session, &info, 0, &count, nullptr), XR_SUCCESS);
    ASSERT_EQ(count, 4u);
    std::array<XrPresentationTimingENTOPTICX, 4> timings{};
    EXPECT_EQ(enumerate(session, &info, 3, &count, timings.data()), XR_ERROR_SIZE_INSUFFICIENT);
    ASSERT_EQ(enumerate(session, &info, 4, &count, timings.data()), XR_SUCCESS);
    EXPECT_EQ(timings[0].status, XR_PRESENTATION_STATUS_SHOWN_ENTOPTICX);
    EXPECT_EQ(timings[0].refreshesShown, 2u);
    EXPECT_EQ(timings[1].status, XR_PRESENTATION_STATUS_NEVER_ENTOPTICX) << "a newer one was shown";
    EXPECT_EQ(timings[2].displayTime, 302);
    EXPECT_EQ(timings[3].status, XR_PRESENTATION_STATUS_PENDING_ENTOPTICX);
    info.after = 200;
    ASSERT_EQ(enumerate(session, &info, 4, &count, timings.data()), XR_SUCCESS);
    EXPECT_EQ(count, 2u);
    EXPECT_EQ(timings[0].predictedDisplayTime, 300);
    info.after = -1;
    EXPECT_EQ(enumerate(session, &info, 4, &count, timings.data()), XR_ERROR_TIME_INVALID);
}

}  // namespace
}  // namespace entoptic::runtime::testing
