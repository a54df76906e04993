// labels: gpu frame
// The demo's level of detail by gaze, judged by its own output: how many triangles it saves, and whether an eye that looks where the gaze is
// could tell its pictures from those in full detail. "After the eye's own acuity": both are blurred by the Gaussian that passes 5.8 % of the finest
// grating that the eye resolves at each pixel's eccentricity (Larson, Rushmeier and Piatko 1997; Strasburger, Rentschler and Jüttner 2011).
#include "base/colour_difference.h"
#include "base/image_io.h"
#include "base/testing/ledger.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <unistd.h>
#include <vector>

namespace entoptic {
namespace {

namespace fs = std::filesystem;
using testing::ledger;

constexpr double degree = std::numbers::pi / 180;
constexpr int width = 900, height = 675;
constexpr double fov_deg = 60, gaze_x_deg = -22, gaze_y_deg = 5;
constexpr double cutoff_per_deg = 47.8, half_at_deg = 3.3;  // at the gaze; twice as coarse there

struct Drawn {
    ImageF gaze, whole;
    double triangles = 0, whole_triangles = 0;
};

ImageF picture(const fs::path& path) {
    auto image = read_exr(path.string());
    EXPECT_TRUE(image) << path;
    return image ? std::move(image->rgb) : ImageF(width, height, 3);
}

// One run of the demo draws and writes both.
Drawn draw() {
    const fs::path folder = fs::temp_directory_path() / ("demo_detail_" + std::to_string(getpid()));
    const std::string command =
        std::string(ENTOPTIC_BINARY_DIR) + "/bin/entoptic-demo --offscreen " + folder.string() + " --size " + std::to_string(width) + "x" +
        std::to_string(height) +
        " --fov 60 --light day --yaw 40 --pitch -10 --lamp off --plants 1 --samples 4 --detail gaze --measure --gaze=-22,5 2>&1";
    Drawn drawn;
    FILE* output = popen(command.c_str(), "r");
    std::string text;
    std::array<char, 512> part{};
    while (output != nullptr && std::fgets(part.data(), part.size(), output) != nullptr) text += part.data();
    EXPECT_EQ(output != nullptr ? pclose(output) : -1, 0) << text;
    const std::size_t drawn_at = text.find("drawn, a picture of an eye: "), whole_at = text.find("(in full detail ");
    EXPECT_TRUE(drawn_at != std::string::npos && whole_at != std::string::npos) << text;
    if (drawn_at != std::string::npos) drawn.triangles = std::atof(text.c_str() + drawn_at + 28);
    if (whole_at != std::string::npos) drawn.whole_triangles = std::atof(text.c_str() + whole_at + 16);
    drawn.gaze = picture(folder / "left.exr");
    drawn.whole = picture(folder / "whole" / "left.exr");
    fs::remove_all(folder);
    return drawn;
}

// Angles from the gaze, degrees, and of a pixel along one side, degrees, about (x, y).
struct Place {
    double eccentricity_deg, pixel_deg;
};
Place place_of(int x, int y) {
    const double focal = 0.5 * width / std::tan(0.5 * fov_deg * degree);
    const double right = (x + 0.5 - 0.5 * width) / focal, up = -(y + 0.5 - 0.5 * height) / focal,
                 length = std::sqrt(right * right + up * up + 1);
    const double gx = gaze_x_deg * degree, gy = gaze_y_deg * degree;
    const double cosine = (right * std::sin(gx) * std::cos(gy) + up * std::sin(gy) + std::cos(gx) * std::cos(gy)) / length;
    return {std::acos(std::min(cosine, 1.0)) / degree, 1 / (focal * std::pow(length, 1.5)) / degree};  // geometric mean of both directions
}

std::array<double, 3> colour(const ImageF& image, int x, int y) {
    return {static_cast<double>(image.at(x, y, 0)), static_cast<double>(image.at(x, y, 1)), static_cast<double>(image.at(x, y, 2))};
}

// What an eye has of a picture at a pixel.
std::array<double, 3> seen(const ImageF& image, int x, int y, double sigma_px) {
    if (sigma_px < 0.2) return colour(image, x, y);
    const int reach = static_cast<int>(std::ceil(3 * sigma_px));
    std::array<double, 3> sum{};
    double weights = 0;
    for (int j = std::max(y - reach, 0); j <= std::min(y + reach, height - 1); ++j)
        for (int i = std::max(x - reach, 0); i <= std::min(x + reach, width - 1); ++i) {
            const double w = std::exp(-0.5 * ((i - x) * (i - x) + (j - y) * (j - y)) / (sigma_px * sigma_px));
            for (std::size_t c = 0; c < 3; ++c) sum[c] += w * static_cast<double>(image.at(i, j, static_cast<int>(c)));
            weights += w;
        }
    for (double& v : sum) v /= weights;
    return sum;
}

// 1 where any pixel within `reach` differs.
std::vector<char> near_differences(const Drawn& d, int reach) {
    const auto spread = [&](const std::vector<char>& from, bool rows) {
        std::vector<char> to(from.size());
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (int k = -reach; k <= reach && to[static_cast<std::size_t>(y * width + x)] == 0; ++k) {
                    const int i = rows ? std::clamp(x + k, 0, width - 1) : x, j = rows ? y : std::clamp(y + k, 0, height - 1);
                    to[static_cast<std::size_t>(y * width + x)] = from[static_cast<std::size_t>(j * width + i)];
                }
        return to;
    };
    std::vector<char> differs(static_cast<std::size_t>(width * height));
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) differs[static_cast<std::size_t>(y * width + x)] = colour(d.gaze, x, y) != colour(d.whole, x, y);
    return spread(spread(differs, true), false);
}

TEST(DemoDetail, SavesTrianglesThatAnEyeDoesNotMiss) {
    const Drawn d = draw();
    ASSERT_EQ(d.gaze.width, width);
    ASSERT_EQ(d.whole.height, height);
    ledger("demo.detail", "gaze, a plant", "triangles over full detail", d.triangles / d.whole_triangles);
    EXPECT_GT(d.whole_triangles, 150000);
    EXPECT_LT(d.triangles, 0.35 * d.whole_triangles);

    const std::vector<char> near = near_differences(d, 12);
    std::vector<double> errors, beside;  // of all pixels beyond 5 degrees, and of those within reach of one that differs
    double sum = 0;
    int in_fovea = 0, of_fovea = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const Place at = place_of(x, y);
            const bool fovea = at.eccentricity_deg < 5;
            of_fovea += fovea ? 1 : 0;
            in_fovea += fovea && colour(d.gaze, x, y) != colour(d.whole, x, y) ? 1 : 0;
            if (fovea) continue;
            double error = 0;
            if (near[static_cast<std::size_t>(y * width + x)] != 0) {
                const double cutoff = cutoff_per_deg / (1 + at.eccentricity_deg / half_at_deg),
                             sigma_px = 1 / (1.86 * std::numbers::sqrt2 * cutoff) / at.pixel_deg;
                error = delta_e_itp(seen(d.gaze, x, y, sigma_px), seen(d.whole, x, y, sigma_px));
                beside.push_back(error);
            }
            errors.push_back(error);
            sum += error;
        }
    EXPECT_GT(of_fovea, 10000);
    EXPECT_EQ(in_fovea, 0);
    ASSERT_GT(beside.size(), 2000u);  // else nothing was simplified in view
    const auto percentile = [](std::vector<double>& values, double share) {
        const auto it = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
        std::nth_element(values.begin(), it, values.end());
        return *it;
    };
    const double p99 = percentile(errors, 0.99), p99_beside = percentile(beside, 0.99), mean = sum / static_cast<double>(errors.size());
    ledger("demo.detail", "gaze, a plant", "dE_ITP beyond 5 degrees p99", p99);
    ledger("demo.detail", "gaze, a plant", "dE_ITP p99 within 12 pixels of any that differ", p99_beside);
    ledger("demo.detail", "gaze, a plant", "dE_ITP beyond 5 degrees mean", mean);
    // Over the picture, far below what an approximation may have (p99 1, mean 0.2); beside the edges that move, a bound on how much of them is left.
    EXPECT_LT(p99_beside, 10);
    EXPECT_LT(p99, 0.2);
    EXPECT_LT(mean, 0.05);
}

}  // namespace
}  // namespace entoptic
