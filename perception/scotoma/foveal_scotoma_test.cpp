// labels: gpu
#include "perception/scotoma/foveal_scotoma_math.glsl"
#include "perception/mesopic/jacobs_mesopic_math.glsl"
#include "perception/scotoma/scotoma.h"
#include "perception/testing/gate_sweep.h"
#include "perception/testing/picture_laws.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const PictureLaws laws("scotoma", "foveal_scotoma");

FovealScotomaParams defaults() { return {1, 0, 0.6f, 1.5f}; }
FovealScotomaParams photographic() { return {1, 1, 0.6f, 1.5f}; }

TEST(FovealScotoma, NoRodsInTheMiddleAllBeyond) {
    EXPECT_EQ(foveal_scotoma::rods_there(defaults(), 0), 0.0);
    EXPECT_EQ(foveal_scotoma::rods_there(defaults(), 0.59), 0.0);
    EXPECT_NEAR(foveal_scotoma::rods_there(defaults(), 1.05), 0.5, 1e-6);
    EXPECT_EQ(foveal_scotoma::rods_there(defaults(), 1.51), 1.0);
    double before = 0;
    for (double deg = 0; deg < 3; deg += 0.01) {
        EXPECT_GE(foveal_scotoma::rods_there(defaults(), deg), before);
        before = foveal_scotoma::rods_there(defaults(), deg);
    }
}

TEST(FovealScotoma, ConesShareIsThatOfTheMesopicModels) {
    const JacobsMesopicParams cie{1, 0, 0, 2, 1.05f, 0.97f, 1.27f};
    for (double y : {1e-6, 1e-3, 0.005, 0.02, 0.3, 4.9, 5.0, 100.0})
        EXPECT_NEAR(foveal_scotoma::cone_share(y), jacobs_mesopic::cone_share(cie, y), 1e-12) << y;
}

TEST(FovealScotoma, BlindInTheDarkWholeByDay) {
    EXPECT_EQ(foveal_scotoma::factor(photographic(), {1e-3, 1e-3}, 0, 1e-3), 0.0);
    EXPECT_EQ(foveal_scotoma::factor(photographic(), {1e-3, 1e-3}, 2, 1e-3), 1.0);
    EXPECT_EQ(foveal_scotoma::factor(photographic(), {1e-3, 1e-3}, 0, 0.1001), 1.0);
    EXPECT_EQ(foveal_scotoma::factor(photographic(), {10, 10}, 0, 1e-3), 1.0) << "a lamp is seen by cones";
    EXPECT_EQ(foveal_scotoma::factor(defaults(), {1e-3, 1e-3}, 0, 1e-3), 1.0) << "the wearer's own fovea is as blind";
    EXPECT_EQ(foveal_scotoma::factor(defaults(), {1e-3, 5}, 0, 1e-3), 0.0);
}

TEST(FovealScotoma, PictureInThePanelsRangeKeepsItsBits) { laws.panel_range_keeps_its_bits({"scotoma.strength=1"}, {1e-5f, 0.02f, 1.0f}); }
TEST(FovealScotoma, StrengthZeroIsBitExact) { laws.strength_zero_is_bit_exact(); }
TEST(FovealScotoma, GpuAgreesWithTheReference) {
    for (const PictureCase& c : {
             PictureCase{"night 1e-3 brightened 1000", rectilinear(120, 80, 6), 1e-3, 0, 1000, {}},
             PictureCase{"dusk 0.05 brightened 50 lamp 1e4", rectilinear(120, 80, 6), 0.05, 1e4, 50, {}},
             PictureCase{
                 "photographic 1e-4 wide", rectilinear(180, 120, 20), 1e-4, 0, 1e4f, {"scotoma.photographic=1", "scotoma.outer_deg=5"}},
         })
        laws.gpu_is_the_reference(c, {0.05, 0.01, 1.0});
    // Only a small part of a headset's picture changes.
    laws.gpu_is_the_reference({"headset's lens 1e-3 brightened 1000", vive_lens(360, 400), 1e-3, 0, 1000, {"scotoma.outer_deg=8"}},
                              {0.05, 0.01, 1.0});
}

TEST(FovealScotoma, IsWhereTheEyeLooksAndNowhereElse) {
    for (const EyeGeometry& g : {rectilinear(240, 160, 30), vive_lens(180, 200)}) {
        const int width = static_cast<int>(g.width), height = static_cast<int>(g.height);
        StageRunner runner({g}, laws.selection({"scotoma.photographic=1"}));
        const ImageF picture = through_lens(textured(width, height, 1e-3), g);
        for (const vec3 gaze : {vec3(0, 0, -1), glm::normalize(vec3(0.15f, 0.05f, -1)), glm::normalize(vec3(-0.25f, 0.1f, -1))}) {
            runner.stage().set_adaptation(1e-3f);
            FrameInput input = still_input(1);
            input.eyes[0].gaze_direction = gaze;
            const ImageF out = runner.run(picture, input);
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    if (!geometry::geometry_visible(g, {x + 0.5, y + 0.5})) continue;
                    const double degrees =
                        std::acos(std::min(1.0, glm::dot(geometry::geometry_direction(g, {x + 0.5, y + 0.5}), glm::dvec3(gaze)))) *
                        57.29577951308232;
                    if (degrees > 1.501) {
                        ASSERT_EQ(out.at(x, y, 1), picture.at(x, y, 1)) << x << " " << y;
                    }
                    if (degrees < 0.5) {
                        ASSERT_LT(out.at(x, y, 1), 0.4f * picture.at(x, y, 1)) << x << " " << y;
                    }
                }
        }
    }
}

TEST(FovealScotoma, GazesThatAreNoneChangeNothing) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    StageRunner runner({rectilinear(96, 64, 30)}, laws.selection({"scotoma.photographic=1"}));
    const ImageF picture = textured(96, 64, 1e-3);
    for (const vec3 gaze : {vec3(0, 0, 1), vec3(0, 1, 0), vec3(nan, nan, nan), vec3(0, 0, 0), vec3(0, 0, -20)}) {
        runner.stage().set_adaptation(1e-3f);
        FrameInput input = still_input(1);
        input.eyes[0].gaze_direction = gaze;
        EXPECT_EQ(runner.run(picture, input).data, picture.data);
        EXPECT_TRUE(runner.stage().effects().at(0).gated);
    }
}

TEST(FovealScotoma, ReachesOverTheSeamOfAPanorama) {
    EyeGeometry g{};
    g.kind = geometry_equirect;
    g.width = 720, g.height = 360;
    StageRunner runner({g}, laws.selection({"scotoma.photographic=1"}));
    runner.stage().set_adaptation(1e-3f);
    FrameInput input = still_input(1);
    input.eyes[0].gaze_direction = vec3(0, 0, 1);  // behind: the picture's left and right edges
    const ImageF out = runner.run(uniform(720, 360, 1e-3f), input);
    EXPECT_LT(out.at(0, 180, 0), 1e-5f);
    EXPECT_LT(out.at(719, 180, 0), 1e-5f);
    EXPECT_EQ(out.at(360, 180, 0), 1e-3f);
}

TEST(FovealScotoma, GateHoldsBothWays) {
    StageRunner runner({rectilinear(64, 48, 5)}, with_exposure(laws.selection(), 50));
    GateCount count;
    for (double factor : factors_around_bound()) {
        const auto a = static_cast<float>(0.1 * factor);
        runner.stage().set_adaptation(a);
        const ImageF picture = uniform(64, 48, std::min(a, 2.0f)), out = runner.run(picture, still_input(1));
        const bool is_gated = runner.stage().effects().at(0).gated;
        count.add(is_gated, factor);
        EXPECT_EQ(is_gated, factor > 1) << factor;
        if (is_gated) { EXPECT_EQ(out.data, picture.data) << factor; }
        if (factor < 0.95) { EXPECT_LT(out.at(32, 24, 0), picture.at(32, 24, 0)) << factor; }
    }
    count.expect_both_outcomes();
}

TEST(FovealScotoma, MirroredStaysMirrored) { laws.mirrored_stays_mirrored(8, 1e-3, 1000, 3e-4); }
TEST(FovealScotoma, HardCasesStayFinite) {
    laws.hard_cases_stay_finite({"scotoma.photographic=0", "scotoma.photographic=1", "scotoma.inner_deg=1.5"});
}

}  // namespace
}  // namespace entoptic::perception
