// labels: gpu
#include "perception/tone/display_identity_math.glsl"
#include "perception/testing/gate_sweep.h"
#include "perception/tone/tone_laws.h"

#include <cstring>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const ToneLaws laws("display_identity");
constexpr DisplayIdentityParams defaults{0.9f, 23.4f, 0.1f, 0.8f, 0.3f};
constexpr DisplayRange panel{};

// An ordinary application: 8-bit codes, from the panel's black to its white.
ImageF ordinary(int width, int height, double brightest = 1, std::uint32_t seed = 7) {
    ImageF image(width, height, 3);
    std::uint32_t state = seed;
    for (float& v : image.data) {
        state = state * 1664525u + 1013904223u;
        const double linear = colour::srgb_decode((state >> 24) / 255.0) * brightest;
        v = panel.black_cd_m2 + (panel.white_cd_m2 - panel.black_cd_m2) * static_cast<float>(linear);
    }
    return image;
}
bool same_bits(const ImageF& a, const ImageF& b) { return std::memcmp(a.data.data(), b.data.data(), a.data.size() * sizeof(float)) == 0; }

TEST(DisplayIdentity, OrdinaryPicturesPassToTheBit) {
    for (double brightest : {1.0, 0.1, 0.001, 0.0})
        for (float a : {0.0f, 0.04f, 0.5f, 20.0f, 130.0f}) {
            const ImageF picture = ordinary(97, 41, brightest);
            EXPECT_TRUE(same_bits(laws.shown(picture, a), picture)) << brightest << " " << a;
        }
}

TEST(DisplayIdentity, OrdinaryPicturesCostNothing) {
    StageRunner runner({rectilinear(97, 41, 60)}, laws.selection());
    runner.run(ordinary(97, 41), still_input(1));
    ASSERT_EQ(runner.stage().effects().size(), 1u);
    EXPECT_TRUE(runner.stage().effects()[0].gated);
    runner.run(uniform(97, 41, 1000), still_input(1));
    EXPECT_FALSE(runner.stage().effects()[0].gated);
}

// Light above the panel's white changes nothing below the knee, and little until it is much above.
TEST(DisplayIdentity, GoesInSmoothlyAsTheSceneLeavesTheRange) {
    ImageF picture = ordinary(256, 64);
    ImageF last = laws.shown(picture, 20);
    for (double stops = 0.05; stops < 2; stops += 0.05) {
        for (int y = 20; y < 24; ++y)
            for (int x = 100; x < 104; ++x)
                for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(130 * std::exp2(stops));
        const ImageF now = laws.shown(picture, 20);
        const auto errors = code_errors(now, last);
        if (stops > 0.06) {      // the lamp's own pixels come first
            EXPECT_LT(summary(errors).max, 1.5) << stops;
        }
        last = now;
    }
}

TEST(DisplayIdentity, SceneOfTheFacts) {      // white 5.56 A, brightest 8 A: the mean stays within the panel and in order
    double before = 0;
    for (double a : {1e-6, 1e-3, 0.1, 10.0, 1e4, 1e6}) {
        ImageF picture = uniform(256, 64, static_cast<float>(a));
        for (int x = 0; x < 256; ++x)
            for (int y = 0; y < 64; ++y)
                for (int c = 0; c < 3; ++c) picture.at(x, y, c) *= static_cast<float>(std::exp2(3 * std::sin(x * 0.05)));
        const double shown = code(static_cast<double>(laws.shown(picture, static_cast<float>(a)).at(0, 0, 1)));
        EXPECT_GT(shown, before) << a;
        EXPECT_LT(shown, 230) << a;
        before = shown;
    }
}

// A sun that is switched on lowers the exposure within the time constant, never at a step.
TEST(DisplayIdentity, SunFadesItsExposureIn) {
    StageRunner runner({rectilinear(256, 64, 60)}, laws.selection());
    ImageF picture = uniform(256, 64, 120);         // in the shoulder
    runner.stage().set_adaptation(100);
    runner.run(picture, still_input(1));
    for (int y = 20; y < 30; ++y)
        for (int x = 100; x < 110; ++x)
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 1e6f;
    double last = code(120), total = 0;
    for (int i = 0; i < 180; ++i) {
        const double now = code(static_cast<double>(runner.run(picture, still_input(1, 1.0 / 90, false)).at(10, 10, 1)));
        EXPECT_LE(now, last + 1e-3) << i;
        EXPECT_LT(last - now, 6) << i;
        total = std::max(total, std::abs(now - code(120)));
        last = now;
    }
    EXPECT_GT(total, 2);
}

TEST(DisplayIdentity, KnownToBeWithinTheDisplayIsNeverBrightened) {
    StageRunner runner({rectilinear(64, 32, 60)}, laws.selection());
    runner.stage().set_adaptation(0.04f);
    FrameInput input = still_input(1);
    const ImageF nothing_drawn = uniform(64, 32, 0);
    EXPECT_GT(runner.run(uniform(64, 32, 0.01f), input).data[0], 0.05f);
    input.within_display = true;
    EXPECT_TRUE(same_bits(runner.run(nothing_drawn, input), nothing_drawn));
}

// Light of the panel's range is left alone, to the bit; the brightest channel decides.
TEST(DisplayIdentity, GateIsExact) {
    GateCount count;
    StageRunner runner({rectilinear(32, 16, 60)}, laws.selection());
    for (double factor : factors_around_bound(120, 2)) {
        runner.stage().set_adaptation(18);
        ImageF picture = uniform(32, 16, 10, 12, 8);
        picture.at(7, 7, 2) = static_cast<float>(130 * factor);
        const ImageF out = runner.run(picture, still_input(1));
        const bool is_gated = runner.stage().effects().at(0).gated;
        count.add(is_gated, factor);
        EXPECT_EQ(is_gated, factor < 1) << factor;
        EXPECT_EQ(same_bits(out, picture), factor < 1) << factor;
    }
    count.expect_both_outcomes();
}

TEST(DisplayIdentity, GpuIsTheReference) { laws.gpu_is_the_reference(2e-2); }
TEST(DisplayIdentity, BrighterIsNeverDarker) { laws.brighter_is_never_darker(); }
TEST(DisplayIdentity, NeutralStaysNeutral) { laws.neutral_stays_neutral(); }
TEST(DisplayIdentity, StaysOnTheDisplay) { laws.stays_on_the_display(); }
TEST(DisplayIdentity, ThePlanIsWhatIsShown) { laws.the_plan_is_what_is_shown(); }

}  // namespace
}  // namespace entoptic::perception
