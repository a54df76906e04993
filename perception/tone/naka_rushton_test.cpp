// labels: gpu
#include "perception/tone/naka_rushton_math.glsl"
#include "perception/tone/tone_laws.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const ToneLaws laws("naka_rushton");
constexpr NakaRushtonParams defaults{0.7f, 1, 0, 0};

TEST(NakaRushton, PlateauSigmaAndResponseAreThoseOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("jacobs_naka_rushton")) {
        const double a = row.at("Ibar_cd_m2"), log2_sigma = naka_rushton::log2_half_saturation(defaults, a);
        worst = std::max(worst, relative_error(naka_rushton::plateau(defaults, a), row.at("M_proposed")));
        worst = std::max(worst, relative_error(std::exp2(log2_sigma), row.at("sigma_cd_m2")));
        if (row.at("I_cd_m2") >= 1e-7)      // the response's own floor
            worst = std::max(worst, relative_error(naka_rushton::response(defaults, row.at("I_cd_m2"), log2_sigma), row.at("R")));
    }
    ledger("tone.naka_rushton", "response", "double against oracle max rel", worst);
    EXPECT_LT(worst, 1e-5);     // 0.7f; the table has 6 digits of sigma
}

TEST(NakaRushton, UndoesTheWearersEyeAsInTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("display_mapping")) {
        NakaRushtonParams p = defaults;
        const double r = naka_rushton::response(p, row.at("pixel_cd_m2"), naka_rushton::log2_half_saturation(p, row.at("scene_adapt_cd_m2")));
        worst = std::max(worst, relative_error(naka_rushton::displayed(p, r, 130), row.at("Ld_simple_130R_cd_m2")));
        p.display_adaptation_cd_m2 = static_cast<float>(row.at("display_adapt_cd_m2"));
        const double expected = row.at("Ld_inverse_NR_cd_m2");
        if (expected < 130) worst = std::max(worst, relative_error(naka_rushton::displayed(p, r, 130), expected));
    }
    ledger("tone.naka_rushton", "display mapping", "double against oracle max rel", worst);
    EXPECT_LT(worst, 2e-5);
}

TEST(NakaRushton, AdaptedLightAnswersWithThePlateauAndSigmaWithAHalf) {
    for (double a : {1e-6, 1e-2, 1.0, 1e4, 1e8}) {
        const double s = naka_rushton::log2_half_saturation(defaults, a);
        EXPECT_LT(relative_error(naka_rushton::response(defaults, a, s), naka_rushton::plateau(defaults, a)), 1e-6) << a;
        EXPECT_NEAR(naka_rushton::response(defaults, std::exp2(s), s), 0.5, 1e-9) << a;
    }
}

TEST(NakaRushton, GpuIsTheReference) { laws.gpu_is_the_reference(2e-2); }
TEST(NakaRushton, BrighterIsNeverDarker) { laws.brighter_is_never_darker(); }
TEST(NakaRushton, NeutralStaysNeutral) { laws.neutral_stays_neutral(); }
TEST(NakaRushton, StaysOnTheDisplay) { laws.stays_on_the_display(); }
TEST(NakaRushton, ThePlanIsWhatIsShown) { laws.the_plan_is_what_is_shown(); }

}  // namespace
}  // namespace entoptic::perception
