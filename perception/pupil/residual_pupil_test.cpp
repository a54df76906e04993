// labels: gpu
#include "perception/pupil/residual_pupil_math.glsl"
#include "perception/pupil/watson_yellott.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"

#include <limits>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
constexpr ResidualPupilParams defaults{30, 2, 8, 6, 2};

std::unique_ptr<Model> make(std::size_t views = 1) {
    const ModelEntry& entry = *find_model("pupil", "residual_pupil");
    auto model = value(entry.create({device(), std::vector<EyeGeometry>(views, rectilinear(8, 8, 60)), {}, 1}));
    model->set_parameters(default_parameters(entry));
    return model;
}
double simulated(Model& model, double measured, const SceneFeedback& feedback, double dt_s, bool snap) {
    FrameInput input = still_input(1, dt_s, snap);
    input.eyes[0].pupil_diameter_mm = static_cast<float>(measured);
    dynamic_cast<AdjustsEyes&>(model).adjust(input, std::span(&feedback, 1));
    return static_cast<double>(input.eyes[0].pupil_diameter_mm);
}

// Where the panel shows the scene's light, the simulated eye has the wearer's pupil, to the bit.
TEST(ResidualPupil, EqualLightChangesNothing) {
    auto model = make();
    for (double y : {1e-6, 0.04, 20.0, 130.0})
        for (double d : {1.5, 3.217, 9.0}) EXPECT_EQ(static_cast<float>(simulated(*model, d, {y, y, 8495}, 0.01, true)), static_cast<float>(d));
}

// Watson and Yellott's own pupil for the panel becomes their pupil for the scene.
TEST(ResidualPupil, PupilOfThePanelBecomesThatOfTheScene) {
    auto model = make();
    for (const auto& [scene, panel] : {std::pair{1e-3, 0.6}, std::pair{1e4, 50.0}}) {
        const double at_panel = pupil_diameter_mm(panel, 30, 8495, 2), in_scene = pupil_diameter_mm(scene, 30, 8495, 2);
        EXPECT_NEAR(simulated(*model, at_panel, {scene, panel, 8495}, 0.01, true), std::clamp(in_scene, 2.0, 8.0), 1e-5);
    }
}

TEST(ResidualPupil, ConstrictsFasterThanItDilates) {
    auto model = make();
    simulated(*model, 4, {1, 1, 8495}, 0.01, true);
    EXPECT_NEAR(simulated(*model, 4, {1e-6, 1, 8495}, 0.1, false), 4.2, 1e-5);
    simulated(*model, 4, {1, 1, 8495}, 0.01, true);
    EXPECT_NEAR(simulated(*model, 4, {1e4, 1, 8495}, 0.1, false), 3.4, 1e-5);
}

TEST(ResidualPupil, HardCasesStayAPupil) {
    auto model = make();
    const double inf = std::numeric_limits<double>::infinity();
    for (double scene : {0.0, 1e-6, 1e8, inf})
        for (double panel : {0.0, 130.0})
            for (double area : {0.0, 8495.0})
                for (double dt : {0.0, -1.0, 1e9})
                    for (bool snap : {true, false}) {
                        const double d = simulated(*model, 4, {scene, panel, area}, dt, snap);
                        EXPECT_TRUE(d >= 1.5 && d <= 9) << scene << " " << panel << " " << area << " " << dt << ": " << d;
                    }
}

// The stage's own feedback: ordinary light leaves the pupil, a night brightened for the panel opens it.
TEST(ResidualPupil, StageKnowsWhatThePanelShowed) {
    struct Probe {
        float light;
        bool opens;
    };
    for (const Probe probe : {Probe{20, false}, Probe{1e-3f, true}}) {
        StageRunner runner({rectilinear(64, 64, 60)}, only({"pupil=residual_pupil", "adaptation=krawczyk_exp_log", "tone=display_identity", "glare=luidolt_spectral"}));
        for (int i = 0; i < 3; ++i) runner.run(uniform(64, 64, probe.light), still_input(1, 0.1, i == 0));
        EXPECT_EQ(runner.stage().input().eyes[0].pupil_diameter_mm > 4.01f, probe.opens) << probe.light;
    }
}

}  // namespace
}  // namespace entoptic::perception
