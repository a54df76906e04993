// labels: gpu
#include "perception/adaptation/pattanaik_slow_math.glsl"
#include "perception/adaptation/adaptation_laws.h"

#include <fstream>
#include <sstream>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const AdaptationLaws laws{"pattanaik_slow", {}};

TEST(AdaptationPigment, KeepsTheLawsOfTheSlot) {
    laws.constant_light_is_adapted_to();
    laws.time_that_does_not_pass_moves_nothing();
    laws.blink_holds_the_state();
    laws.picture_is_not_touched();
    laws.target_is_that_of_the_pixels();
    laws.hard_cases_stay_finite();
}

TEST(AdaptationPigment, DoesNotDependOnTheFrameRate) { laws.frame_rate_does_not_matter(); }

TEST(AdaptationPigment, GpuIsTheReference) { laws.gpu_is_the_reference_over_times(2e-3); }   // at 1e-6 cd/m² 2.5e-5 of the rods' pigment is bleached: 1 - u in fp32

TEST(AdaptationPigment, KineticsAreThoseOfTheTable) {
    using namespace pattanaik_slow;
    std::ifstream file(std::string(ENTOPTIC_SOURCE_DIR) + "/tests/oracles/pigment_slow.csv");
    std::string line;
    std::getline(file, line);
    double worst = 0;
    int rows = 0;
    for (; std::getline(file, line); ++rows) {
        const Pigment pigment = line.substr(0, 3) == "rod" ? rod_pigment() : cone_pigment();
        std::vector<double> v;
        std::stringstream stream(line.substr(line.find(',') + 1));
        for (std::string cell; std::getline(stream, cell, ',');) v.push_back(std::stod(cell));
        const double settled = settled_unbleached(pigment, v[0]);
        worst = std::max(worst, relative_error(settled, v[1]));
        const double times[] = {1, 10, 60, 600};
        for (std::size_t i = 0; i < 4; ++i) worst = std::max(worst, relative_error(pigment_after(pigment, 1, settled, v[0], times[i]), v[3 + i]));
    }
    ledger("adaptation.pattanaik_slow", "pigment", "double against oracle max rel", worst);
    EXPECT_GT(rows, 10);
    EXPECT_LT(worst, 2e-8);
}

TEST(AdaptationPigment, BackgroundOfSettledPigmentIsTheLight) {
    using namespace pattanaik_slow;
    for (double y : {1e-6, 1e-3, 1.0, 1e4, 1e8}) {
        EXPECT_LT(relative_error(rod_background(settled_unbleached(rod_pigment(), y)), y), y > 1e-3 ? 1e-9 : 1e-5) << y;
        EXPECT_LT(relative_error(cone_background(settled_bleached(cone_pigment(), y)), y), 1e-7) << y;
    }
}

// After a long stay in 1e4 cd/m² rods have no pigment: 0.04 / (t/400) cd/m² of equivalent background, falling over minutes.
TEST(AdaptationPigment, DarkAdaptationTakesMinutes) {
    const double at_10_s = laws.after(1e4, 1e-6f, 10, 90), at_60_s = laws.after(1e4, 1e-6f, 60, 90), at_30_min = laws.after(1e4, 1e-6f, 1800, 90);
    EXPECT_NEAR(at_10_s / (0.04 * 400 / 10), 1, 0.03);
    EXPECT_NEAR(at_60_s / (0.04 * 400 / 60), 1, 0.1);
    EXPECT_LT(at_30_min, 1e-3);
    EXPECT_GT(at_30_min, 1e-4);
}

TEST(AdaptationPigment, TimeLapseHurriesThePigmentOnly) {
    const AdaptationLaws lapse{"pattanaik_slow", {"adaptation.time_lapse=60"}};
    EXPECT_LT(relative_error(lapse.after(1e4, 1e-6f, 10, 50), laws.after(1e4, 1e-6f, 600, 50)), 0.01);
}

TEST(AdaptationPigment, BrighterLightIsFollowedAtNeuralSpeed) {
    EXPECT_LT(relative_error(laws.after(0.01, 1000, 1, 90), 1000), 1e-3);
}

}  // namespace
}  // namespace entoptic::perception
