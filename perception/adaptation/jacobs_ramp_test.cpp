// labels: gpu
#include "perception/adaptation/jacobs_ramp_math.glsl"
#include "perception/adaptation/adaptation_laws.h"

#include <cstring>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const AdaptationLaws laws{"jacobs_ramp", {}};

TEST(AdaptationRamp, KeepsTheLawsOfTheSlot) {
    laws.constant_light_is_adapted_to();
    laws.time_that_does_not_pass_moves_nothing();
    laws.blink_holds_the_state();
    laws.picture_is_not_touched();
    laws.target_is_that_of_the_pixels();
    laws.hard_cases_stay_finite();
}

TEST(AdaptationRamp, DoesNotDependOnTheFrameRate) { laws.frame_rate_does_not_matter(2e-4); }

TEST(AdaptationRamp, GpuIsTheReference) { laws.gpu_is_the_reference_over_times(); }

TEST(AdaptationRamp, IsThatOfTheTable) {
    JacobsRampParams p;
    std::memcpy(&p, laws.parameters().data(), sizeof p);
    double worst = 0;
    for (const OracleRow& row : oracle("jacobs_ramp")) {
        const double a = jacobs_ramp::adapted(p, std::pow(10, row.at("A0_log10")), std::pow(10, row.at("A_target_log10")), row.at("time_s"));
        worst = std::max(worst, std::abs(std::log10(a) - row.at("A_log10")));
    }
    ledger("adaptation.jacobs_ramp", "ramp", "double against oracle max log10", worst);
    EXPECT_LT(worst, 1e-7);     // 0.2f and 0.75f
}

TEST(AdaptationRamp, StopsExactlyAtTheTarget) {
    JacobsRampParams p;
    std::memcpy(&p, laws.parameters().data(), sizeof p);
    EXPECT_EQ(jacobs_ramp::adapted(p, 100, 1, 1e6), 1);
    EXPECT_EQ(jacobs_ramp::adapted(p, 1, 100, 1e6), 100);
}

}  // namespace
}  // namespace entoptic::perception
