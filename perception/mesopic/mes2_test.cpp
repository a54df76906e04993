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

TEST(Mes2, ResidualShareIsOneWhereThePanelIsNoBrighter) { laws().residual_share_is_one_where_the_panel_is_no_brighter(); }
TEST(Mes2, PictureInThePanelsRangeKeepsItsBits) {
    laws().panel_range_keeps_its_bits({"mesopic.local_mean_deg=2", "mesopic.local_mean_deg=0"}, {1e-5f, 0.5f, 20.0f});
}
TEST(Mes2, StrengthZeroIsBitExact) { laws().strength_zero_is_bit_exact(); }
TEST(Mes2, UniformFieldGetsTheOperatorsColour) { laws().uniform_field_gets_the_operators_colour(); }
TEST(Mes2, LampAtNightAndShadowByDayKeepTheirColour) { laws().lamp_at_night_and_shadow_by_day_keep_their_colour(); }
TEST(Mes2, GpuAgreesWithTheReference) {
    for (const PictureCase& c : {
             PictureCase{"night 1e-3 brightened 500", rectilinear(180, 120, 20), 1e-3, 0, 500, {}},
             PictureCase{"dusk 0.1 brightened 8 lamp 1e4", rectilinear(180, 120, 20), 0.1, 1e4, 8, {}},
             PictureCase{"headset's lens 0.01 brightened 60", vive_lens(360, 400), 0.01, 0, 60, {}},
             PictureCase{"photographic by pixel 0.05",
                         rectilinear(211, 97, 30),
                         0.05,
                         0,
                         20,
                         {"mesopic.photographic=1", "mesopic.local_mean_deg=0", "mesopic.sp_ratio=1.4"}},
             PictureCase{"photographic 104 deg 0.01", rectilinear(301, 177, 104), 0.01, 0, 60, {"mesopic.photographic=1"}},
         })
        laws().gpu_is_the_reference(c, {1.0, 0.3, 1.0});
}
TEST(Mes2, OperatorInFloatIsThatInDouble) { laws().operator_in_float_is_that_in_double(); }
TEST(Mes2, GateHoldsBothWays) { laws().gate_holds_both_ways(); }
TEST(Mes2, ResidualGateHoldsBothWays) { laws().residual_gate_holds_both_ways(); }
TEST(Mes2, MirroredStaysMirrored) { laws().mirrored_stays_mirrored(30, 1e-2, 100, 1e-4); }
TEST(Mes2, HardCasesStayFinite) { laws().hard_cases_stay_finite({"mesopic.photographic=0", "mesopic.photographic=1"}); }
TEST(Mes2, TwoEyesAreTwoPictures) { laws().two_eyes_are_two_pictures(); }

}  // namespace
}  // namespace entoptic::perception
