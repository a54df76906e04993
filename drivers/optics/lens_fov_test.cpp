// labels: unit
// Against facts/devices.md 1.4: fields of view and display -> render target vectors of the Vive Pro example file.
#include "drivers/optics/lens_fov.h"
#include "drivers/virtual_hmd/virtual_hmd_device.h"

#include <array>
#include <gtest/gtest.h>

namespace entoptic::drivers {
namespace {

constexpr double degrees = 57.29577951308232;

void expect_fov(const Fov& fov, double left, double right, double up, double down) {
    EXPECT_NEAR(fov.angle_left * degrees, left, 6e-5);
    EXPECT_NEAR(fov.angle_right * degrees, right, 6e-5);
    EXPECT_NEAR(fov.angle_up * degrees, up, 6e-5);
    EXPECT_NEAR(fov.angle_down * degrees, down, 6e-5);
}

TEST(LensFov, ExampleFile) {
    expect_fov(lens_fov(virtual_lens(0)), -54.4784, 51.6915, 55.9457, -56.0155);
    expect_fov(lens_fov(virtual_lens(1)), -51.6915, 54.4784, 55.9457, -56.0155);
}

TEST(LensFov, RealVive) {
    Lens lens;
    lens.focal = {1.208483f, 1.087995f};
    lens.principal_point = {-0.091697f, -0.003448f};
    const Fov fov = lens_fov(lens);
    EXPECT_NEAR(fov.angle_left * degrees, -54.460, 6e-4);
    EXPECT_NEAR(fov.angle_right * degrees, 51.298, 6e-4);
    EXPECT_NEAR(fov.angle_up * degrees, 55.727, 6e-4);
    EXPECT_NEAR(fov.angle_down * degrees, -55.842, 6e-4);
}

// The facts' formula, written out on its own.
template <class Real> std::array<Real, 2> render_target_of(const Lens& lens, const ChannelDistortion& c, Real u, Real v) {
    const Real aspect = Real(lens.aspect), ax = Real(c.centre.x), ay = Real(c.centre.y);
    const Real x = 2 * u - 1 - ax, y = (2 * v - 1) / aspect - ay, r2 = x * x + y * y;
    const Real d = 1 / (1 + Real(c.coefficients.x) * r2 + Real(c.coefficients.y) * r2 * r2 + Real(c.coefficients.z) * r2 * r2 * r2);
    const Real scale = Real(0.5) / (1 + Real(lens.grow_for_undistort));
    return {Real(0.5) + (x * d + ax) * scale, Real(0.5) + (y * d + ay) * aspect * scale};
}

struct Vector {
    double u, v;
    std::array<std::array<double, 2>, 3> expected;
};

const std::vector<Vector> vectors{
    {0.5, 0.5, {{{0.499974, 0.499999}, {0.499968, 0.499999}, {0.499962, 0.499999}}}},
    {0.25, 0.5, {{{0.332235, 0.499968}, {0.330226, 0.499956}, {0.328129, 0.499942}}}},
    {0.5, 0.2, {{{0.497705, 0.295389}, {0.497298, 0.292425}, {0.496865, 0.289308}}}},
    {0.9, 0.8, {{{0.810697, 0.737993}, {0.823477, 0.748623}, {0.837944, 0.760665}}}},
};

template <class Real> void expect_vectors(double tolerance) {
    const Lens lens = virtual_lens(0);
    for (const Vector& vector : vectors) {
        for (std::size_t c = 0; c < 3; ++c) {
            const auto uv = render_target_of<Real>(lens, lens.channels[c], Real(vector.u), Real(vector.v));
            EXPECT_NEAR(uv[0], vector.expected[c][0], tolerance);
            EXPECT_NEAR(uv[1], vector.expected[c][1], tolerance);
        }
    }
}

TEST(Lens, DistortionVectorsInDouble) { expect_vectors<double>(6e-7); }
TEST(Lens, DistortionVectorsInFloat) { expect_vectors<float>(1.2e-6); }

TEST(Lens, RightEyeMirrorsLeft) {
    const Lens left = virtual_lens(0), right = virtual_lens(1);
    for (std::size_t c = 0; c < 3; ++c) {
        const auto l = render_target_of<double>(left, left.channels[c], 0.3, 0.6),
                   r = render_target_of<double>(right, right.channels[c], 0.7, 0.6);
        EXPECT_NEAR(l[0], 1 - r[0], 1e-12);
        EXPECT_NEAR(l[1], r[1], 1e-12);
    }
}

// The render target's borders and the field of view's borders are the same directions.
TEST(Lens, FovIsTheRenderTargetsBorder) {
    const Lens lens = virtual_lens(0);
    const Fov fov = lens_fov(lens);
    EXPECT_NEAR(std::tan(fov.angle_left), (-1.6 + lens.principal_point.x) / lens.focal.x, 1e-6);
    EXPECT_NEAR(std::tan(fov.angle_up), (lens.principal_point.y + 1.6) / lens.focal.y, 1e-6);
}

// The denominator crosses zero before the panel's corner (facts/devices.md 1.4): the cut-off keeps clear of it in every channel.
TEST(Lens, TheCutoffKeepsClearOfThePole) {
    const Lens lens = virtual_lens(0);
    for (const ChannelDistortion& c : lens.channels) {
        for (double r2 = 0; r2 <= lens.r2_cutoff; r2 += 0.01)
            EXPECT_GT(1 + c.coefficients.x * r2 + c.coefficients.y * r2 * r2 + c.coefficients.z * r2 * r2 * r2, 0.4) << r2;
    }
}

}  // namespace
}  // namespace entoptic::drivers
