// For tests: what the models of rod vision on scene light (rod_vision.h) keep true, as functions of the model's name and formulas.
// Header-only.
#pragma once

#include "perception/mesopic/mesopic.h"
#include "perception/mesopic/rod_vision_math.glsl"
#include "perception/residual.glsl"
#include "perception/testing/gate_sweep.h"
#include "perception/testing/picture_laws.h"

#include <functional>

namespace entoptic::perception::testing {

class MesopicLaws : public PictureLaws {
public:
    // `cone_share` and `rods`: the shader's text in double, at the default parameters.
    MesopicLaws(std::string model, std::function<double(double)> cone_share, const RodVision& rods)
        : PictureLaws("mesopic", std::move(model)), cone_share_(std::move(cone_share)), rods_(rods) {}

    void residual_share_is_one_where_the_panel_is_no_brighter() const {
        for (double scene : {1e-4, 0.02, 0.5, 4.0, 50.0}) {
            const auto share = [&](double exposure) {
                const BothEyes eyes = above_black(scene, scene * exposure, 0.04);
                return residual_share(cone_share_(eyes.scene), cone_share_(eyes.panel));
            };
            EXPECT_EQ(share(1), 1.0) << scene;
            EXPECT_EQ(share(0.3), 1.0) << scene;
            double before = 1;
            for (double e : {1.1, 2.0, 10.0, 100.0, 1e4}) {  // a brighter picture leaves more to simulate
                EXPECT_LE(share(e), before);
                before = share(e);
            }
        }
    }
    void uniform_field_gets_the_operators_colour() const {
        for (double light : {1e-5, 1e-3, 0.02, 0.3}) {
            StageRunner runner({rectilinear(64, 48, 20)}, selection({"mesopic.photographic=1"}));
            const auto y = static_cast<float>(light);
            const ImageF out = runner.run(uniform(64, 48, y, 0.5f * y, 2 * y), still_input(1));
            const glm::dvec3 field(light, 0.5 * light, 2 * light);
            const glm::dvec3 expected = rod_vision::with_rods(rods_, field, cone_share_(colour::luminance(field)));
            for (int c = 0; c < 3; ++c) EXPECT_LT(relative_error(static_cast<double>(out.at(30, 20, c)), expected[c]), 1e-5) << light;
        }
    }
    void lamp_at_night_and_shadow_by_day_keep_their_colour() const {
        // Night 1e-3 with a lamp of 2 degrees, brightened a thousandfold: the lamp is what the cones see.
        const EyeGeometry g = rectilinear(280, 160, 20);
        ImageF night = uniform(280, 160, 1e-3f, 0.5e-3f, 0.2e-3f);
        for (int y = 60; y < 100; ++y)
            for (int x = 120; x < 160; ++x) night.at(x, y, 0) = 90, night.at(x, y, 1) = 40, night.at(x, y, 2) = 5;
        StageRunner runner({g}, with_exposure(selection(), 1000));
        const ImageF out = runner.run(night, still_input(1));
        for (int c = 0; c < 3; ++c) EXPECT_EQ(out.at(140, 80, c), night.at(140, 80, c));
        EXPECT_NE(out.at(10, 10, 0), night.at(10, 10, 0));
        // A shadow of 0.01 in a scene to which the eye is adapted at 20 cd/m².
        runner.stage().set_adaptation(20);
        EXPECT_EQ(runner.run(night, still_input(1)).data, night.data);
        EXPECT_TRUE(runner.stage().effects().at(0).gated);
    }
    void operator_in_float_is_that_in_double() const {
        // By pixel and photographic there is nothing but the operator.
        StageRunner runner({rectilinear(200, 100, 30)}, selection({"mesopic.photographic=1", "mesopic.local_mean_deg=0"}));
        double worst = 0;
        for (double light : {1e-4, 0.01, 0.3, 2.0}) {
            const ImageF picture = textured(200, 100, light), out = runner.run(picture, still_input(1));
            for (std::size_t i = 0; i < picture.data.size(); i += 3) {
                const glm::dvec3 c(picture.data[i], picture.data[i + 1], picture.data[i + 2]);
                const glm::dvec3 seen = rod_vision::with_rods(rods_, c, cone_share_(colour::luminance(c)));
                for (int k = 0; k < 3; ++k)
                    worst = std::max(worst, relative_error(static_cast<double>(out.data[i + static_cast<std::size_t>(k)]), seen[k],
                                                           colour::luminance(c)));
            }
        }
        ledger(name().c_str(), "operator", "float against double max rel", worst);
        EXPECT_LT(worst, 1e-5);
    }
    // Photographic: the gate opens when the darkest pixel falls below twice 5 cd/m², the effect when a local mean falls below 5.
    void gate_holds_both_ways() const {
        const EyeGeometry g = rectilinear(160, 120, 20);
        StageRunner runner({g}, selection({"mesopic.photographic=1"}));
        const float unit = static_cast<float>(1 / colour::luminance({1.0, 0.4, 0.1}));
        GateCount count;
        for (double factor : factors_around_bound()) {
            const float y = std::min(static_cast<float>(10 * factor), 1e8f * 0.2126f);
            const ImageF picture = uniform(160, 120, unit * y, unit * 0.4f * y, unit * 0.1f * y);
            const ImageF out = runner.run(picture, still_input(1));
            const bool is_gated = runner.stage().effects().at(0).gated;
            count.add(is_gated, factor);
            EXPECT_EQ(is_gated, y > 10) << y;
            EXPECT_EQ(out.data == picture.data, y > 5) << y;
        }
        count.expect_both_outcomes();
    }
    // Residual: what is gated is unchanged, and gated is all that the panel shows no brighter or that is seen by day.
    void residual_gate_holds_both_ways() const {
        const EyeGeometry g = rectilinear(160, 120, 20);
        for (float exposure : {0.9f, 0.99f, 1.0f, 1.01f, 1.2f, 3.0f})
            for (float adaptation : {0.01f, 1.0f, 4.9f, 5.1f}) {
                StageRunner residual({g}, with_exposure(selection(), exposure));
                residual.stage().set_adaptation(adaptation);
                const ImageF picture = textured(160, 120, static_cast<double>(adaptation) / 3);
                const ImageF out = residual.run(picture, still_input(1));
                const bool is_gated = residual.stage().effects().at(0).gated;
                EXPECT_EQ(is_gated, exposure <= 1 || adaptation > 5) << exposure << " " << adaptation;
                if (is_gated) { EXPECT_EQ(out.data, picture.data); }
            }
    }
    // `setting`: one of the model's own, tried beside the others. `mean`: the tolerance of the mean dE_ITP.
    void gpu_is_the_reference_in_all_cases(const std::string& setting, double mean) const {
        for (const PictureCase& c : {
                 PictureCase{"night 1e-3 brightened 500", rectilinear(180, 120, 20), 1e-3, 0, 500, {}},
                 PictureCase{"dusk 0.1 brightened 8 lamp 1e4", rectilinear(180, 120, 20), 0.1, 1e4, 8, {}},
                 PictureCase{"headset's lens 0.01 brightened 60", vive_lens(360, 400), 0.01, 0, 60, {}},
                 PictureCase{"photographic by pixel 0.05", rectilinear(211, 97, 30), 0.05, 0, 20,
                             {"mesopic.photographic=1", "mesopic.local_mean_deg=0", setting}},
                 PictureCase{"photographic 104 deg 0.01", rectilinear(301, 177, 104), 0.01, 0, 60, {"mesopic.photographic=1"}},
             })
            gpu_is_the_reference(c, {1.0, mean, 1.0});
    }
    void two_eyes_are_two_pictures() const {
        const EyeGeometry g = rectilinear(96, 64, 20);
        StageRunner runner({g, g}, selection({"mesopic.photographic=1"}));
        const auto out = runner.run({uniform(96, 64, 50, 5, 5), uniform(96, 64, 0.01f, 0.001f, 0.001f)}, still_input(2));
        EXPECT_EQ(out[0].data, uniform(96, 64, 50, 5, 5).data);
        EXPECT_NE(out[1].data, uniform(96, 64, 0.01f, 0.001f, 0.001f).data);
    }

private:
    std::function<double(double)> cone_share_;
    RodVision rods_;
};

}  // namespace entoptic::perception::testing

// The laws that need no word of the model's own, as tests of `suite`; `laws`: an expression that gives MesopicLaws.
#define ENTOPTIC_MESOPIC_LAW_TESTS(suite, laws)                                                                                             \
    TEST(suite, ResidualShareIsOneWhereThePanelIsNoBrighter) { laws.residual_share_is_one_where_the_panel_is_no_brighter(); }                \
    TEST(suite, PictureInThePanelsRangeKeepsItsBits) {                                                                                       \
        laws.panel_range_keeps_its_bits({"mesopic.local_mean_deg=2", "mesopic.local_mean_deg=0"}, {1e-5f, 0.5f, 20.0f});                     \
    }                                                                                                                                        \
    TEST(suite, StrengthZeroIsBitExact) { laws.strength_zero_is_bit_exact(); }                                                               \
    TEST(suite, UniformFieldGetsTheOperatorsColour) { laws.uniform_field_gets_the_operators_colour(); }                                      \
    TEST(suite, LampAtNightAndShadowByDayKeepTheirColour) { laws.lamp_at_night_and_shadow_by_day_keep_their_colour(); }                      \
    TEST(suite, OperatorInFloatIsThatInDouble) { laws.operator_in_float_is_that_in_double(); }                                               \
    TEST(suite, GateHoldsBothWays) { laws.gate_holds_both_ways(); }                                                                          \
    TEST(suite, ResidualGateHoldsBothWays) { laws.residual_gate_holds_both_ways(); }                                                         \
    TEST(suite, MirroredStaysMirrored) { laws.mirrored_stays_mirrored(30, 1e-2, 100, 1e-4); }                                                \
    TEST(suite, HardCasesStayFinite) { laws.hard_cases_stay_finite({"mesopic.photographic=0", "mesopic.photographic=1"}); }                  \
    TEST(suite, TwoEyesAreTwoPictures) { laws.two_eyes_are_two_pictures(); }                                                                 \
    static_assert(true, "takes the semicolon")
