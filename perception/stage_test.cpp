// labels: gpu
// The stage without any model, and its statistics: what every model builds on.
#include "perception/testing/harness.h"

#include <cmath>
#include <limits>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);

ImageF gradient(int width, int height) {
    ImageF image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = 0.001f + static_cast<float>(x + y * width + c);
    return image;
}

TEST(Stage, WithoutModelsPassesThePictureToTheBit) {
    const ImageF picture = gradient(101, 27);
    StageRunner runner({rectilinear(101, 27, 60)}, only({}));
    EXPECT_EQ(runner.run(picture, still_input(1)).data, picture.data);
}

TEST(Stage, CleansWhatAnApplicationMustNotSend) {
    ImageF picture(40, 9, 3, 1.0f);
    picture.at(3, 2, 0) = std::numeric_limits<float>::quiet_NaN();
    picture.at(4, 2, 1) = std::numeric_limits<float>::infinity();
    picture.at(5, 2, 2) = -1;
    picture.at(6, 2, 0) = 2e8f;
    StageRunner runner({rectilinear(40, 9, 60)}, only({}));
    const ImageF out = runner.run(picture, still_input(1));
    EXPECT_EQ(out.at(3, 2, 0), 0.0f);
    EXPECT_EQ(out.at(3, 2, 1), 1.0f);
    EXPECT_EQ(out.at(4, 2, 1), max_scene_cd_m2);
    EXPECT_EQ(out.at(5, 2, 2), 0.0f);
    EXPECT_EQ(out.at(6, 2, 0), max_scene_cd_m2);
    EXPECT_EQ(runner.stage().view(0).cleaned, 4u);
}

TEST(Stage, StatisticsAreThoseOfThePicture) {
    const int width = 333, height = 77;
    ImageF picture(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = std::pow(10.0f, -4.0f + 8.0f * static_cast<float>(x) / width);
    const EyeGeometry g = rectilinear(width, height, 104);
    StageRunner runner({g}, only({}));
    runner.run(picture, still_input(1));
    // Solid angle of a flat pixel: da db / (1 + a² + b²)^1.5 with a, b the tangents.
    double sum = 0, sr = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double a = (2.0 * (x + 0.5) / width - 1) * static_cast<double>(g.tan_right), b = (1 - 2.0 * (y + 0.5) / height) * static_cast<double>(g.tan_up);
            const double w = 1 / std::pow(1 + a * a + b * b, 1.5);
            sum += w * static_cast<double>(picture.at(x, y, 0));
            sr += w;
        }
    const ViewOutcome view = runner.stage().view(0);
    EXPECT_NEAR(view.mean_y / (sum / sr), 1, 2e-4);
    EXPECT_NEAR(view.min_y / 1e-4, 1, 1e-5);
    EXPECT_NEAR(view.max_y / static_cast<double>(picture.at(width - 1, 0, 0)), 1, 1e-5);
}

TEST(Stage, TwoRunsGiveTheSameBits) {
    const ImageF picture = gradient(257, 65);
    StageRunner a({rectilinear(257, 65, 90)}, only({})), b({rectilinear(257, 65, 90)}, only({}));
    a.run(picture, still_input(1));
    b.run(picture, still_input(1));
    EXPECT_EQ(a.stage().view(0).mean_y, b.stage().view(0).mean_y);
}

}  // namespace
}  // namespace entoptic::perception
