// labels: unit
// Pictures of pupils that are known: where they are found, how surely, and that nothing is found where there is none.
#include "drivers/pupil_labs/pupil_detector.h"
#include "drivers/pupil_labs/testing/drawn_eye.h"

#include <chrono>
#include <cstdio>
#include <gtest/gtest.h>
#include <limits>

namespace entoptic::drivers {
namespace {

using testing::draw;
using testing::DrawnEye;

void ledger(const char* setting, const char* metric, double value) {
    std::printf("LEDGER,pupil_labs.detector,%s,%s,%.3g\n", setting, metric, value);
}

double turned_by(double a, double b) {
    const double d = std::fmod(std::abs(a - b), M_PI);
    return std::min(d, M_PI - d);
}

struct Errors {
    double centre = 0, axes = 0, least_confidence = 1, angle_deg = 0;
    int missed = 0, all = 0;
};

void compare(const Ellipse& truth, const PupilDetection& got, Errors& worst) {
    ++worst.all;
    if (!got.found || std::hypot(got.ellipse.x - truth.x, got.ellipse.y - truth.y) > 5 || got.ellipse.area() > 2 * truth.area()) {
        ++worst.missed;
        std::printf("missed %.1f %.1f %.1f x %.1f at %.2f; got %.1f %.1f %.1f x %.1f, confidence %.2f\n", truth.x, truth.y, truth.major,
                    truth.minor, truth.angle, got.ellipse.x, got.ellipse.y, got.ellipse.major, got.ellipse.minor, got.confidence);
        return;
    }
    worst.centre = std::max(worst.centre, std::hypot(got.ellipse.x - truth.x, got.ellipse.y - truth.y));
    worst.axes = std::max({worst.axes, std::abs(got.ellipse.major - truth.major), std::abs(got.ellipse.minor - truth.minor)});
    worst.least_confidence = std::min(worst.least_confidence, got.confidence);
    if (truth.axis_ratio() < 0.85) worst.angle_deg = std::max(worst.angle_deg, turned_by(got.ellipse.angle, truth.angle) * 180 / M_PI);
}

// Pupils of 8 to 60 px, round to 45 degrees oblique and beyond, all over the picture.
TEST(PupilDetector, FindsDrawnPupilsOfEverySizeShapeAndPlace) {
    PupilDetector detector;
    Errors worst;
    for (const double major : {8.0, 12.0, 20.0, 32.0, 46.0, 60.0}) {
        for (const double ratio : {1.0, 0.85, 0.7, 0.55}) {
            for (int place = 0; place < 5; ++place) {
                DrawnEye eye;
                eye.pupil = {60.3 + 17.7 * place, 120.8 - 13.1 * place, major, major * ratio, std::fmod(0.3 + 0.6 * place, M_PI)};
                eye.iris_radius = std::max(28.0, 0.8 * major);
                eye.seed = static_cast<std::uint64_t>(place) + 10 * static_cast<std::uint64_t>(major);
                compare(eye.pupil, detector.detect(view_of(draw(eye))), worst);
            }
        }
    }
    EXPECT_EQ(worst.missed, 0) << "of " << worst.all;
    EXPECT_LT(worst.centre, 0.5);
    EXPECT_LT(worst.axes, 2);
    EXPECT_LT(worst.angle_deg, 8);
    ledger("drawn 192x192 pupils of 8 to 60 px", "centre max px", worst.centre);
    ledger("drawn 192x192 pupils of 8 to 60 px", "axes max px", worst.axes);
}

TEST(PupilDetector, CentresAreWherePixelCentresPlusHalfSay) {
    // A picture turned by 180 degrees has its pupil at (width - x, height - y): only so with pixel centres at +0.5.
    DrawnEye eye;
    eye.pupil = {80.25, 99.6, 30, 24, 0.4};
    eye.noise = 0;
    Image8 image = draw(eye), turned = image;
    std::reverse(turned.data.begin(), turned.data.end());
    PupilDetector detector;
    const Ellipse a = detector.detect(view_of(image)).ellipse, b = detector.detect(view_of(turned)).ellipse;
    EXPECT_NEAR(a.x, eye.pupil.x, 0.15);
    EXPECT_NEAR(a.y, eye.pupil.y, 0.15);
    EXPECT_NEAR(a.x + b.x, 192, 0.1);
    EXPECT_NEAR(a.y + b.y, 192, 0.1);
}

TEST(PupilDetector, ReflectionsLidsAndLashesDoNotMoveIt) {
    PupilDetector detector;
    Errors worst;
    for (int i = 0; i < 24; ++i) {
        DrawnEye eye;
        eye.pupil = {90 + 0.7 * i, 100, 34, 28, 0.1 * i};
        const double turn = 0.26 * i;
        for (int glint = 0; glint < 4; ++glint)  // two on the outline, two inside
            eye.reflections.push_back(Eigen::Vector2d(eye.pupil.x, eye.pupil.y) +
                                      (glint < 2 ? 15.0 : 6.0) *
                                          Eigen::Vector2d(std::cos(turn + 2.3 * glint), std::sin(turn + 2.3 * glint)));
        eye.lid_y = eye.pupil.y - 12;  // hides a tenth of the pupil
        eye.lashes = 24;
        eye.seed = static_cast<std::uint64_t>(i);
        compare(eye.pupil, detector.detect(view_of(draw(eye))), worst);
    }
    EXPECT_EQ(worst.missed, 0);
    EXPECT_LT(worst.centre, 4);  // a tenth of the pupil
    ledger("drawn with lid and lashes and reflections", "centre max px", worst.centre);
}

TEST(PupilDetector, LargePicturesAreMeasuredInTheirOwnPixels) {
    PupilDetector detector;
    Errors worst;
    for (const int side : {400, 640}) {
        for (int i = 0; i < 4; ++i) {
            DrawnEye eye;
            eye.width = eye.height = side;
            eye.pupil = {0.45 * side + 3.3 * i, 0.52 * side, 0.16 * side, 0.13 * side, 0.5 * i};
            eye.iris_radius = 0.2 * side;
            compare(eye.pupil, detector.detect(view_of(draw(eye))), worst);
        }
    }
    EXPECT_EQ(worst.missed, 0);
    EXPECT_LT(worst.centre, 0.3);  // finer than a pixel of the reduced picture
    ledger("drawn 400x400 and 640x640", "centre max px", worst.centre);
}

TEST(PupilDetector, SeesNoPupilWhereThereIsNone) {
    PupilDetector detector;
    DrawnEye closed;
    closed.pupil = {96, 96, 2, 2, 0};
    closed.iris_radius = 0;
    closed.pupil_level = closed.iris_level = closed.white_level;
    closed.lid_y = 100;
    for (const int lashes : {0, 12, 30}) {
        for (const double noise : {0.0, 2.0, 8.0}) {
            closed.lashes = lashes;
            closed.noise = noise;
            EXPECT_LT(detector.detect(view_of(draw(closed))).confidence, 0.5) << lashes << " lashes, noise " << noise;
        }
    }
    Image8 slope(192, 192, 1);
    for (int y = 0; y < 192; ++y)
        for (int x = 0; x < 192; ++x) slope.at(x, y, 0) = static_cast<std::uint8_t>(x / 2 + y / 2);
    EXPECT_LT(detector.detect(view_of(slope)).confidence, 0.5);
    EXPECT_FALSE(detector.detect(view_of(Image8(192, 192, 1, std::uint8_t{0}))).found);
    EXPECT_FALSE(detector.detect(view_of(Image8(192, 192, 1, std::uint8_t{255}))).found);
}

TEST(PupilDetector, ConfidenceFallsAsThePupilIsCovered) {
    PupilDetector detector;
    DrawnEye eye;
    eye.pupil = {96, 96, 36, 34, 0};
    std::vector<double> confidence;
    for (const double lid : {60.0, 92.0, 100.0, 130.0}) {  // open, half covered, more, closed
        eye.lid_y = lid;
        confidence.push_back(detector.detect(view_of(draw(eye))).confidence);
    }
    EXPECT_GT(confidence[0], 0.9);
    EXPECT_LT(confidence[2], confidence[0]);
    EXPECT_LT(confidence[3], 0.5);
}

TEST(PupilDetector, AnyPictureIsBorne) {
    PupilDetector detector;
    EXPECT_FALSE(detector.detect({}).found);
    std::uint64_t state = 88172645463325252ull;
    for (const auto& [width, height] :
         {std::pair{0, 0}, {1, 1}, {31, 200}, {32, 32}, {33, 47}, {32, 4096}, {4096, 33}, {5000, 100}, {241, 239}}) {
        Image8 image(width, height, 1);
        for (auto& v : image.data) v = static_cast<std::uint8_t>(128 + 60 * testing::normal_draw(state));
        const PupilDetection got = detector.detect(view_of(image));
        EXPECT_TRUE(std::isfinite(got.ellipse.x + got.ellipse.y + got.ellipse.major + got.ellipse.minor + got.confidence));
        EXPECT_GE(got.confidence, 0);
        EXPECT_LE(got.confidence, 1);
    }
}

TEST(PupilDetector, RowsMayBePadded) {
    DrawnEye eye;
    eye.pupil = {70, 88, 30, 26, 1};
    const Image8 image = draw(eye);
    std::vector<std::uint8_t> padded(static_cast<std::size_t>(256 * 192), 7);
    for (std::size_t y = 0; y < 192; ++y)
        std::copy_n(image.data.begin() + static_cast<long>(y) * 192, 192, padded.begin() + static_cast<long>(y) * 256);
    PupilDetector detector;
    const PupilDetection plain = detector.detect(view_of(image)), with = detector.detect({padded.data(), 192, 192, 256});
    EXPECT_EQ(plain.ellipse.x, with.ellipse.x);
    EXPECT_EQ(plain.confidence, with.confidence);
}

TEST(Ellipse, PerimeterAndAreaOfKnownShapes) {
    EXPECT_NEAR((Ellipse{0, 0, 2, 2, 0}.perimeter()), 2 * M_PI, 1e-12);
    EXPECT_NEAR((Ellipse{0, 0, 4, 2, 0}.perimeter()), 9.688448220547676, 1e-5);  // 8 E(sqrt(3)/2), complete elliptic integral
    EXPECT_NEAR((Ellipse{0, 0, 4, 2, 0}.area()), 2 * M_PI, 1e-12);
    const Ellipse swapped = ellipse_of(1, 2, 3, 5, 0.2);
    EXPECT_EQ(swapped.major, 10);
    EXPECT_NEAR(swapped.angle, 0.2 + M_PI / 2, 1e-12);
    EXPECT_EQ(ellipse_of(0, 0, 2, 1, M_PI).angle, 0);
}

}  // namespace
}  // namespace entoptic::drivers
