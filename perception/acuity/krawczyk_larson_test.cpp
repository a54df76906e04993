// labels: gpu
#include "perception/acuity/krawczyk_larson_math.glsl"
#include "perception/acuity/acuity.h"
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
const char* const name = "acuity.krawczyk_larson";

Selection model(const std::vector<std::string>& settings = {}) { return only({"acuity=krawczyk_larson"}, settings); }

ImageD reference(const ImageF& picture, const EyeGeometry& g) {
    ReferenceFrame frame{convert<double>(picture), g, {}, {}, 0, false, 1, 1};
    find_model("acuity", "krawczyk_larson")->create_reference()->apply(frame, std::vector<float>{1});
    return frame.image;
}

template <class T> ImageD shown(const Image<T>& picture, double exposure) {
    ImageD out = convert<double>(picture);
    for (double& v : out.data) v = std::clamp(v * exposure, 0.04, 130.0);
    return out;
}

TEST(KrawczykAcuity, SigmaIsThatOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("acuity_larson"))
        for (double ppd : {9.82, 13.85, 20.0, 35.0}) {
            const std::string column = ppd == 9.82 ? "sigma_px_9.82ppd" : ppd == 13.85 ? "sigma_px_13.85ppd" : ppd == 20 ? "sigma_px_20ppd" : "sigma_px_35ppd";
            const double sigma = krawczyk_larson::acuity_sigma_px({1}, luidolt_eq12::lightness(row.at("Y_cd_m2")), ppd);
            // The pixels of the kernel bring the rest of the variance.
            const double expected = std::min(8.0, std::sqrt(std::max(0.0, std::pow(row.at(column), 2) - 1.0 / 12)));
            worst = std::max(worst, std::abs(sigma - expected));
        }
    ledger(name, "equation 11", "double against oracle max px", worst);
    EXPECT_LT(worst, 1e-6);
}

TEST(KrawczykAcuity, KernelHasTheVarianceOfEquation11) {
    for (double sigma : {0.5, 1.0, 3.0}) {
        const double used = std::sqrt(sigma * sigma - 1.0 / 12);
        double variance = 0, before = luidolt_eq12::inside_share(used, 0);
        for (int k = 1; k < 40; ++k) {
            const double share = luidolt_eq12::inside_share(used, k);
            variance += (share - before) * k * k;
            before = share;
        }
        // Half a pixel is too narrow for the identity: 11 % of the variance are missing there.
        EXPECT_NEAR(variance / (sigma * sigma), 1, sigma < 1 ? 0.12 : 0.03) << sigma;
    }
}

TEST(KrawczykAcuity, GpuAgreesWithTheReference) {
    struct Case {
        std::string setting;
        EyeGeometry geometry;
        double light, lamp;
    };
    for (const Case& c : {Case{"night 1e-3", rectilinear(180, 100, 13), 1e-3, 0}, Case{"dusk 0.1 with lamp 1e4", rectilinear(180, 100, 13), 0.1, 1e4},
                          Case{"headset's lens 0.01", vive_lens(270, 300), 0.01, 0}}) {
        const int width = static_cast<int>(c.geometry.width), height = static_cast<int>(c.geometry.height);
        ImageF picture = textured(width, height, c.light, c.lamp);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (!geometry::geometry_visible(c.geometry, {x + 0.5, y + 0.5}))
                    for (int k = 0; k < 3; ++k) picture.at(x, y, k) = 0;
        StageRunner runner({c.geometry}, model());
        const ImageF gpu = runner.run(picture, still_input(1));
        const ImageD truth = reference(picture, c.geometry);
        const ErrorSummary error = summary(delta_e_itp(shown(gpu, 3 / c.light), shown(truth, 3 / c.light)));
        const ErrorSummary effect = summary(delta_e_itp(shown(picture, 3 / c.light), shown(truth, 3 / c.light)));
        ledger(name, c.setting, "float against reference p99 dE_ITP", error.p99);
        ledger(name, c.setting, "float against reference mean dE_ITP", error.mean);
        std::printf("  (the effect itself: p99 dE_ITP %.3g, mean %.3g)\n", effect.p99, effect.mean);
        EXPECT_GT(effect.p99, 5.0) << c.setting;
        EXPECT_LT(error.p99, 1.0) << c.setting;
        EXPECT_LT(error.mean, 0.2) << c.setting;
    }
}

TEST(KrawczykAcuity, UniformFieldAndStrengthZero) {
    StageRunner runner({vive_lens(180, 200)}, model());
    for (float y : {1e-4f, 0.05f}) {
        const ImageF picture = uniform(180, 200, y, 0.3f * y, 2 * y), out = runner.run(picture, still_input(1));
        for (int j = 0; j < 200; ++j)
            for (int i = 0; i < 180; ++i)
                if (geometry::geometry_visible(vive_lens(180, 200), {i + 0.5, j + 0.5})) {
                    ASSERT_LT(relative_error(static_cast<double>(out.at(i, j, 1)), static_cast<double>(picture.at(i, j, 1))), 2e-6);
                }
    }
    StageRunner off({rectilinear(96, 64, 8)}, model({"acuity.strength=0"}));
    EXPECT_EQ(off.run(textured(96, 64, 1e-3), still_input(1)).data, textured(96, 64, 1e-3).data);
}

TEST(KrawczykAcuity, GateHoldsBothWays) {
    const EyeGeometry g = rectilinear(96, 64, 6.9);
    const double ppd = geometry::geometry_ppd(g, {48, 32});
    double bound = 1e-3, above = 100;
    while (above / bound > 1.0001) {
        const double middle = std::sqrt(bound * above);
        (krawczyk_larson::acuity_sigma_px({1}, luidolt_eq12::lightness(middle), ppd) > 0 ? bound : above) = middle;
    }
    StageRunner runner({g}, model());
    int ran = 0, gated = 0, near_bound = 0;
    for (double factor : {1e-5, 0.01, 0.3, 0.85, 0.93, 1.05, 1.5, 1.7, 1.8, 1.9, 1.96, 2.08, 2.15, 2.25, 2.35, 3.0, 30.0, 500.0}) {
        ImageF picture = uniform(96, 64, 50 + static_cast<float>(bound * factor));
        for (int y = 20; y < 40; ++y)
            for (int x = 30; x < 60; ++x)
                for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(bound * factor);
        const ImageF out = runner.run(picture, still_input(1));
        const bool is_gated = runner.stage().effects().at(0).gated;
        (is_gated ? gated : ran)++;
        near_bound += factor > 1.6 && factor < 2.4;
        const bool changes = summary(relative_errors(convert<double>(picture), reference(picture, g), 1e-9)).max > 0;
        if (is_gated) {
            EXPECT_FALSE(changes) << factor;
        }
        EXPECT_EQ(out.data == picture.data, !changes) << factor;
    }
    std::printf("gate: ran %d, gated %d, near the bound %d\n", ran, gated, near_bound);
    EXPECT_GE(ran, 5);
    EXPECT_GE(gated, 5);
    EXPECT_GE(4 * near_bound, ran + gated);
}

TEST(KrawczykAcuity, HardCasesStayFinite) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const EyeGeometry& g : {rectilinear(1, 1, 100), rectilinear(311, 27, 104), rectilinear(33, 9, 0.2), vive_lens(90, 100)}) {
        const int width = static_cast<int>(g.width), height = static_cast<int>(g.height);
        StageRunner runner({g}, model());
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

}  // namespace
}  // namespace entoptic::perception
