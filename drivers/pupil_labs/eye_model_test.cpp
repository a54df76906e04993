// labels: unit
// The way from ellipses to gaze and millimetres: published vectors, laws, and eyes whose pictures were traced ray by ray.
#include "drivers/pupil_labs/eye_model.h"
#include "drivers/pupil_labs/pupil_detector.h"
#include "drivers/pupil_labs/testing/traced_eye.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <gtest/gtest.h>

namespace entoptic::drivers {
namespace {

using testing::traced;
using testing::TracedEye;

void ledger(const char* setting, const char* metric, double value) {
    std::printf("LEDGER,pupil_labs.eye_model,%s,%s,%.3g\n", setting, metric, value);
}

double degrees_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI; }

// facts/devices.md 4.5: a circle, its ellipse and the ellipse's other circle.
const PinholeCamera camera_283{283, 96, 96};
Circle3 known_circle() { return {{3, -2, 40}, Eigen::Vector3d(-0.2, 0.3, -0.93).normalized(), 2}; }

TEST(EyeGeometry, ACircleIsSeenAsTheKnownEllipse) {
    const auto e = projected(camera_283, known_circle());
    ASSERT_TRUE(e);
    EXPECT_NEAR(e->x, 117.3642, 1e-4);
    EXPECT_NEAR(e->y, 81.6469, 1e-4);
    EXPECT_NEAR(0.5 * e->major, 14.1671, 1e-4);
    EXPECT_NEAR(0.5 * e->minor, 13.6090, 1e-4);
    EXPECT_NEAR(e->angle * 180 / M_PI, 24.6057, 1e-3);
}

TEST(EyeGeometry, AnEllipseIsSeenOfTheKnownTwoCircles) {
    const auto circles = unprojected(camera_283, *projected(camera_283, known_circle()), 2);
    ASSERT_TRUE(circles);
    int first = 0, twin = 0;
    for (const Circle3& circle : *circles) {
        first +=
            degrees_between(circle.normal, known_circle().normal) < 1e-5 && (circle.centre - known_circle().centre).norm() < 1e-6 ? 1 : 0;
        twin += degrees_between(circle.normal, {0.05669, -0.20413, -0.97730}) < 1e-2 &&
                        (circle.centre - Eigen::Vector3d(3.02456, -2.04821, 39.99571)).norm() < 1e-4
                    ? 1
                    : 0;
    }
    EXPECT_EQ(first, 1);
    EXPECT_EQ(twin, 1);
    EXPECT_FALSE(unprojected(camera_283, Ellipse{10, 10, 5, 0, 0}, 2));
    EXPECT_FALSE(projected(camera_283, {{0, 0, 1}, {0, 0, -1}, 2}));
}

TEST(EyeOptics, LightLeavesTheCorneaBySnellsLaw) {
    const EyeDimensions eye;
    const Eigen::Vector3d cornea(1, -2, 33);
    for (const Eigen::Vector3d& inside : {Eigen::Vector3d(1, -2, 28.5), Eigen::Vector3d(3, 0, 28.2), Eigen::Vector3d(-2.5, -4, 29)}) {
        const auto exit = exit_point(eye, cornea, inside);
        ASSERT_TRUE(exit);
        EXPECT_NEAR((*exit - cornea).norm(), eye.cornea_radius_mm, 1e-9);
        // Back in, by the vector form of the law: the ray from the camera must meet the point.
        const Eigen::Vector3d in = testing::refracted(exit->normalized(), (*exit - cornea).normalized(), eye.refractive_index);
        EXPECT_LT((inside - *exit).cross(in).norm(), 1e-6);
    }
    EXPECT_FALSE(exit_point(eye, {0, 0, 5}, {0, 0, 3})) << "the camera is inside the cornea";
    EXPECT_FALSE(exit_point(eye, {0, 0, 33}, {0, 0, 20})) << "the point is outside";
}

TEST(EyeOptics, FromFarInFrontThePupilLooksAsWideAsTheParaxialFormulaSays) {
    const EyeDimensions eye;
    EXPECT_NEAR(eye.entrance_magnification(), 1.11, 0.01);  // facts/devices.md 4.5: 10 to 14 %; textbooks: 1.13 with an index of 1.3375
    std::array<Eigen::Vector2d, 16> points;
    const PinholeCamera far{1e6, 0, 0};
    ASSERT_TRUE(pupil_outline(far, eye, {{0, 0, 1e5}, {0, 0, -1}, 0.5}, points));
    const double image_mm = points[0].norm() * 1e5 / 1e6;
    EXPECT_NEAR(image_mm / 0.5, eye.entrance_magnification(), 0.002);
}

TEST(EyeOptics, OutlineAndTracedPictureAgree) {
    TracedEye eye;
    eye.camera = camera_283;
    eye.pose = {{1, -2, 38}, Eigen::Vector3d(0.3, 0.2, -0.9).normalized(), 2};
    eye.noise = 0;
    eye.samples = 5;
    std::array<Eigen::Vector2d, 400> points;
    ASSERT_TRUE(pupil_outline(eye.camera, eye.eye, eye.pose, points));
    Eigen::Vector2d mean(0, 0);
    double area = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector2d &a = points[i], &b = points[(i + 1) % points.size()];
        const double cross = a.x() * b.y() - a.y() * b.x();
        area += 0.5 * cross;
        mean += cross * (a + b) / 6;
    }
    mean /= area;
    const Image8 image = traced(eye);
    double dark = 0;
    Eigen::Vector2d dark_mean(0, 0);
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const double share = std::clamp((105.0 - image.at(x, y, 0)) / 50, 0.0, 1.0);
            dark += share;
            dark_mean += share * Eigen::Vector2d(x + 0.5, y + 0.5);
        }
    }
    dark_mean /= dark;
    EXPECT_LT((dark_mean - mean).norm(), 0.05) << "px";
    EXPECT_NEAR(dark / std::abs(area), 1, 0.01);
}

// An eye that looks around, its pupil breathing; what the model makes of its pictures.
struct Outcome {
    std::vector<double> gaze_deg, pupil_mm;
    double centre_mm = 0;
    int lost = 0;
};

double percentile(std::vector<double> values, double share) {
    if (values.empty()) return 1e9;
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
}

constexpr int pictures = 40;

EyePose pose_at(const Eigen::Vector3d& centre, int i) {
    const double right = 0.30 * std::sin(0.37 * i) + 0.05, down = 0.22 * std::cos(0.23 * i) - 0.08;
    return {centre, Eigen::Vector3d(std::sin(right) * std::cos(down), std::sin(down), -std::cos(right) * std::cos(down)),
            1.8 + 0.9 * std::sin(0.11 * i)};
}

// `truth`: dimensions of the eye in the pictures; the model always takes the standard ones.
Outcome run(double focal_px, const Eigen::Vector3d& centre, const EyeDimensions& truth, const EyeDimensions& assumed, int teaching) {
    EyeModelParameters parameters;
    parameters.camera = {focal_px, 96, 96};
    parameters.eye = assumed;
    EyeModel model(parameters);
    PupilDetector detector;
    Outcome result;
    TracedEye eye;
    eye.camera = parameters.camera;
    eye.eye = truth;
    std::vector<PupilDetection> seen;
    for (int i = 0; i < pictures; ++i) {
        eye.pose = pose_at(centre, i);
        eye.seed = static_cast<std::uint64_t>(i);
        seen.push_back(detector.detect(view_of(traced(eye))));
    }
    for (int i = 0; i < teaching; ++i)
        model.observe(seen[static_cast<std::size_t>(i % pictures)].ellipse, seen[static_cast<std::size_t>(i % pictures)].confidence);
    result.centre_mm = (model.rotation_centre() - centre).norm();
    for (int i = 0; i < pictures; ++i) {
        const EyePose pose = pose_at(centre, i);
        const auto estimate = model.estimate(seen[static_cast<std::size_t>(i)].ellipse);
        if (!estimate) {
            ++result.lost;
            continue;
        }
        result.gaze_deg.push_back(degrees_between(estimate->optical_axis, pose.optical_axis));
        result.pupil_mm.push_back(std::abs(estimate->pupil_diameter_mm - 2 * pose.pupil_radius_mm * truth.entrance_magnification()));
    }
    return result;
}

TEST(EyeModel, TracedEyesOfBothCameras) {
    for (const auto& [focal, name] : {std::pair{283.3, "Cam2 192x192, eye at 38 mm"}, {140.0, "Cam3 192x192, eye at 30 mm"}}) {
        const Eigen::Vector3d centre = focal > 200 ? Eigen::Vector3d(1, -2, 38) : Eigen::Vector3d(-2, 3, 30);
        const Outcome result = run(focal, centre, {}, {}, 600);
        EXPECT_LE(result.lost, 1) << name;
        EXPECT_LT(percentile(result.gaze_deg, 0.5), 1) << name;
        EXPECT_LT(percentile(result.gaze_deg, 0.95), 2.5) << name;
        EXPECT_LT(percentile(result.pupil_mm, 0.95), 0.25) << name;
        std::printf("%s: gaze median %.2f, 95 %% %.2f degrees; pupil median %.3f, 95 %% %.3f mm; centre %.2f mm off; %d lost\n", name,
                    percentile(result.gaze_deg, 0.5), percentile(result.gaze_deg, 0.95), percentile(result.pupil_mm, 0.5),
                    percentile(result.pupil_mm, 0.95), result.centre_mm, result.lost);
        ledger(name, "gaze median deg", percentile(result.gaze_deg, 0.5));
        ledger(name, "gaze p95 deg", percentile(result.gaze_deg, 0.95));
        ledger(name, "pupil diameter p95 mm", percentile(result.pupil_mm, 0.95));
    }
}

// People differ: a flatter cornea and a shorter eye than the model takes. What that costs is part of the accuracy to expect.
TEST(EyeModel, AnEyeOfOtherDimensions) {
    EyeDimensions other;
    other.cornea_radius_mm = 8.2;
    other.pupil_distance_mm = 10.0;
    other.cornea_distance_mm = 5.1;
    const Outcome result = run(283.3, {1, -2, 38}, other, {}, 600);
    EXPECT_LE(result.lost, 1);
    EXPECT_LT(percentile(result.gaze_deg, 0.95), 3);
    EXPECT_LT(percentile(result.pupil_mm, 0.95), 0.5);
    ledger("an eye of other dimensions", "gaze p95 deg", percentile(result.gaze_deg, 0.95));
    ledger("an eye of other dimensions", "pupil diameter p95 mm", percentile(result.pupil_mm, 0.95));
}

// What refraction is worth: a model without it sees the same eye farther away and its pupil wider.
TEST(EyeModel, WithoutRefractionItIsWrong) {
    EyeDimensions straight;
    straight.refractive_index = 1.0000001;
    const Eigen::Vector3d centre(1, -2, 38);
    const Outcome with = run(283.3, centre, {}, {}, 600), without = run(283.3, centre, {}, straight, 600);
    EXPECT_GT(without.centre_mm, 2 * with.centre_mm);
}

TEST(EyeModel, SaysNothingUntilItHasSeenEnough) {
    EyeModelParameters parameters;
    parameters.camera = camera_283;
    EyeModel model(parameters);
    const Ellipse still{100, 90, 28, 26, 0.4};
    for (int i = 0; i < 2000; ++i) model.observe(still, 1);
    EXPECT_FALSE(model.fitted()) << "one direction tells nothing of distance";
    EXPECT_FALSE(model.estimate(still));
    for (int i = 0; i < 2000; ++i) model.observe({20.0 + 7 * (i % 20), 40.0 + 5 * (i % 17), 28, 26, 0.4}, 0.3);
    EXPECT_FALSE(model.fitted()) << "unsure ellipses shape nothing";
}

TEST(EyeModel, NonsenseNeitherCrashesNorConvinces) {
    EyeModelParameters parameters;
    parameters.camera = camera_283;
    EyeModel model(parameters);
    std::uint64_t state = 7;
    const auto draw = [&state](double scale) { return scale * testing::normal_draw(state); };
    for (int i = 0; i < 1500; ++i) {
        model.observe(ellipse_of(96 + draw(60), 96 + draw(60), 2 + std::abs(draw(30)), 1 + std::abs(draw(20)), draw(2)), 1);
        const auto estimate = model.estimate(ellipse_of(96 + draw(60), 96 + draw(60), 10, 8, draw(2)));
        if (estimate) {
            EXPECT_TRUE(estimate->optical_axis.allFinite());
            EXPECT_GT(estimate->pupil_diameter_mm, 0.5) << "no zero pupil, ever";
            EXPECT_LT(estimate->pupil_diameter_mm, 15);
        }
    }
    const Ellipse nan{std::nan(""), 1, 2, 1, 0};
    model.observe(nan, 1);
    EXPECT_FALSE(model.estimate(nan));
}

TEST(EyeModel, TimeOfOneEstimate) {
    EyeModelParameters parameters;
    parameters.camera = camera_283;
    EyeModel model(parameters);
    std::vector<Ellipse> ellipses;
    for (int i = 0; i < 60; ++i) {
        const EyePose pose = pose_at({1, -2, 38}, i);
        const auto e =
            projected(parameters.camera, {pose.rotation_centre + 10.9 * pose.optical_axis, pose.optical_axis, 1.12 * pose.pupil_radius_mm});
        ellipses.push_back(*e);
    }
    double longest_ms = 0;
    for (int i = 0; i < 600; ++i) {
        const auto start = std::chrono::steady_clock::now();
        model.observe(ellipses[static_cast<std::size_t>(i % 60)], 1);
        longest_ms = std::max(longest_ms, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    ASSERT_TRUE(model.fitted());
    double best_us = 1e9;  // the best of many: other programs do not count
    for (int i = 0; i < 300; ++i) {
        const auto start = std::chrono::steady_clock::now();
        (void)model.estimate(ellipses[static_cast<std::size_t>(i % 60)]);
        best_us = std::min(best_us, std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    }
    std::printf("estimate %.0f us, longest observe %.2f ms\n", best_us, longest_ms);
    EXPECT_LT(best_us, 2000);  // a frame at 200 Hz has 5000
}

}  // namespace
}  // namespace entoptic::drivers
