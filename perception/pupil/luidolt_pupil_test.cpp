#include "perception/pupil/luidolt_pupil_math.glsl"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"

#include <limits>

namespace entoptic::perception {
namespace {

using namespace testing;
constexpr LuidoltPupilParams defaults{2.5f, 6, 2, 8};

TEST(LuidoltPupil, WhiteFrameIsTheLeastBlackFrameTheMost) {
    EXPECT_EQ(luidolt_pupil::simulated_mm(defaults, 2.5), 2);
    EXPECT_EQ(luidolt_pupil::simulated_mm(defaults, 6), 8);
    EXPECT_NEAR(luidolt_pupil::simulated_mm(defaults, 4.25), 5, 1e-12);
    EXPECT_EQ(luidolt_pupil::simulated_mm(defaults, 1.5), 2);
    EXPECT_EQ(luidolt_pupil::simulated_mm(defaults, 9), 8);
}

TEST(LuidoltPupil, IsTheReference) {
    const ModelEntry& entry = *find_model("pupil", "luidolt_pupil");
    const auto reference = entry.create_reference();
    for (float white : {2.0f, 3.1f, 4.0f})
        for (float black : {3.0f, 4.02f, 8.0f})
            for (float d = 1.5f; d <= 9; d += 0.25f) {
                const std::vector<float> values{white, black, 2, 8};
                ReferenceFrame frame{{}, rectilinear(1, 1, 60), {}, {}, 0, true, 1, 1};
                frame.eye.pupil_diameter_mm = d;
                reference->apply(frame, values);
                EXPECT_NEAR(luidolt_pupil::simulated_mm({white, black, 2, 8}, static_cast<double>(d)), static_cast<double>(frame.eye.pupil_diameter_mm), 1e-5);
            }
}

TEST(LuidoltPupil, ARangeThatIsNoneDoesNotDivideByZero) {
    EXPECT_EQ(luidolt_pupil::simulated_mm({4, 4, 2, 8}, 4), 5);
}

}  // namespace
}  // namespace entoptic::perception
