// labels: gpu
#include "perception/mesopic/krawczyk_tint_math.glsl"
#include "perception/mesopic/mesopic.h"
#include "perception/testing/exposure.h"
#include "perception/testing/gate_sweep.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"

#include <limits>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "mesopic.krawczyk_tint";

KrawczykTintParams photographic() { return {1, 1, 1.05f, 0.97f, 1.27f}; }
KrawczykTintParams residual() { return {1, 0, 1.05f, 0.97f, 1.27f}; }
Selection model(const std::vector<std::string>& settings = {}) { return only({"mesopic=krawczyk_tint"}, settings); }

// What the panel shows of a textured scene at this exposure.
ImageF displayed_picture(double light, double exposure) {
    ImageF picture = textured(177, 99, light);
    for (float& v : picture.data) v = static_cast<float>(std::clamp(static_cast<double>(v) * exposure, 0.04, 130.0));
    return picture;
}

ImageD reference(const ImageF& picture, const std::vector<float>& parameters, double exposure) {
    ReferenceFrame frame{convert<double>(picture), rectilinear(picture.width, picture.height, 40), {}, {}, 0, false, 1, 1};
    frame.displayed = exposed(exposure);
    find_model("mesopic", "krawczyk_tint")->create_reference()->apply(frame, parameters);
    return frame.image;
}

TEST(KrawczykTint, IsEquation14AtThePixelsOwnLuminance) {
    // The oracle's tint is not normalised: its luminance is 1.0087.
    double worst = 0;
    const glm::dvec3 printed(1.05, 0.97, 1.27);
    for (const OracleRow& row : oracle("scotopic_tint_eq14")) {
        const double share = krawczyk_tint::rod_share(photographic(), {row.at("L_i_cd_m2"), 1});
        const glm::dvec3 out = krawczyk_tint::tinted({row.at("R_in"), row.at("G_in"), row.at("B_in")}, printed, share);
        const double expected[3] = {row.at("R_out"), row.at("G_out"), row.at("B_out")};
        worst = std::max(worst, relative_error(share, row.at("sigma")));
        for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(out[c] - expected[c]));
    }
    ledger(name, "equation 14", "double against oracle max", worst);
    EXPECT_LT(worst, 1e-4);  // the table's luminance weights differ by 3e-4
}

TEST(KrawczykTint, BoundIsThatOfTheTable) {
    for (const OracleRow& row : oracle("gate_tint"))
        EXPECT_GE(krawczyk_tint::bound_codes(photographic(), krawczyk_tint::rod_share(photographic(), {row.at("L_i_cd_m2"), 1})) * 1.0087,
                  row.at("max_code_change_any_colour") * 0.9998);
}

TEST(KrawczykTint, PictureInThePanelsRangeKeepsItsBits) {
    StageRunner runner({rectilinear(177, 99, 40)}, model());
    for (double light : {1e-3, 0.1, 3.0, 40.0}) {
        ImageF picture = textured(177, 99, light);
        for (float& v : picture.data) v = std::min(v, 130.0f);
        EXPECT_EQ(runner.run(picture, still_input(1)).data, picture.data);
        EXPECT_TRUE(runner.stage().effects().at(0).gated);
        StageRunner darkened({rectilinear(177, 99, 40)}, with_exposure(model(), 0.5f));
        EXPECT_EQ(darkened.run(picture, still_input(1)).data, picture.data);
    }
}

TEST(KrawczykTint, StrengthZeroIsBitExact) {
    StageRunner runner({rectilinear(177, 99, 40)}, with_exposure(model({"mesopic.strength=0", "mesopic.photographic=1"}), 1000));
    EXPECT_EQ(runner.run(displayed_picture(1e-3, 1000), still_input(1)).data, displayed_picture(1e-3, 1000).data);
}

TEST(KrawczykTint, LampAtNightKeepsItsColour) {
    ImageF picture = uniform(177, 99, 0.5f, 0.4f, 0.1f);   // 5e-4 cd/m², brightened a thousandfold
    picture.at(50, 50, 0) = 120, picture.at(50, 50, 1) = 60, picture.at(50, 50, 2) = 1;
    StageRunner runner({rectilinear(177, 99, 40)}, with_exposure(model({"mesopic.photographic=1"}), 1));
    StageRunner night({rectilinear(177, 99, 40)}, with_exposure(model({"mesopic.photographic=1"}), 1000));
    const ImageF bright = runner.run(picture, still_input(1)), dark = night.run(picture, still_input(1));
    EXPECT_NEAR(bright.at(50, 50, 2), 1, 0.06f);                                          // 68 cd/m²: rods' share 6e-4
    EXPECT_GT(dark.at(10, 10, 2), 0.4f);                                                  // tinted: blue above red
    EXPECT_GT(dark.at(10, 10, 2), dark.at(10, 10, 0));
    EXPECT_GT(dark.at(50, 50, 2), 1);
}

TEST(KrawczykTint, GpuAgreesWithTheReference) {
    for (const char* setting : {"mesopic.photographic=0", "mesopic.photographic=1"}) {
        ErrorSummary worst;
        for (float exposure : {1.0f, 10.0f, 1000.0f})
            for (double light : {1e-4, 0.01, 1.0}) {
                const Selection selection = with_exposure(model({setting}), exposure);
                StageRunner runner({rectilinear(177, 99, 40)}, selection);
                // The tone model runs first and leaves the picture as it is.
                const ImageF picture = displayed_picture(light, static_cast<double>(exposure));
                const ImageF out = runner.run(picture, still_input(1));
                if (runner.stage().effects().at(0).gated) continue;
                const ErrorSummary error = summary(code_errors(out, reference(picture, selection.find("mesopic")->parameters, static_cast<double>(exposure))));
                worst.max = std::max(worst.max, error.max);
            }
        ledger(name, setting, "float against reference max code", worst.max);
        EXPECT_LT(worst.max, 2e-3) << setting;
    }
}

TEST(KrawczykTint, CurvedToneIsInverted) {
    // key_reinhard's kind of curve, without a straight part: y/(1+y) of the panel's white.
    class Curved final : public Model, public PlansTone {
    public:
        static Result<std::unique_ptr<Model>> create(const ModelContext&) { return std::make_unique<Curved>(); }
        void set_parameters(std::span<const float>) override {}
        Result<void> record(StageIo&) override { return {}; }
        Result<void> plan(StageIo& io) override {
            for (ObserverState& state : io.state.as<ObserverState>()) {
                state.tone.exposure = 65, state.tone.straight_until_cd_m2 = 0, state.tone.scene_white_cd_m2 = 2;
                for (uint i = 0; i < tone_points; ++i) {
                    const double y = tone_luminance(i);
                    state.tone.log10_displayed[i] = static_cast<float>(std::log10(130 * y / (1 + y)));
                }
            }
            return {};
        }
    };
    static const ModelEntry entry{"tone", "curved", "for tests", {}, &Curved::create, nullptr};
    Selection selection = model({"mesopic.photographic=1"});
    selection.choices.insert(selection.choices.begin(), {&entry, {}});
    StageRunner runner({rectilinear(177, 99, 40)}, selection);
    ImageF picture = textured(177, 99, 0.05);
    for (float& v : picture.data) v = static_cast<float>(std::clamp(130 * static_cast<double>(v) / (1 + static_cast<double>(v)), 0.04, 130.0));
    const ImageF out = runner.run(picture, still_input(1));
    ReferenceFrame frame{convert<double>(picture), rectilinear(177, 99, 40), {}, {}, 0, false, 1, 1};
    frame.displayed = [](double y) { return 130 * y / (1 + y); };
    find_model("mesopic", "krawczyk_tint")->create_reference()->apply(frame, selection.find("mesopic")->parameters);
    const ErrorSummary error = summary(code_errors(out, frame.image));
    ledger(name, "curved tone", "float against reference max code", error.max);
    EXPECT_LT(error.max, 0.5);  // the curve is tabulated at 8 points a decade
}

TEST(KrawczykTint, GateHoldsItsBoundBothWays) {
    // Photographic, exposure 1e-3 so that the display shows 20..400 cd/m² of scene: the gate opens at twice 306 cd/m².
    StageRunner runner({rectilinear(64, 32, 40)}, with_exposure(model({"mesopic.photographic=1"}), 1e-3f));
    GateCount count;
    for (double factor : factors_around_bound(120, 3.5)) {
        const auto y = static_cast<float>(612 * factor);
        ImageF scene = uniform(64, 32, 0.2f * y, y, 2 * y);
        const float scale = y / static_cast<float>(colour::luminance({0.2 * static_cast<double>(y), static_cast<double>(y), 2 * static_cast<double>(y)}));
        for (float& v : scene.data) v *= scale;
        const ImageF out = runner.run(scene, still_input(1));
        const EffectOutcome outcome = runner.stage().effects().at(0);
        count.add(outcome.gated, factor);
        if (!outcome.gated) continue;
        EXPECT_EQ(out.data, scene.data);
        EXPECT_LE(outcome.bound_codes, 0.5f);
        EXPECT_LE(255 * 12.92 * krawczyk_tint::rod_share(photographic(), {static_cast<double>(y), 1}) * 1.17, 0.5);
    }
    count.expect_both_outcomes();
}

TEST(KrawczykTint, ResidualIsLessThanPhotographic) {
    for (double scene : {1e-4, 0.01, 0.3})
        for (double exposure : {1.0, 3.0, 100.0}) {
            const BothEyes eyes = above_black(scene, scene * exposure, 0.04);
            EXPECT_LE(krawczyk_tint::rod_share(residual(), eyes), krawczyk_tint::rod_share(photographic(), eyes));
            EXPECT_EQ(krawczyk_tint::rod_share(residual(), above_black(scene, scene, 0.04)), 0.0);
        }
}

TEST(KrawczykTint, HardCasesStayFiniteAndInRange) {
    for (DisplayRange d : {DisplayRange{130, 0.04f}, DisplayRange{1000, 0}, DisplayRange{1, 0.5f}})
        for (const char* setting : {"mesopic.photographic=0", "mesopic.photographic=1"}) {
            StageRunner runner({rectilinear(101, 27, 100)}, with_exposure(model({setting}), 50), d);
            for (float y : {0.0f, d.black_cd_m2, d.white_cd_m2}) {
                const ImageF out = runner.run(uniform(101, 27, y), still_input(1));
                EXPECT_TRUE(all_finite(out));
                for (float v : out.data) ASSERT_LE(v, d.white_cd_m2 * 1.000001f);
            }
            EXPECT_TRUE(all_finite(runner.run(uniform(101, 27, std::numeric_limits<float>::quiet_NaN()), still_input(1))));
        }
    StageRunner tiny({rectilinear(1, 1, 100)}, with_exposure(model(), 50));
    EXPECT_TRUE(all_finite(tiny.run(uniform(1, 1, 1), still_input(1))));
}

}  // namespace
}  // namespace entoptic::perception
