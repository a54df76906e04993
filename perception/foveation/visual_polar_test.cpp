#include "perception/foveation/visual_polar_math.glsl"
#include "perception/testing/oracles.h"

#include <gtest/gtest.h>
#include <numbers>

namespace entoptic::perception {
namespace {

using namespace testing;

TEST(VisualPolar, IsThatOfTheTable) {
    double density = 0, cumulated = 0, inverse = 0, fitted = 0, printed = 0;
    for (const OracleRow& row : oracle("liu_polar")) {
        const double alpha = row.at("alpha_deg");
        density = std::max(density, relative_error(visual_polar::polar_density(alpha), row.at("g_eq1")));
        cumulated = std::max(cumulated, relative_error(visual_polar::polar_samples(alpha), row.at("cdf_exact")));
        cumulated = std::max(cumulated, relative_error(visual_polar::radial(alpha, 80.0), row.at("rho_exact_alphaM80")));
        inverse = std::max(inverse, relative_error(visual_polar::eccentricity_of_radial(row.at("rho_exact_alphaM80"), 80.0), alpha));
        if (std::isnan(row.at("alpha_eq3_of_rho_eq2"))) continue;
        printed = std::max(printed, relative_error(visual_polar::cumulated_as_printed(alpha) / visual_polar::cumulated_as_printed(80.0),
                                                   row.at("rho_eq2_alphaM80")));
        fitted =
            std::max(fitted, relative_error(visual_polar::polar_equation_3(row.at("rho_eq2_alphaM80")), row.at("alpha_eq3_of_rho_eq2")));
        EXPECT_NEAR(visual_polar::polar_equation_3(row.at("rho_eq2_alphaM80")) - alpha, row.at("eq3_error_deg"), 1e-6);
    }
    ledger("foveation.visual_polar", "equations 1 to 3", "double against oracle max",
           std::max({density, cumulated, inverse, fitted, printed}));
    EXPECT_LT(density, 1e-8);
    EXPECT_LT(cumulated, 1e-8);
    EXPECT_LT(inverse, 1e-8);  // the table's rho has 9 digits
    EXPECT_LT(printed, 1e-8);
    EXPECT_LT(fitted, 1e-8);
}

TEST(VisualPolar, InverseIsExactEverywhere) {
    for (double edge : {45.0, 80.0, 104.0, 180.0})
        for (double alpha = 0.01; alpha < edge; alpha += 0.37)
            EXPECT_NEAR(visual_polar::eccentricity_of_radial(visual_polar::radial(alpha, edge), edge), alpha, 1e-9 * (1 + alpha)) << edge;
    EXPECT_EQ(visual_polar::polar_eccentricity(0.0), 0);
    EXPECT_NEAR(visual_polar::eccentricity_of_radial(1.0, 80.0), 80, 1e-10);
    // Newton's method against the closed form, all over the sphere.
    for (double alpha = 0; alpha <= 180; alpha += 0.37) {
        const double samples = visual_polar::polar_samples(alpha);
        EXPECT_NEAR(visual_polar::polar_eccentricity(samples), visual_polar::eccentricity_by_lambert_w(samples), 1e-9 * (1 + alpha));
        EXPECT_NEAR(visual_polar::polar_eccentricity(samples), alpha, 1e-9 * (1 + alpha));
    }
}

TEST(VisualPolar, LambertWFulfilsItsEquation) {
    for (double x : {-0.36787944, -0.36, -0.3, -0.1, -1e-3, -1e-9, 0.0}) {
        const double w = visual_polar::lambert_w(x);
        EXPECT_GE(w, -1);
        EXPECT_NEAR(w * std::exp(w), x, 1e-14);
    }
}

TEST(VisualPolar, DensityIsTheSlopeAndContinuous) {
    for (double alpha : {1.0, 5.0, 8.0, 40.0, 100.0}) {
        const double h = 1e-4;
        EXPECT_NEAR((visual_polar::polar_samples(alpha + h) - visual_polar::polar_samples(alpha - h)) / (2 * h),
                    visual_polar::polar_density(alpha), 1e-6 * alpha);
    }
    // 36.380 and 36.374: 0.02 % at the fovea's rim.
    EXPECT_NEAR(visual_polar::polar_density(5.79), visual_polar::polar_density(5.790001), 0.01);
    // So the radial coordinate has no kink there.
    const double before = visual_polar::radial(5.79, 80.0) - visual_polar::radial(5.78, 80.0),
                 after = visual_polar::radial(5.80, 80.0) - visual_polar::radial(5.79, 80.0);
    EXPECT_NEAR(after / before, 1, 2e-3);
}

}  // namespace
}  // namespace entoptic::perception
