// labels: gpu
#include "perception/mesopic/mes2_math.glsl"
#include "perception/local_mean_math.glsl"
#include "perception/mesopic/mesopic.h"
#include "perception/residual.glsl"
#include "perception/testing/exposure.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"
#include "shaders/geometry.glsl"

#include <limits>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "mesopic.mes2";

Mes2Params defaults() { return {1, 0, 2.4645f, 2, 1.05f, 0.97f, 1.27f}; }
Selection model(const std::vector<std::string>& settings = {}) { return only({"mesopic=mes2"}, settings); }
double luminance_at(const ImageF& i, int x, int y) {
    return colour::luminance({static_cast<double>(i.at(x, y, 0)), static_cast<double>(i.at(x, y, 1)), static_cast<double>(i.at(x, y, 2))});
}

ImageD reference(const ImageF& picture, const EyeGeometry& g, const std::vector<float>& parameters, double exposure, double adaptation) {
    ReferenceFrame frame{convert<double>(picture), g, {}, {}, 0, false, adaptation, 1};
    frame.displayed = exposed(exposure);
    find_model("mesopic", "mes2")->create_reference()->apply(frame, parameters);
    return frame.image;
}

// Colours as the panel shows them at this exposure.
template <class T> ImageD shown(const Image<T>& picture, double exposure) {
    ImageD out = convert<double>(picture);
    for (double& v : out.data) v = std::clamp(v * exposure, 0.04, 130.0);
    return out;
}

TEST(Mes2, CoefficientAndLuminanceAreThoseOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("mes2")) {
        const double photopic = row.at("Lp_cd_m2"), scotopic = row.at("S_over_P") * photopic, m = mes2::adaptation_coefficient(photopic, scotopic);
        worst = std::max(worst, std::abs(m - row.at("m")));
        worst = std::max(worst, relative_error(mes2::mesopic_luminance(m, photopic, scotopic), row.at("Lmes_cd_m2")));
    }
    ledger(name, "CIE 191", "double against oracle max", worst);
    EXPECT_LT(worst, 1e-6);
}

TEST(Mes2, WeightsAreThoseOfAnEqualWhite) {
    const RodVision rods = mes2::rods(defaults());
    EXPECT_NEAR(rods.weight_r + rods.weight_g + rods.weight_b, 1, 1e-6);
    // Scotopic: white counts by its S/P; photopic: by its luminance. Red darkens relative to it, blue brightens.
    EXPECT_NEAR(rod_vision::mesopic_luminance(rods, {1, 1, 1}, 0.0), 2.4645, 1e-6);
    EXPECT_NEAR(rod_vision::mesopic_luminance(rods, {1, 1, 1}, 1.0), 1, 1e-12);
    EXPECT_LT(rod_vision::mesopic_luminance(rods, {1, 0, 0}, 0.0), 0.2126);
    EXPECT_GT(rod_vision::mesopic_luminance(rods, {0, 0, 1}, 0.0), 2.4645 * 0.0722);
    EXPECT_EQ(rod_vision::with_rods(rods, {0, 0, 0}, 0.0), glm::dvec3(0, 0, 0));
}

TEST(Mes2, ResidualShareIsOneWhereThePanelIsNoBrighter) {
    for (double scene : {1e-4, 0.02, 0.5, 4.0, 50.0}) {
        const Mes2Params p = defaults();
        const auto share = [&](double exposure) {
            const BothEyes eyes = above_black(scene, scene * exposure, 0.04);
            return residual_share(mes2::cone_share(p, eyes.scene), mes2::cone_share(p, eyes.panel));
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

TEST(Mes2, PictureInThePanelsRangeKeepsItsBits) {
    const EyeGeometry g = rectilinear(240, 136, 40);
    for (const char* mean : {"mesopic.local_mean_deg=2", "mesopic.local_mean_deg=0"}) {
        StageRunner plain({g}, model({mean})), bright({g}, with_exposure(model({mean}), 0.2f));
        for (double light : {1e-3, 0.1, 3.0, 40.0}) {
            ImageF picture = textured(240, 136, light);
            for (float& v : picture.data) v = std::min(v, 130.0f);
            for (float adaptation : {1e-5f, 0.5f, 20.0f}) {
                plain.stage().set_adaptation(adaptation);
                EXPECT_EQ(plain.run(picture, still_input(1)).data, picture.data) << light;
                EXPECT_TRUE(plain.stage().effects().at(0).gated);
                EXPECT_EQ(bright.run(picture, still_input(1)).data, picture.data) << light;
            }
        }
    }
}

TEST(Mes2, StrengthZeroIsBitExact) {
    StageRunner runner({rectilinear(240, 136, 40)}, with_exposure(model({"mesopic.strength=0"}), 100));
    const ImageF picture = textured(240, 136, 1e-3);
    EXPECT_EQ(runner.run(picture, still_input(1)).data, picture.data);
}

TEST(Mes2, UniformFieldGetsTheOperatorsColour) {
    for (double light : {1e-5, 1e-3, 0.02, 0.3}) {
        StageRunner runner({rectilinear(64, 48, 20)}, model({"mesopic.photographic=1"}));
        const auto y = static_cast<float>(light);
        const ImageF out = runner.run(uniform(64, 48, y, 0.5f * y, 2 * y), still_input(1));
        const double mean = colour::luminance({light, 0.5 * light, 2 * light});
        const glm::dvec3 expected = rod_vision::with_rods(mes2::rods(defaults()), {light, 0.5 * light, 2 * light},
                                                          mes2::cone_share(defaults(), mean));
        for (int c = 0; c < 3; ++c) EXPECT_LT(relative_error(static_cast<double>(out.at(30, 20, c)), expected[c]), 1e-5) << light;
    }
}

TEST(Mes2, LampAtNightAndShadowByDayKeepTheirColour) {
    // Night 1e-3 with a lamp of 2 degrees, brightened a thousandfold: the lamp is what the cones see.
    const EyeGeometry g = rectilinear(280, 160, 20);
    ImageF night = uniform(280, 160, 1e-3f, 0.5e-3f, 0.2e-3f);
    for (int y = 60; y < 100; ++y)
        for (int x = 120; x < 160; ++x) night.at(x, y, 0) = 90, night.at(x, y, 1) = 40, night.at(x, y, 2) = 5;
    StageRunner runner({g}, with_exposure(model(), 1000));
    const ImageF out = runner.run(night, still_input(1));
    for (int c = 0; c < 3; ++c) EXPECT_EQ(out.at(140, 80, c), night.at(140, 80, c));
    EXPECT_NE(out.at(10, 10, 0), night.at(10, 10, 0));
    // A shadow of 0.01 in a scene to which the eye is adapted at 20 cd/m².
    runner.stage().set_adaptation(20);
    EXPECT_EQ(runner.run(night, still_input(1)).data, night.data);
    EXPECT_TRUE(runner.stage().effects().at(0).gated);
}

struct Case {
    std::string setting;
    EyeGeometry geometry;
    double light, lamp;
    float exposure;
    std::vector<std::string> settings;
};

TEST(Mes2, GpuAgreesWithTheReference) {
    const std::vector<Case> cases = {
        {"night 1e-3 brightened 500", rectilinear(180, 120, 20), 1e-3, 0, 500, {}},
        {"dusk 0.1 brightened 8 lamp 1e4", rectilinear(180, 120, 20), 0.1, 1e4, 8, {}},
        {"headset's lens 0.01 brightened 60", vive_lens(360, 400), 0.01, 0, 60, {}},
        {"photographic by pixel 0.05", rectilinear(211, 97, 30), 0.05, 0, 20, {"mesopic.photographic=1", "mesopic.local_mean_deg=0", "mesopic.sp_ratio=1.4"}},
        {"photographic 104 deg 0.01", rectilinear(301, 177, 104), 0.01, 0, 60, {"mesopic.photographic=1"}},
    };
    for (const Case& c : cases) {
        const int width = static_cast<int>(c.geometry.width), height = static_cast<int>(c.geometry.height);
        ImageF picture = textured(width, height, c.light, c.lamp);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (!geometry::geometry_visible(c.geometry, {x + 0.5, y + 0.5}))
                    for (int k = 0; k < 3; ++k) picture.at(x, y, k) = 0;
        const Selection selection = with_exposure(model(c.settings), c.exposure);
        StageRunner runner({c.geometry}, selection);
        runner.stage().set_adaptation(static_cast<float>(c.light));
        const ImageF gpu = runner.run(picture, still_input(1));
        const auto exposure = static_cast<double>(c.exposure);
        const ImageD truth = reference(picture, c.geometry, selection.choices[0].parameters, exposure, static_cast<double>(static_cast<float>(c.light)));
        const ErrorSummary error = summary(delta_e_itp(shown(gpu, exposure), shown(truth, exposure)));
        const ErrorSummary effect = summary(delta_e_itp(shown(picture, exposure), shown(truth, exposure)));
        ledger(name, c.setting, "float against reference p99 dE_ITP", error.p99);
        ledger(name, c.setting, "float against reference max dE_ITP", error.max);
        std::printf("  (the effect itself: p99 dE_ITP %.3g, mean %.3g)\n", effect.p99, effect.mean);
        EXPECT_GT(effect.p99, 1.0) << c.setting;
        EXPECT_LT(error.p99, 1.0) << c.setting;
        EXPECT_LT(error.mean, 0.3) << c.setting;
    }
}

TEST(Mes2, OperatorInFloatIsThatInDouble) {
    // By pixel and photographic there is nothing but the operator.
    StageRunner runner({rectilinear(200, 100, 30)}, model({"mesopic.photographic=1", "mesopic.local_mean_deg=0"}));
    double worst = 0;
    for (double light : {1e-4, 0.01, 0.3, 2.0}) {
        const ImageF picture = textured(200, 100, light), out = runner.run(picture, still_input(1));
        for (std::size_t i = 0; i < picture.data.size(); i += 3) {
            const glm::dvec3 c(picture.data[i], picture.data[i + 1], picture.data[i + 2]);
            const glm::dvec3 seen = rod_vision::with_rods(mes2::rods(defaults()), c, mes2::cone_share(defaults(), colour::luminance(c)));
            for (int k = 0; k < 3; ++k)
                worst = std::max(worst, relative_error(static_cast<double>(out.data[i + static_cast<std::size_t>(k)]), seen[k], colour::luminance(c)));
        }
    }
    ledger(name, "operator", "float against double max rel", worst);
    EXPECT_LT(worst, 1e-5);
}

TEST(Mes2, GateHoldsBothWays) {
    // Photographic: the gate opens when the darkest pixel falls below twice 5 cd/m², the effect when a local mean falls below 5.
    const EyeGeometry g = rectilinear(160, 120, 20);
    StageRunner runner({g}, model({"mesopic.photographic=1"}));
    int ran = 0, gated = 0, near_bound = 0;
    for (float y : {1e-6f, 0.01f, 1.0f, 4.0f, 4.9f, 5.1f, 8.1f, 9.0f, 9.5f, 9.9f, 10.1f, 10.5f, 11.0f, 11.9f, 20.0f, 1e3f, 1e8f}) {
        const ImageF picture = uniform(160, 120, y, 0.4f * y, 0.1f * y);
        const float scale = static_cast<float>(1 / luminance_at(uniform(1, 1, 1, 0.4f, 0.1f), 0, 0));
        ImageF scaled = picture;
        for (float& v : scaled.data) v = std::min(v * scale, 1e8f);
        const ImageF out = runner.run(scaled, still_input(1));
        const bool is_gated = runner.stage().effects().at(0).gated;
        (is_gated ? gated : ran)++;
        near_bound += y > 8 && y < 12;
        EXPECT_EQ(is_gated, y > 10) << y;
        EXPECT_EQ(out.data == scaled.data, y > 5) << y;
    }
    std::printf("gate: ran %d, gated %d, near the bound %d\n", ran, gated, near_bound);
    EXPECT_GE(4 * near_bound, ran + gated);
    // Residual: whatever is gated is unchanged by the reference, too.
    for (float exposure : {0.9f, 0.99f, 1.0f, 1.01f, 1.2f, 3.0f})
        for (float adaptation : {0.01f, 1.0f, 4.9f, 5.1f}) {
            StageRunner residual({g}, with_exposure(model(), exposure));
            residual.stage().set_adaptation(adaptation);
            const ImageF picture = textured(160, 120, static_cast<double>(adaptation) / 3);
            const ImageF out = residual.run(picture, still_input(1));
            const bool is_gated = residual.stage().effects().at(0).gated;
            EXPECT_EQ(is_gated, exposure <= 1 || adaptation > 5) << exposure << " " << adaptation;
            if (is_gated) {
                EXPECT_EQ(out.data, picture.data);
            }
        }
}

TEST(Mes2, MirroredStaysMirrored) {
    StageRunner runner({rectilinear(176, 96, 30)}, with_exposure(model(), 100));
    const ImageF picture = textured(176, 96, 1e-2);
    EXPECT_LT(summary(relative_errors(runner.run(mirrored(picture), still_input(1)), mirrored(runner.run(picture, still_input(1))), 1e-6)).max, 1e-4);
}

TEST(Mes2, HardCasesStayFinite) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const EyeGeometry& g : {rectilinear(1, 1, 100), rectilinear(1011, 27, 104), rectilinear(33, 9, 0.2), vive_lens(90, 100)})
        for (const char* photographic : {"mesopic.photographic=0", "mesopic.photographic=1"}) {
            const int width = static_cast<int>(g.width), height = static_cast<int>(g.height);
            StageRunner runner({g}, with_exposure(model({photographic}), 1e4f));
            for (float y : {0.0f, 1e-6f, 1e8f, nan, inf}) EXPECT_TRUE(all_finite(runner.run(uniform(width, height, y), still_input(1)))) << width << " " << y;
            ImageF picture = textured(width, height, 1e-5, 1e8);
            picture.data[0] = nan;
            picture.data[picture.data.size() / 2] = inf;
            picture.data.back() = -5;
            const ImageF out = runner.run(picture, still_input(1));
            EXPECT_TRUE(all_finite(out)) << width;
            for (float v : out.data) ASSERT_GE(v, 0.0f);
        }
}

TEST(Mes2, TwoEyesAreTwoPictures) {
    const EyeGeometry g = rectilinear(96, 64, 20);
    StageRunner runner({g, g}, model({"mesopic.photographic=1"}));
    const auto out = runner.run({uniform(96, 64, 50, 5, 5), uniform(96, 64, 0.01f, 0.001f, 0.001f)}, still_input(2));
    EXPECT_EQ(out[0].data, uniform(96, 64, 50, 5, 5).data);
    EXPECT_NE(out[1].data, uniform(96, 64, 0.01f, 0.001f, 0.001f).data);
}

}  // namespace
}  // namespace entoptic::perception
