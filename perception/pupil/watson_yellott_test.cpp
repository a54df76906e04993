// labels: unit
#include "perception/pupil/watson_yellott.h"

#include "perception/testing/oracles.h"

#include <gtest/gtest.h>
#include <limits>

namespace entoptic::perception {
namespace {

TEST(Pupil, IsThatOfTheTable) {
    double worst = 0;
    for (const testing::OracleRow& row : testing::oracle("pupil_watson_yellott")) {
        const double luminance = row.at("luminance_cd_m2"), age = row.at("age"), area = row.at("field_area_deg2");
        worst = std::max(worst, testing::relative_error(pupil_diameter_mm(luminance, age, area, 2), row.at("diameter_mm_two_eyes")));
        worst = std::max(worst, testing::relative_error(pupil_diameter_mm(luminance, age, area, 1), row.at("diameter_mm_one_eye")));
    }
    testing::ledger("pupil.watson_yellott", "all rows", "double against oracle max rel", worst);
    EXPECT_LT(worst, 1e-8);
}

TEST(Pupil, ClosesWithLightAndStaysWithinItsRange) {
    double before = 10;
    for (double y = 1e-6; y <= 1e8; y *= 1.5) {
        const double d = pupil_diameter_mm(y, 30, 8495, 2);
        EXPECT_LE(d, before);
        EXPECT_GE(d, 1.5);
        before = d;
    }
    EXPECT_NEAR(pupil_diameter_mm(20, 30, 8495, 2), 3.05, 0.01);  // facts/perception.md section 2: looking at the panel
    EXPECT_NEAR(pupil_diameter_mm(130, 30, 8495, 2), 2.54, 0.01);
}

TEST(Pupil, NonsenseGivesAPupil) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
    for (double y : {nan, inf, -inf, -1.0, 0.0, 1e300})
        for (double age : {nan, -5.0, 300.0})
            for (double area : {nan, -1.0, inf}) {
                const double d = pupil_diameter_mm(y, age, area, 7);
                EXPECT_TRUE(d >= 1.5 && d <= 9.0) << y << " " << age << " " << area;
            }
}

TEST(Pupil, DarknessGivesTheWidestPupil) { EXPECT_DOUBLE_EQ(pupil_diameter_mm(0, 28.58, 8495, 2), 7.75); }

}  // namespace
}  // namespace entoptic::perception
