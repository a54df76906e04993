// labels: gpu
#include "perception/acuity/acuity.h"
#include "perception/acuity/jacobs_bands_math.glsl"
#include "perception/acuity/local_blur_math.glsl"
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
const char* const name = "acuity.jacobs_bands";

JacobsBandsParams defaults() { return {1, 0, 0, 2, 0.25f, 0.7f, 6, 0}; }
Selection model(const std::vector<std::string>& settings = {}) { return only({"acuity=jacobs_bands"}, settings); }

ImageD reference(const ImageF& picture, const EyeGeometry& g, const std::vector<float>& parameters, double exposure, double dt_s = 0) {
    ReferenceFrame frame{convert<double>(picture), g, {}, {}, dt_s, false, 1, 1};
    frame.displayed = exposed(exposure);
    find_model("acuity", "jacobs_bands")->create_reference()->apply(frame, parameters);
    return frame.image;
}

template <class T> ImageD shown(const Image<T>& picture, double exposure) {
    ImageD out = convert<double>(picture);
    for (double& v : out.data) v = std::clamp(v * exposure, 0.04, 130.0);
    return out;
}

// Double, 1-D, periodic.
std::vector<double> gaussian(const std::vector<double>& in, double variance) {
    std::vector<double> out(in.size());
    const int size = static_cast<int>(in.size());
    for (int i = 0; i < size; ++i)
        for (int k = -60; k <= 60; ++k)
            out[static_cast<std::size_t>(i)] += in[static_cast<std::size_t>((i + k + size) % size)] * std::cyl_bessel_i(std::abs(k), variance) * std::exp(-variance);
    return out;
}

TEST(JacobsBands, BankIsThatOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("jacobs_acuity_bands"))
        worst = std::max(worst, relative_error(jacobs_bands::bank_sigma_arcmin(row.at("i")), row.at("sigma_arcmin_paper_display")));
    ledger(name, "bank", "double against oracle max rel", worst);
    EXPECT_LT(worst, 1e-7);
    EXPECT_NEAR(jacobs_bands::bank_sigma_arcmin(17), 13.07, 0.01);
}

TEST(JacobsBands, NoiseKeepsBandsAsOftenAsTheTableSays) {
    // P(rho + g X > rho_i) for g = 0.25 with the noise as it is drawn.
    std::vector<double> noise;
    for (int i = 0; i < 20000; ++i) noise.push_back(local_blur::patch_noise(3, {i * 0.7316, i * 0.1937}, static_cast<std::uint32_t>(i % 91), (i % 13) / 13.0));
    double worst = 0;
    for (const OracleRow& row : oracle("jacobs_acuity_bands"))
        for (double rho : {0.0, 0.25, 0.5, 0.75, 1.0}) {
            const auto kept = std::count_if(noise.begin(), noise.end(), [&](double x) { return rho + 0.25 * x > row.at("rho_i"); });
            const std::string column = rho == 0 ? "P_keep_rho0" : rho == 1 ? "P_keep_rho1" : "P_keep_rho" + std::to_string(rho).substr(0, rho == 0.5 ? 3 : 4);
            worst = std::max(worst, std::abs(static_cast<double>(kept) / 20000 - row.at(column)));
        }
    ledger(name, "P(keep)", "sampled against oracle max", worst);
    EXPECT_LT(worst, 0.02);
}

TEST(JacobsBands, SumOfBandsIsTheFirstKeptGaussian) {
    // Equation 14 with binary weights and one X: what the model rests on.
    std::vector<double> signal;
    for (int i = 0; i < 200; ++i) signal.push_back(std::sin(i * 0.7) + (i % 17 == 3 ? 5 : 0));
    std::vector<std::vector<double>> bank = {signal};
    for (int i = 0; i < 6; ++i) bank.push_back(gaussian(signal, std::pow(0.75 * std::pow(2, i / 4.0), 2)));
    for (std::size_t first_kept = 0; first_kept < bank.size(); ++first_kept)
        for (std::size_t x = 0; x < signal.size(); ++x) {
            double sum = bank.back()[x];
            for (std::size_t band = first_kept; band + 1 < bank.size(); ++band) sum += bank[band][x] - bank[band + 1][x];
            ASSERT_NEAR(sum, bank[first_kept][x], 1e-12);
        }
}

TEST(JacobsBands, DetailGoesWithLightTheFinestFirst) {
    JacobsBandsParams p = defaults();
    double before = 0;
    for (double y = 5; y > 1e-4; y *= 0.9) {
        const double lost = jacobs_bands::lost_variance(p, y, 0);
        EXPECT_GE(lost, before);
        EXPECT_LT(lost - before, 0.15 * std::max(lost, 1.0)) << y;  // smooth
        before = lost;
    }
    EXPECT_NEAR(std::sqrt(before), 13.07, 0.01);
    EXPECT_EQ(jacobs_bands::lost_variance(p, 5.001, -4), 0.0);   // by day no noise takes anything
    EXPECT_GT(jacobs_bands::lost_variance(p, 0.5, -2), jacobs_bands::lost_variance(p, 0.5, 2));
    p.eccentricity_per_deg = 0.3f;
    EXPECT_NEAR(jacobs_bands::added_variance(p, {0.01, 5}, {0, 10, 14}) / jacobs_bands::added_variance(p, {0.01, 5}, {0, 0, 14}), 16, 1e-5);
}

TEST(JacobsBands, PictureInThePanelsRangeKeepsItsBits) {
    const EyeGeometry g = rectilinear(240, 136, 20);
    for (const char* setting : {"acuity.randomness=0", "acuity.randomness=0.25"})
        for (float exposure : {1.0f, 0.3f}) {
            StageRunner runner({g}, with_exposure(model({setting}), exposure));
            for (double light : {1e-4, 0.01, 3.0, 40.0}) {
                ImageF picture = textured(240, 136, light);
                for (float& v : picture.data) v = std::min(v, 130.0f);
                EXPECT_EQ(runner.run(picture, still_input(1)).data, picture.data) << light;
                EXPECT_TRUE(runner.stage().effects().at(0).gated);
            }
        }
}

TEST(JacobsBands, StrengthZeroIsBitExact) {
    StageRunner runner({rectilinear(240, 136, 20)}, with_exposure(model({"acuity.strength=0"}), 1000));
    const ImageF picture = textured(240, 136, 1e-3);
    EXPECT_EQ(runner.run(picture, still_input(1)).data, picture.data);
}

struct Case {
    std::string setting;
    EyeGeometry geometry;
    double light, lamp;
    float exposure;
    std::vector<std::string> settings;
};

TEST(JacobsBands, GpuAgreesWithTheReference) {
    const std::vector<Case> cases = {
        {"night 1e-3 brightened 100 steady", rectilinear(120, 80, 9), 1e-3, 0, 100, {"acuity.randomness=0"}},
        {"dusk 0.3 brightened 10 with noise", rectilinear(120, 80, 9), 0.3, 0, 10, {}},
        {"photographic 0.1 eccentricity", rectilinear(120, 80, 20), 0.1, 0, 20, {"acuity.photographic=1", "acuity.randomness=0", "acuity.eccentricity_per_deg=0.3"}},
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
        const ImageF gpu = runner.run(picture, still_input(1, 0.3));
        const auto exposure = static_cast<double>(c.exposure);
        const ImageD truth = reference(picture, c.geometry, selection.choices[0].parameters, exposure, 0.3);
        const ErrorSummary error = summary(delta_e_itp(shown(gpu, exposure), shown(truth, exposure)));
        const ErrorSummary effect = summary(delta_e_itp(shown(picture, exposure), shown(truth, exposure)));
        ledger(name, c.setting, "float against reference p99 dE_ITP", error.p99);
        ledger(name, c.setting, "float against reference mean dE_ITP", error.mean);
        ledger(name, c.setting, "float against reference max dE_ITP", error.max);
        std::printf("  (the effect itself: p99 dE_ITP %.3g, mean %.3g)\n", effect.p99, effect.mean);
        EXPECT_GT(effect.p99, 2.0) << c.setting;
        // Widths that change within a patch of noise cost more.
        const bool random = c.setting.ends_with("noise");
        EXPECT_LT(error.p99, random ? 12 : c.lamp > 0 ? 2.0 : 1.45) << c.setting;
        EXPECT_LT(error.mean, random ? 1.5 : 0.2) << c.setting;
    }
}

TEST(JacobsBands, NoiseDoesNotDependOnTheFrameRate) {
    const EyeGeometry g = rectilinear(120, 80, 10);
    const ImageF picture = textured(120, 80, 0.01);
    const auto after = [&](int frames, double seconds) {
        StageRunner runner({g}, with_exposure(model({"acuity.range=0"}), 60));
        ImageF out;
        for (int i = 0; i < frames; ++i) out = runner.run(picture, still_input(1, seconds / frames, false));
        return out;
    };
    const ImageF once = after(1, 0.5);
    EXPECT_LT(summary(relative_errors(after(45, 0.5), once, 1e-4)).max, 1e-3);
    EXPECT_GT(summary(relative_errors(after(1, 0.2), once, 1e-4)).max, 0.1);
}

TEST(JacobsBands, HardCasesStayFinite) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const EyeGeometry& g : {rectilinear(1, 1, 100), rectilinear(1011, 27, 104), rectilinear(33, 9, 0.2), vive_lens(90, 100)})
        for (const char* setting : {"acuity.randomness=0", "acuity.randomness=0.5", "acuity.photographic=1"}) {
            const int width = static_cast<int>(g.width), height = static_cast<int>(g.height);
            StageRunner runner({g}, with_exposure(model({setting}), 1e4f));
            for (float y : {0.0f, 1e-6f, 1e8f, nan, inf}) EXPECT_TRUE(all_finite(runner.run(uniform(width, height, y), still_input(1)))) << width << " " << y;
            ImageF picture = textured(width, height, 1e-5, 1e8);
            picture.data[0] = nan;
            picture.data[picture.data.size() / 2] = inf;
            picture.data.back() = -5;
            const ImageF out = runner.run(picture, still_input(1, nan));
            EXPECT_TRUE(all_finite(out)) << width;
            for (float v : out.data) ASSERT_GE(v, 0.0f);
        }
}

TEST(JacobsBands, GateHoldsBothWays) {
    // Photographic, without noise: the gate opens when the darkest pixel is below 10, the effect when a local mean is below 5 cd/m².
    StageRunner runner({rectilinear(64, 48, 10)}, model({"acuity.photographic=1", "acuity.randomness=0"}));
    int ran = 0, gated = 0, near_bound = 0;
    for (float y : {1e-6f, 0.01f, 1.0f, 4.1f, 4.5f, 4.8f, 4.95f, 5.05f, 5.2f, 5.5f, 5.9f, 9.0f, 9.9f, 10.1f, 100.0f, 1e6f}) {
        ImageF picture = uniform(64, 48, y);
        for (std::size_t i = 0; i < picture.data.size(); ++i) picture.data[i] *= (i / 3 + i / (3 * 64)) % 2 ? 1.05f : 0.95f;
        const ImageF out = runner.run(picture, still_input(1));
        const bool is_gated = runner.stage().effects().at(0).gated;
        (is_gated ? gated : ran)++;
        near_bound += y > 4 && y < 6;
        EXPECT_EQ(is_gated, y > 5) << y;
        EXPECT_EQ(out.data == picture.data, y > 5) << y;
    }
    std::printf("gate: ran %d, gated %d, near the bound %d\n", ran, gated, near_bound);
    EXPECT_GE(4 * near_bound, ran + gated);
}

}  // namespace
}  // namespace entoptic::perception
