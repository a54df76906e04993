// labels: gpu
#include "perception/acuity/acuity.h"
#include "perception/acuity/acuity_laws.h"
#include "perception/acuity/larson_increment_math.glsl"
#include "perception/acuity/local_blur_math.glsl"
#include "perception/patch_noise.glsl"
#include "perception/testing/gate_sweep.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "acuity.larson_increment";

LarsonIncrementParams defaults() { return {1, 0, 2, 0, 0.7f, 6}; }
const AcuityLaws laws("larson_increment");

// Weights 0 .. radius of the kernel, by the shader's recurrence.
std::vector<double> kernel(double variance) {
    const int radius = local_blur::blur_radius(variance);
    std::vector<double> w(static_cast<std::size_t>(radius) + 1);
    double weight = 1, outer = 0, total = 0;
    for (int n = radius; n >= 0; --n) {
        w[static_cast<std::size_t>(n)] = weight;
        total += (n > 0 ? 2 : 1) * weight;
        if (n > 0) {
            const double inner = local_blur::inner_weight(weight, outer, n, variance);
            outer = weight;
            weight = inner;
        }
    }
    for (double& v : w) v /= total;
    return w;
}

TEST(LarsonAcuity, CurveIsThatOfTheTables) {
    double worst = 0;
    for (const OracleRow& row : oracle("acuity_larson")) {
        worst = std::max(worst, relative_error(larson_increment::resolved_cpd(row.at("Y_cd_m2")), row.at("R_cycles_per_deg")));
        worst = std::max(worst, relative_error(larson_increment::sigma_arcmin(row.at("Y_cd_m2")), row.at("sigma_arcmin")));
    }
    for (const OracleRow& row : oracle("acuity_inverse"))
        worst = std::max(worst, relative_error(larson_increment::resolved_cpd(row.at("Y_exact_cd_m2")), row.at("R_cpd")));
    ledger(name, "equation 11", "double against oracle max rel", worst);
    EXPECT_LT(worst, 1e-6);
}

TEST(LarsonAcuity, CurveFitsTheMeasuredAcuity) {
    double squares = 0, worst = 0;
    int points = 0;
    for (const OracleRow& row : oracle("acuity_shlaer_data")) {
        const double error = larson_increment::resolved_cpd(row.at("luminance_cd_m2")) - row.at("shlaer_cycles_per_deg");
        squares += error * error;
        worst = std::max(worst, std::abs(error));
        ++points;
    }
    EXPECT_EQ(points, 20);
    EXPECT_LT(std::sqrt(squares / points), 1.35);  // cycles per degree; Larson's fit
    EXPECT_LT(worst, 2.9);
}

TEST(LarsonAcuity, IncrementIsThatOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("acuity_increment")) {
        const BothEyes eyes{row.at("scene_cd_m2"), row.at("display_cd_m2")};
        worst = std::max(worst, std::abs(std::sqrt(larson_increment::added_variance(defaults(), eyes, {0, 0, 13.85})) -
                                         row.at("sigma_add_arcmin_minus_pixel_box")));
        worst = std::max(worst, std::abs(std::sqrt(larson_increment::added_variance(defaults(), eyes, {0, 0, 1e6})) -
                                         row.at("sigma_add_arcmin_no_pixel")));
        if (eyes.scene >= eyes.panel) { EXPECT_EQ(larson_increment::added_variance(defaults(), eyes, {0, 0, 1e6}), 0.0); }
    }
    ledger(name, "increment", "double against oracle max arcmin", worst);
    EXPECT_LT(worst, 1e-6);
}

TEST(LarsonAcuity, KernelHasItsVarianceAndSumsToOne) {
    for (double sigma : {0.05, 0.2, 0.5, 1.0, 2.7, 7.0, 20.0, 36.0}) {
        const std::vector<double> w = kernel(sigma * sigma);
        double sum = 0, variance = 0;
        for (std::size_t n = 0; n < w.size(); ++n) {
            sum += (n > 0 ? 2 : 1) * w[n];
            variance += 2 * w[n] * static_cast<double>(n * n);
            const double exact =
                std::cyl_bessel_i(static_cast<double>(n), std::min(sigma * sigma, 600.0)) * std::exp(-std::min(sigma * sigma, 600.0));
            if (sigma < 24) { EXPECT_NEAR(w[n], exact, 2e-3 * w[0]) << sigma << " " << n; }
        }
        EXPECT_NEAR(sum, 1, 1e-12);
        EXPECT_NEAR(variance / (sigma * sigma), 1, 0.01) << sigma;
        EXPECT_LE(w.size(), static_cast<std::size_t>(local_blur::max_blur_radius) + 1);
    }
}

TEST(LarsonAcuity, WideKernelIsTheGaussian) {
    // The oracle is the unit step seen through a Gaussian; the discrete one sums to the same between pixels, for a kernel of some pixels.
    double worst = 0;
    for (const OracleRow& row : oracle("gaussian_step")) {
        const double x = row.at("x"), sigma = row.at("sigma");
        if (x < 0 || std::floor(x) == x || sigma < 2) continue;
        const std::vector<double> w = kernel(sigma * sigma - 1.0 / 12);  // the table's kernel is integrated over the pixel
        double beyond = 0;
        for (std::size_t n = static_cast<std::size_t>(x + 0.5); n < w.size(); ++n) beyond += w[n];
        worst = std::max(worst, std::abs(1 - beyond - row.at("blurred_unit_step")));
    }
    ledger(name, "kernel from 2 px", "double against oracle max", worst);
    EXPECT_LT(worst, 2e-3);
}

TEST(LarsonAcuity, NoiseIsNormalEverywhereAndSmooth) {
    double sum = 0, squares = 0, fourth = 0;
    const int points = 40000;
    for (int i = 0; i < points; ++i) {
        const double x = patch::patch_noise(7, {i * 0.7316, i * 0.1937 - 300}, static_cast<std::uint32_t>(i % 91), (i % 13) / 13.0);
        sum += x, squares += x * x, fourth += x * x * x * x;
    }
    EXPECT_NEAR(sum / points, 0, 0.03);
    EXPECT_NEAR(squares / points, 1, 0.03);
    EXPECT_NEAR(fourth / points, 3, 0.25);
    for (double t = 0; t < 3; t += 0.01) {
        const auto at = [](double time) {
            return patch::patch_noise(7, {3.3, 4.4}, static_cast<std::uint32_t>(time), time - std::floor(time));
        };
        EXPECT_LT(std::abs(at(t + 0.01) - at(t)), 0.12);
    }
}

TEST(LarsonAcuity, PictureInThePanelsRangeKeepsItsBits) {
    laws.panel_range_keeps_its_bits({"acuity.randomness=0", "acuity.randomness=0.25"});
}
TEST(LarsonAcuity, StrengthZeroIsBitExact) { laws.strength_zero_is_bit_exact(); }

TEST(LarsonAcuity, UniformFieldIsUnchanged) {
    for (const EyeGeometry& g : {rectilinear(101, 77, 8), vive_lens(180, 200)}) {
        StageRunner runner({g}, with_exposure(laws.selection(), 1000));
        for (float y : {1e-6f, 1e-4f, 0.01f}) {
            const ImageF picture = uniform(static_cast<int>(g.width), static_cast<int>(g.height), y, 0.3f * y, 2 * y),
                         out = runner.run(picture, still_input(1));
            double worst = 0;
            for (int j = 0; j < picture.height; ++j)
                for (int i = 0; i < picture.width; ++i)
                    if (geometry::geometry_visible(g, {i + 0.5, j + 0.5}))
                        for (int c = 0; c < 3; ++c)
                            worst = std::max(
                                worst, relative_error(static_cast<double>(out.at(i, j, c)), static_cast<double>(picture.at(i, j, c))));
            EXPECT_LT(worst, 2e-6) << y;
        }
    }
}

TEST(LarsonAcuity, GpuAgreesWithTheReference) {
    for (const PictureCase& c : {
             PictureCase{"night 1e-3 brightened 1000", rectilinear(140, 100, 10), 1e-3, 0, 1000, {}},
             PictureCase{"night 1e-5 brightened 1e4", rectilinear(110, 80, 8), 1e-5, 0, 1e4f, {}},
             PictureCase{"dusk 0.05 brightened 20 lamp 1e4", rectilinear(140, 100, 10), 0.05, 1e4, 20, {}},
             PictureCase{"headset's lens 1e-3 brightened 1000", vive_lens(270, 300), 1e-3, 0, 1000, {}},
             PictureCase{"photographic 20 ppd 0.01", rectilinear(131, 91, 6.5), 0.01, 0, 60, {"acuity.photographic=1"}},
             PictureCase{"random 0.01", rectilinear(140, 100, 10), 0.01, 0, 60, {"acuity.randomness=0.25"}},
         })
        laws.gpu_is_the_reference(c, AcuityLaws::stack_tolerance(c, c.setting.starts_with("random"), 5.0));
}

TEST(LarsonAcuity, EdgeIsBlurredByTheIncrement) {
    // 1e-3 | 1.2e-3 cd/m², brightened a thousandfold: 7.5 arcmin of missing acuity at 20 ppd.
    const int width = 256;
    const double hfov = 2 * std::atan(width / 2 / (20.0 * 180 / 3.14159265358979)) * 180 / 3.14159265358979;
    ImageF picture = uniform(width, 64, 1e-3f);
    for (int y = 0; y < 64; ++y)
        for (int x = width / 2; x < width; ++x)
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 1.2e-3f;
    StageRunner runner({rectilinear(width, 64, hfov)}, with_exposure(laws.selection(), 1000));
    const ImageF out = runner.run(picture, still_input(1));
    const double sigma = std::sqrt(larson_increment::added_variance(defaults(), {1.1e-3, 1.1}, {0, 0, 20})) * 20 / 60;
    EXPECT_NEAR(sigma, 2.39, 0.1);
    for (int k = 0; k < 8; ++k)
        EXPECT_NEAR((static_cast<double>(out.at(width / 2 + k, 32, 1)) - 1e-3) / 0.2e-3,
                    0.5 + 0.5 * std::erf((k + 0.5) / sigma / std::sqrt(2)), 0.01)
            << k;
}

TEST(LarsonAcuity, LampStaysSharpAndDoesNotBleed) {
    ImageF picture = uniform(160, 120, 1e-4f);
    for (int y = 58; y < 61; ++y)
        for (int x = 78; x < 81; ++x)
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 1e4f;
    StageRunner runner({rectilinear(160, 120, 11.5)}, with_exposure(laws.selection(), 1e4f));
    const ImageF out = runner.run(picture, still_input(1));
    EXPECT_EQ(out.at(79, 59, 0), 1e4f);  // its surroundings have 1 cd/m² and more: sharp
    for (int y = 0; y < 120; ++y)
        for (int x = 0; x < 160; ++x)
            if (picture.at(x, y, 0) < 1) { ASSERT_NEAR(out.at(x, y, 0), 1e-4f, 1e-7f) << x << " " << y; }
}

TEST(LarsonAcuity, BrightHalfKeepsItsBits) {
    // Left half night, right half 30 cd/m²: from 2 degrees beyond the border nothing changes.
    ImageF picture = textured(256, 64, 1e-3);
    const ImageF day = textured(256, 64, 30, 0, 3);
    for (int y = 0; y < 64; ++y)
        for (int x = 128; x < 256; ++x)
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = std::max(day.at(x, y, c), 1.0f);
    StageRunner runner({rectilinear(256, 64, 18)}, with_exposure(laws.selection(), 3));
    const ImageF out = runner.run(picture, still_input(1));
    EXPECT_FALSE(runner.stage().effects().at(0).gated);
    for (int y = 0; y < 64; ++y)
        for (int x = 128; x < 256; ++x) ASSERT_EQ(out.at(x, y, 0), picture.at(x, y, 0));
    EXPECT_NE(out.at(20, 30, 0), picture.at(20, 30, 0));
    // And a second frame does not see the first one's rows.
    const ImageF next = textured(256, 64, 1e-2, 0, 7);
    StageRunner fresh({rectilinear(256, 64, 18)}, with_exposure(laws.selection(), 3));
    EXPECT_EQ(runner.run(next, still_input(1)).data, fresh.run(next, still_input(1)).data);
}

TEST(LarsonAcuity, GateHoldsBothWays) {
    // Brightened tenfold a field is blurred as long as its mean is below some 0.2 cd/m².
    const EyeGeometry g = rectilinear(48, 36, 3.45);
    const double ppd = geometry::geometry_ppd(g, {24, 18});
    const double bound = largest_luminance(1e-3, 10, [&](double y) {
        return larson_increment::added_variance(defaults(), {y, 10 * y}, {0, 0, ppd}) > 0;
    });
    StageRunner runner({g}, with_exposure(laws.selection(), 10));
    GateCount count;
    for (double factor : factors_around_bound()) {
        const ImageF picture = chequered(48, 36, static_cast<float>(factor * bound));
        const ImageF out = runner.run(picture, still_input(1));
        const bool is_gated = runner.stage().effects().at(0).gated;
        count.add(is_gated, factor);
        const double change =
            summary(relative_errors(convert<double>(picture), laws.reference(picture, g, laws.parameters(), 10), 1e-9)).max;
        EXPECT_EQ(is_gated, change == 0) << factor;
        EXPECT_EQ(out.data == picture.data, change == 0) << factor;
    }
    count.expect_both_outcomes();
}

TEST(LarsonAcuity, NoiseDoesNotDependOnTheFrameRate) { laws.noise_does_not_depend_on_the_frame_rate({"acuity.randomness=0.25"}); }
TEST(LarsonAcuity, MirroredStaysMirrored) { laws.mirrored_stays_mirrored(14, 1e-3, 1000, 1e-3); }
TEST(LarsonAcuity, HardCasesStayFinite) {
    laws.hard_cases_stay_finite({"acuity.randomness=0", "acuity.randomness=0.5", "acuity.photographic=1"});
}

}  // namespace
}  // namespace entoptic::perception
