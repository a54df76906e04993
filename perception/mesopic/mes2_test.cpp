// labels: gpu
#include "perception/mesopic/mes2_math.glsl"
#include "perception/mesopic/mesopic_laws.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);

Mes2Params defaults() { return {1, 0, 2.4645f, 2, 1.05f, 0.97f, 1.27f}; }
MesopicLaws laws() {
    return {"mes2", [](double y) { return mes2::cone_share(defaults(), y); }, mes2::rods(defaults())};
}
const char* const name = "mesopic.mes2";

TEST(Mes2, CoefficientAndLuminanceAreThoseOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("mes2")) {
        const double photopic = row.at("Lp_cd_m2"), scotopic = row.at("S_over_P") * photopic,
                     m = mes2::adaptation_coefficient(photopic, scotopic);
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

ENTOPTIC_MESOPIC_LAW_TESTS(Mes2, laws());
TEST(Mes2, GpuAgreesWithTheReference) { laws().gpu_is_the_reference_in_all_cases("mesopic.sp_ratio=1.4", 0.3); }

}  // namespace
}  // namespace entoptic::perception
