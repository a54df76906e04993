// labels: gpu
#include "perception/adaptation/krawczyk_exp_log_math.glsl"
#include "perception/adaptation/adaptation_laws.h"

#include <cstring>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const AdaptationLaws laws{"krawczyk_exp_log", {}};

TEST(AdaptationExpLog, KeepsTheLawsOfTheSlot) {
    laws.constant_light_is_adapted_to();
    laws.time_that_does_not_pass_moves_nothing();
    laws.blink_holds_the_state();
    laws.picture_is_not_touched();
    laws.target_is_that_of_the_pixels();
    laws.hard_cases_stay_finite();
}

TEST(AdaptationExpLog, DoesNotDependOnTheFrameRate) { laws.frame_rate_does_not_matter(); }

TEST(AdaptationExpLog, GpuIsTheReference) { laws.gpu_is_the_reference_over_times(); }

KrawczykExpLogParams defaults() {
    KrawczykExpLogParams p;
    std::memcpy(&p, laws.parameters().data(), sizeof p);
    return p;
}

// The linear filter takes 3.9 s from 100 to within a tenth of 0.01 cd/m², and 0.23 s the other way: people found the former slow. On the
// logarithm |ln(A/Y)| falls as exp(-t/τ), so that ln(1.1) is reached after τ ln(ln(1e4)/ln(1.1)) in either direction.
TEST(AdaptationExpLog, DarkIsReachedSoonerThanByTheLinearFilter) {
    for (const auto& [from, to] : {std::pair{100.0, 0.01}, std::pair{0.01, 100.0}}) {
        const double tau = krawczyk_exp_log::time_constant(defaults(), to);
        const double share = from > to ? std::log(1.1) : -std::log(0.9);
        const double t = tau * std::log(std::log(1e4) / share);
        EXPECT_LT(relative_error(krawczyk_exp_log::adapted(defaults(), from, to, t), to * (from > to ? 1.1 : 0.9)), 1e-9);
        EXPECT_NEAR(t, from > to ? 1.555 : 0.447, 0.002);
    }
}

TEST(AdaptationExpLog, TwoHalfStepsAreOneStep) {
    for (double before : {1e-6, 0.1, 1e8})
        for (double target : {1e-6, 1.0, 1e8})
            for (double dt : {1e-4, 0.01, 0.5, 10.0}) {
                const double half = krawczyk_exp_log::adapted(defaults(), before, target, dt / 2);
                EXPECT_LT(relative_error(krawczyk_exp_log::adapted(defaults(), half, target, dt / 2),
                                         krawczyk_exp_log::adapted(defaults(), before, target, dt)), 1e-7);
            }
}

// With the straylight of the field counted, a lamp beside the gaze raises adaptation by its veil: L = E (10/θ³ + 5.27/θ²).
TEST(AdaptationExpLog, LampBesideTheGazeVeilsTheFovea) {
    const EyeGeometry g = rectilinear(720, 400, 45);
    ImageF picture = uniform(720, 400, 1e-6f);
    const glm::dvec2 at = geometry::geometry_pixel(g, glm::normalize(glm::dvec3(std::tan(glm::radians(15.0)), 0, -1)));
    double lux = 0;
    for (int y = 196; y < 204; ++y)
        for (int x = static_cast<int>(at.x) - 4; x < static_cast<int>(at.x) + 4; ++x) {
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 1e4f;
            lux += 1e4 * geometry::geometry_solid_angle(g, {x + 0.5, y + 0.5});
        }
    StageRunner runner({g}, only({"adaptation=krawczyk_exp_log"}, {"adaptation.clip_over_median=1e8"}));
    const double expected = lux * (10 / std::pow(15, 3) + 5 * 1.05308 / std::pow(15, 2));
    EXPECT_LT(relative_error(static_cast<double>(AdaptationLaws::seen(runner, picture, still_input(1)).target_cd_m2), expected), 0.05);
}

}  // namespace
}  // namespace entoptic::perception
