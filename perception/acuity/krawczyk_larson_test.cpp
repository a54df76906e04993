// labels: gpu
#include "perception/acuity/krawczyk_larson_math.glsl"
#include "perception/acuity/acuity.h"
#include "perception/acuity/acuity_laws.h"
#include "perception/testing/gate_sweep.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "acuity.krawczyk_larson";
const AcuityLaws laws("krawczyk_larson");

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
    for (const PictureCase& c : {
             PictureCase{"night 1e-3", rectilinear(180, 100, 13), 1e-3, 0, 3000, {}},
             PictureCase{"dusk 0.1 with lamp 1e4", rectilinear(180, 100, 13), 0.1, 1e4, 30, {}},
             PictureCase{"headset's lens 0.01", vive_lens(270, 300), 0.01, 0, 300, {}},
         })
        laws.gpu_is_the_reference(c, {1.0, 0.2, 5.0});
}

TEST(KrawczykAcuity, UniformFieldIsUnchanged) {
    StageRunner runner({vive_lens(180, 200)}, laws.selection());
    for (float y : {1e-4f, 0.05f}) {
        const ImageF picture = uniform(180, 200, y, 0.3f * y, 2 * y), out = runner.run(picture, still_input(1));
        for (int j = 0; j < 200; ++j)
            for (int i = 0; i < 180; ++i)
                if (geometry::geometry_visible(vive_lens(180, 200), {i + 0.5, j + 0.5})) {
                    ASSERT_LT(relative_error(static_cast<double>(out.at(i, j, 1)), static_cast<double>(picture.at(i, j, 1))), 2e-6);
                }
    }
}

TEST(KrawczykAcuity, StrengthZeroIsBitExact) { laws.strength_zero_is_bit_exact(); }

TEST(KrawczykAcuity, GateHoldsBothWays) {
    // A darker patch in 50 cd/m²: the gate opens below twice the bound of the effect.
    const EyeGeometry g = rectilinear(96, 64, 6.9);
    const double ppd = geometry::geometry_ppd(g, {48, 32});
    const double bound =
        largest_luminance(1e-3, 100, [&](double y) { return krawczyk_larson::acuity_sigma_px({1}, luidolt_eq12::lightness(y), ppd) > 0; });
    StageRunner runner({g}, laws.selection());
    GateCount count;
    for (double factor : factors_around_bound()) {
        const auto dark = static_cast<float>(2 * bound * factor);
        ImageF picture = uniform(96, 64, 50 + dark);
        for (int y = 20; y < 40; ++y)
            for (int x = 30; x < 60; ++x)
                for (int c = 0; c < 3; ++c) picture.at(x, y, c) = dark;
        const ImageF out = runner.run(picture, still_input(1));
        const bool is_gated = runner.stage().effects().at(0).gated;
        count.add(is_gated, factor);
        const bool changes = summary(relative_errors(convert<double>(picture), laws.reference(picture, g, laws.parameters()), 1e-9)).max > 0;
        if (is_gated) {
            EXPECT_FALSE(changes) << factor;
        }
        EXPECT_EQ(out.data == picture.data, !changes) << factor;
    }
    count.expect_both_outcomes();
}

TEST(KrawczykAcuity, HardCasesStayFinite) { laws.hard_cases_stay_finite({"acuity.strength=1"}, odd_geometries(311)); }

}  // namespace
}  // namespace entoptic::perception
