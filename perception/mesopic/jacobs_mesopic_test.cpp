// labels: gpu
#include "perception/mesopic/jacobs_mesopic_math.glsl"
#include "perception/mesopic/mesopic_laws.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);

JacobsMesopicParams defaults() { return {1, 0, 0, 2, 1.05f, 0.97f, 1.27f}; }
MesopicLaws laws() {
    return {"jacobs_mesopic", [](double y) { return jacobs_mesopic::cone_share(defaults(), y); }, jacobs_mesopic::rods(defaults())};
}
const char* const name = "mesopic.jacobs_mesopic";

TEST(Rods, ShareIsThatOfTheTable) {
    // Rows come in threes: appendix A, section 2.3, CIE.
    const float ranges[] = {1, 2, 0};
    double worst = 0;
    int row_number = 0;
    for (const OracleRow& row : oracle("jacobs_rho")) {
        JacobsMesopicParams p = defaults();
        p.range = ranges[row_number++ % 3];
        worst = std::max(worst, std::abs(jacobs_mesopic::cone_share(p, row.at("L_cd_m2")) - row.at("rho_clamped")));
    }
    ledger(name, "equation 13", "double against oracle max", worst);
    EXPECT_LT(worst, 1e-8);
    EXPECT_EQ(row_number, 27);
}

TEST(Rods, ScotopicLuminanceIsThatOfTheTable) {
    double worst = 0;
    const RodVision rods = jacobs_mesopic::rods(defaults());
    for (const OracleRow& row : oracle("jacobs_purkinje")) {
        const glm::dvec3 c(row.at("R"), row.at("G"), row.at("B"));
        worst = std::max(worst, std::abs(rod_vision::mesopic_luminance(rods, c, 0.0) - row.at("Y_scotopic_normalised")));
        worst = std::max(worst, std::abs(rod_vision::mesopic_luminance(rods, c, 1.0) - row.at("Y_photopic")));
    }
    ledger(name, "Purkinje weights", "double against oracle max", worst);
    EXPECT_LT(worst, 1e-7);  // the weights are kept in float
}

TEST(Rods, WhiteKeepsItsLuminanceAndColoursLoseTheirs) {
    const RodVision rods = jacobs_mesopic::rods(defaults());
    for (double rho : {0.0, 0.3, 0.9}) {
        EXPECT_NEAR(colour::luminance(rod_vision::with_rods(rods, {2, 2, 2}, rho)), 2, 1e-6);
        EXPECT_LT(colour::luminance(rod_vision::with_rods(rods, {1, 0, 0}, rho)), 0.2126);  // Purkinje: red darkens
        EXPECT_GT(colour::luminance(rod_vision::with_rods(rods, {0, 0, 1}, rho)), 0.0722);  // and blue brightens
    }
    const glm::dvec3 green = rod_vision::with_rods(rods, {0, 1, 0}, 0.0);
    EXPECT_NEAR(green.x / green.y, 1.05 / 0.97, 1e-6);  // no cones: the tint alone
    EXPECT_EQ(rod_vision::with_rods(rods, {0, 0, 0}, 0.0), glm::dvec3(0, 0, 0));
    EXPECT_EQ(rod_vision::with_rods(rods, {0.3, 7, 0}, 1.0), glm::dvec3(0.3, 7, 0));
}

ENTOPTIC_MESOPIC_LAW_TESTS(Rods, laws());
TEST(Rods, GpuAgreesWithTheReference) { laws().gpu_is_the_reference_in_all_cases("mesopic.range=2", 0.2); }

}  // namespace
}  // namespace entoptic::perception
