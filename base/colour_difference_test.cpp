// labels: unit
#include "base/colour_difference.h"

#include <cmath>
#include <gtest/gtest.h>

namespace entoptic {
namespace {

struct Row {
    std::array<double, 3> a, b;
    double expected;
};

// From an independent computation of BT.2124 (oracle deltaE_itp, nine digits).
TEST(ColourDifference, IsThatOfBt2124) {
    const Row rows[] = {{{100, 100, 100}, {101, 101, 101}, 0.719268606},
                        {{1, 1, 1}, {1.02, 1.02, 1.02}, 0.728558944},
                        {{0.1, 0.1, 0.1}, {0.105, 0.105, 0.105}, 0.933144443},
                        {{0.04, 0.04, 0.04}, {0.05, 0.05, 0.05}, 3.17916686},
                        {{130, 0, 0}, {128, 0, 0}, 1.0579666},
                        {{10, 10, 10}, {10, 10, 10.5}, 1.73484465}};
    for (const Row& row : rows) EXPECT_NEAR(delta_e_itp(row.a, row.b) / row.expected, 1, 1e-6) << row.a[0];
}

TEST(ColourDifference, IsSymmetricAndZeroForEqualColours) {
    EXPECT_EQ(delta_e_itp({3, 2, 1}, {3, 2, 1}), 0);
    EXPECT_DOUBLE_EQ(delta_e_itp({3, 2, 1}, {30, 2, 0}), delta_e_itp({30, 2, 0}, {3, 2, 1}));
}

TEST(ColourDifference, BlackAndNegativesAreFinite) { EXPECT_TRUE(std::isfinite(delta_e_itp({0, 0, 0}, {-1, 1e8, 5}))); }

}  // namespace
}  // namespace entoptic
