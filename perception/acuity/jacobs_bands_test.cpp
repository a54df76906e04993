// labels: gpu
#include "perception/acuity/acuity.h"
#include "perception/acuity/acuity_laws.h"
#include "perception/acuity/jacobs_bands_math.glsl"
#include "perception/acuity/local_blur_math.glsl"
#include "perception/patch_noise.glsl"
#include "perception/testing/gate_sweep.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "acuity.jacobs_bands";

JacobsBandsParams defaults() { return {1, 0, 0, 2, 0.25f, 0.7f, 6, 0}; }
const AcuityLaws laws("jacobs_bands");

// Double, 1-D, periodic.
std::vector<double> gaussian(const std::vector<double>& in, double variance) {
    std::vector<double> out(in.size());
    const int size = static_cast<int>(in.size());
    for (int i = 0; i < size; ++i)
        for (int k = -60; k <= 60; ++k)
            out[static_cast<std::size_t>(i)] +=
                in[static_cast<std::size_t>((i + k + size) % size)] * std::cyl_bessel_i(std::abs(k), variance) * std::exp(-variance);
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
    for (int i = 0; i < 20000; ++i)
        noise.push_back(patch::patch_noise(3, {i * 0.7316, i * 0.1937}, static_cast<std::uint32_t>(i % 91), (i % 13) / 13.0));
    double worst = 0;
    for (const OracleRow& row : oracle("jacobs_acuity_bands"))
        for (double rho : {0.0, 0.25, 0.5, 0.75, 1.0}) {
            const auto kept = std::count_if(noise.begin(), noise.end(), [&](double x) { return rho + 0.25 * x > row.at("rho_i"); });
            const std::string column = rho == 0   ? "P_keep_rho0"
                                       : rho == 1 ? "P_keep_rho1"
                                                  : "P_keep_rho" + std::to_string(rho).substr(0, rho == 0.5 ? 3 : 4);
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
    EXPECT_EQ(jacobs_bands::lost_variance(p, 5.001, -4), 0.0);  // by day no noise takes anything
    EXPECT_GT(jacobs_bands::lost_variance(p, 0.5, -2), jacobs_bands::lost_variance(p, 0.5, 2));
    p.eccentricity_per_deg = 0.3f;
    EXPECT_NEAR(jacobs_bands::added_variance(p, {0.01, 5}, {0, 10, 14}) / jacobs_bands::added_variance(p, {0.01, 5}, {0, 0, 14}), 16, 1e-5);
}

TEST(JacobsBands, PictureInThePanelsRangeKeepsItsBits) {
    laws.panel_range_keeps_its_bits({"acuity.randomness=0", "acuity.randomness=0.25"});
}
TEST(JacobsBands, StrengthZeroIsBitExact) { laws.strength_zero_is_bit_exact(); }
TEST(JacobsBands, GpuAgreesWithTheReference) {
    for (const PictureCase& c : {
             PictureCase{"night 1e-3 brightened 100 steady", rectilinear(120, 80, 9), 1e-3, 0, 100, {"acuity.randomness=0"}},
             PictureCase{"dusk 0.3 brightened 10 with noise", rectilinear(120, 80, 9), 0.3, 0, 10, {}},
             PictureCase{"photographic 0.1 eccentricity",
                         rectilinear(120, 80, 20),
                         0.1,
                         0,
                         20,
                         {"acuity.photographic=1", "acuity.randomness=0", "acuity.eccentricity_per_deg=0.3"}},
         })
        laws.gpu_is_the_reference(c, AcuityLaws::stack_tolerance(c, c.setting.ends_with("noise"), 2.0));
}
TEST(JacobsBands, NoiseDoesNotDependOnTheFrameRate) { laws.noise_does_not_depend_on_the_frame_rate({"acuity.range=0"}); }
TEST(JacobsBands, HardCasesStayFinite) {
    laws.hard_cases_stay_finite({"acuity.randomness=0", "acuity.randomness=0.5", "acuity.photographic=1"});
}

TEST(JacobsBands, GateHoldsBothWays) {
    // Photographic, without noise: pixels of 0.95 and 1.05 y. Gate and effect both go by the local mean, which is y: 5 cd/m².
    StageRunner runner({rectilinear(64, 48, 10)}, laws.selection({"acuity.photographic=1", "acuity.randomness=0"}));
    GateCount count;
    for (double factor : factors_around_bound()) {
        const ImageF picture = chequered(64, 48, static_cast<float>(5 * factor));
        const ImageF out = runner.run(picture, still_input(1));
        const bool is_gated = runner.stage().effects().at(0).gated;
        count.add(is_gated, factor);
        EXPECT_EQ(is_gated, factor > 1) << factor;
        EXPECT_EQ(out.data == picture.data, factor > 1) << factor;
    }
    count.expect_both_outcomes();
}

}  // namespace
}  // namespace entoptic::perception
