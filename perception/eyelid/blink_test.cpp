// labels: gpu
#include "perception/eyelid/blink_math.glsl"
#include "perception/eyelid/eyelid.h"
#include "perception/testing/gate_sweep.h"
#include "perception/testing/picture_laws.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const PictureLaws laws("eyelid", "blink");
const char* const name = "eyelid.blink";

BlinkParams defaults() { return {10, 0.056f, 0.003f}; }

ImageF seen(StageRunner& runner, const ImageF& picture, float open, float pupil_mm = 4, double dt_s = 1.0 / 90) {
    FrameInput input = still_input(1, dt_s, false);
    input.eyes[0].eyelid_open = open;
    input.eyes[0].pupil_diameter_mm = pupil_mm;
    return runner.run(picture, input);
}

TEST(Blink, AreaIsThatOfTheCircle) {
    EXPECT_NEAR(blink::uncovered(defaults(), 0.5, 4), 0.5, 1e-12);
    EXPECT_EQ(blink::uncovered(defaults(), 1, 9), 1.0);
    EXPECT_EQ(blink::uncovered(defaults(), 0.71, 4), 1.0) << "the edge is 2.1 mm above the middle of a pupil of 4 mm";
    EXPECT_EQ(blink::uncovered(defaults(), 0.29, 4), 0.0);
    EXPECT_EQ(blink::uncovered(defaults(), std::nan(""), 4), 1.0);
    // Half way up a radius: the segment above is 1/3 - sqrt(3)/(4 pi) of the disc.
    EXPECT_NEAR(blink::uncovered(defaults(), 0.6, 4), 1 - (1.0 / 3 - std::sqrt(3.0) / (4 * 3.14159265358979)), 1e-7);
    double before = 0;
    for (double open = 0; open <= 1; open += 0.001) {
        EXPECT_GE(blink::uncovered(defaults(), open, 6), before);
        before = blink::uncovered(defaults(), open, 6);
    }
}

TEST(Blink, ClosedLidIsRed) {
    const glm::dvec3 closed = blink::passed(defaults(), 0, 4);
    EXPECT_NEAR(closed.x, 0.056, 1e-8);
    EXPECT_NEAR(closed.y, 0.003, 1e-8);
    EXPECT_EQ(closed.y, closed.z);
}

TEST(Blink, GpuAgreesWithTheReference) {
    const EyeGeometry g = rectilinear(33, 17, 20);
    StageRunner runner({g}, laws.selection());
    double worst = 0;
    for (float open : {0.0f, 0.2f, 0.45f, 0.5f, 0.63f, 0.7f, 1.0f})
        for (float pupil : {2.0f, 4.0f, 8.0f}) {
            const ImageF picture = textured(33, 17, 10);
            ReferenceFrame frame{convert<double>(picture), g, {}, {}, 0, false, 1, 1};
            frame.eye.eyelid_open = open;
            frame.eye.pupil_diameter_mm = pupil;
            find_model("eyelid", "blink")->create_reference()->apply(frame, laws.parameters());
            worst = std::max(worst, summary(relative_errors(seen(runner, picture, open, pupil), frame.image, 1e-3)).max);
        }
    ledger(name, "pupils 2 to 8 mm", "float against reference max rel", worst);
    EXPECT_LT(worst, 2e-5);
}

TEST(Blink, OpenEyeKeepsItsBits) {
    StageRunner runner({rectilinear(64, 48, 20)}, laws.selection());
    const ImageF picture = textured(64, 48, 1, 1e6);
    for (float open : {1.0f, 0.95f, 5.0f, std::numeric_limits<float>::quiet_NaN()}) {
        EXPECT_EQ(seen(runner, picture, open).data, picture.data) << open;
        EXPECT_TRUE(runner.stage().effects().at(0).gated);
    }
}

TEST(Blink, GateHoldsBothWays) {
    // A pupil of 8 mm behind a slit of 10: the lid reaches it at 0.9 of the opening.
    StageRunner runner({rectilinear(32, 24, 20)}, laws.selection());
    const ImageF picture = textured(32, 24, 1);
    GateCount count;
    for (double factor : factors_around_bound(120, 0.5)) {
        // The closed part of the slit over that which is still free of the pupil.
        const auto open = static_cast<float>(1 - std::min(0.1 * factor, 1.0));
        const ImageF out = seen(runner, picture, open, 8);
        const bool is_gated = runner.stage().effects().at(0).gated;
        count.add(is_gated, factor);
        EXPECT_EQ(is_gated, factor < 1) << factor;
        EXPECT_EQ(out.data == picture.data, factor < 1) << factor;
    }
    count.expect_both_outcomes();
}

// What observes the light on the retina knows of the lid itself: it must not count it twice.
TEST(Blink, AfterimagesTakeTheLidOnce) {
    const auto after_a_blink = [&](const std::vector<std::string>& models) {
        StageRunner runner({rectilinear(32, 24, 20)}, only(models));
        ImageF out = seen(runner, uniform(32, 24, 100), 1, 4, 0.1);
        for (int i = 0; i < 5; ++i) seen(runner, uniform(32, 24, 1e5f), 0, 4, 0.1);
        return seen(runner, uniform(32, 24, 20), 1, 4, 0.1);
    };
    EXPECT_EQ(after_a_blink({"afterimage=jacobs", "eyelid=blink"}).data, after_a_blink({"afterimage=jacobs"}).data);
    EXPECT_NE(after_a_blink({"afterimage=jacobs"}).data, after_a_blink({}).data) << "there is an afterimage at all";
}

TEST(Blink, EachEyeHasItsOwnLid) {
    const EyeGeometry g = rectilinear(32, 24, 20);
    StageRunner runner({g, g}, laws.selection());
    FrameInput input = still_input(2);
    input.eyes[1].eyelid_open = 0;
    const ImageF picture = textured(32, 24, 1);
    const auto out = runner.run({picture, picture}, input);
    EXPECT_EQ(out[0].data, picture.data);
    EXPECT_NEAR(out[1].at(5, 5, 0) / picture.at(5, 5, 0), 0.056f, 1e-6f);
}

TEST(Blink, HardCasesStayFinite) { laws.hard_cases_stay_finite({"eyelid.opening_mm=2", "eyelid.lid_red=1"}); }

}  // namespace
}  // namespace entoptic::perception
