// labels: gpu
// Whole presets on hard input: random bits, any frame rate, odd and impossible sizes.
#include "base/noise.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"

#include <bit>
#include <limits>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);

// Floats of random bits: every sign, exponent, NaN, infinity and denormal.
class Bits {
public:
    explicit Bits(std::uint64_t seed) : seed_(seed) {}
    std::uint64_t word() { return mix64(seed_ ^ mix64(++count_)); }
    float number() { return std::bit_cast<float>(static_cast<std::uint32_t>(word())); }
    double wide() { return std::bit_cast<double>(word()); }
    ImageF image(int width, int height, int channels) {
        ImageF out(width, height, channels);
        for (float& v : out.data) v = number();
        return out;
    }

private:
    std::uint64_t seed_, count_ = 0;
};

// What drivers promise to the stage (finite pupils from 1.5 to 9 mm, unit directions) holds; all else is random, time included.
FrameInput random_input(Bits& bits, std::uint64_t index) {
    FrameInput input = still_input(1, index % 3 == 0 ? bits.wide() : static_cast<double>(bits.word() % 1000) / 1000, bits.word() % 8 == 0);
    input.index = bits.word();
    input.vergence_dioptre = bits.number();
    const auto share = [&] { return static_cast<float>(bits.word() % 10001) / 10000; };
    const vec3 gaze(share() - 0.5f, share() - 0.5f, share() - 0.5f);
    input.eyes[0].gaze_direction = glm::length(gaze) > 0.01f ? glm::normalize(gaze) : vec3(0, 0, -1);
    input.eyes[0].pupil_diameter_mm = 1.5f + 7.5f * share();
    input.eyes[0].eyelid_open = share();
    return input;
}

// Two million pixels in all, in frames that follow each other, so that what one leaves in the eye's state meets the next.
TEST(Presets, RandomBitsStayOnTheDisplay) {
    constexpr int side = 200, frames = 8;
    for (const Preset& preset : presets()) {
        std::vector<std::string> more = {"dof=dioptric_disc", "noise=rod_noise", "scotoma=foveal_scotoma", "eyelid=blink"};
        if (preset.name == "off" || preset.name == "liu2021") more.clear();
        for (const EyeGeometry& g : {rectilinear(side, side, 90), vive_lens(side, side)}) {
            Bits bits(7 + static_cast<std::uint64_t>(g.kind));
            StageRunner runner({g}, value(select(preset.name, more)));
            for (int i = 0; i < frames / 2; ++i) {
                const ImageF out =
                    runner.run(bits.image(side, side, 3), random_input(bits, static_cast<std::uint64_t>(i)), bits.image(side, side, 1));
                const bool toned = runner.stage().selection().find("tone") != nullptr;
                for (float v : out.data)
                    ASSERT_TRUE(std::isfinite(v) && v >= 0 && (!toned || v <= 130.001f)) << preset.name << " frame " << i << ": " << v;
                const ViewOutcome view = runner.stage().view(0);
                ASSERT_TRUE(std::isfinite(view.adaptation_cd_m2) && view.adaptation_cd_m2 <= 1.001e8f) << preset.name;
                for (const EffectOutcome& effect : runner.stage().effects()) ASSERT_EQ(effect.failed, "") << preset.name;
            }
        }
    }
}

// The eye's state a quarter of a second after a step of light does not depend on how often it was asked.
TEST(Presets, FrameRateDoesNotMatter) {
    const std::vector<std::pair<const char*, std::vector<std::string>>> choices = {
        {"combined", {}}, {"luidolt2020", {}}, {"jacobs2015", {}}, {"combined", {"adaptation=pattanaik_slow"}}};
    for (const auto& [preset, models] : choices) {
        const auto seen = [&](int fps) {
            // Without the grain of jacobs2015, which is noise; its own test follows it over frame rates.
            std::vector<std::string> settings;
            if (std::string_view(preset) == "jacobs2015") settings.emplace_back("acuity.randomness=0");
            StageRunner runner({rectilinear(48, 32, 60)}, value(select(preset, models, settings)));
            runner.run(textured(48, 32, 100, 0, 1), still_input(1, 0, true));
            ImageF out;
            for (int i = 0; i < fps / 4; ++i) out = runner.run(textured(48, 32, 0.5, 0, 2), still_input(1, 1.0 / fps, false));
            return std::pair{runner.stage().view(0).adaptation_cd_m2, out};
        };
        const auto [state, picture] = seen(92);
        for (int fps : {44, 1000}) {
            const auto [other_state, other] = seen(fps);
            const double rel = relative_error(static_cast<double>(other_state), static_cast<double>(state));
            const ErrorSummary codes = summary(code_errors(other, picture));
            std::printf("%s %s: %d fps: adaptation differs by %.2g, pictures by %.3g codes at most\n", preset,
                        models.empty() ? "" : models[0].c_str(), fps, rel, codes.max);
            EXPECT_LT(rel, 1e-4) << preset << " " << fps;
            EXPECT_LT(codes.max, 0.05) << preset << " " << fps;
        }
    }
}

TEST(Presets, OddAndTinySizes) {
    for (const Preset& preset : presets())
        for (const auto& [width, height] : {std::pair{1, 1}, {1, 7}, {31, 1}, {33, 65}, {2, 3}}) {
            StageRunner runner({rectilinear(width, height, 60)}, value(select(preset.name)));
            for (float y : {1e-4f, 50.0f, 1e7f})
                for (float v : runner.run(uniform(width, height, y), still_input(1), ImageF(width, height, 1, 2.0f)).data)
                    ASSERT_TRUE(std::isfinite(v) && v >= 0) << preset.name << " " << width << "x" << height;
        }
}

TEST(Presets, ViewsThatCannotBeAreRefused) {
    const auto refusal = [](std::vector<EyeGeometry> views) {
        const auto stage = Stage::create(device(), {std::move(views), {}, value(select("combined")), 1});
        return stage ? std::string() : stage.error().message;
    };
    EXPECT_NE(refusal({}), "");
    EXPECT_NE(refusal({rectilinear(0, 0, 60)}), "");
    EXPECT_NE(refusal({rectilinear(16, 0, 60)}), "");
    EXPECT_NE(refusal({rectilinear(16, 16, 60), rectilinear(16, 8, 60)}), "");
    EXPECT_EQ(refusal({rectilinear(16, 16, 60), rectilinear(16, 16, 60)}), "");
}

}  // namespace
}  // namespace entoptic::perception
