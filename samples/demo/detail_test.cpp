// labels: unit
// Levels of detail: what is drawn instead of a patch stays as near to it as the level says, and is taken only where an eye cannot tell.
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "samples/demo/detail.h"
#include "samples/demo/plants.h"

namespace samples {
namespace {

constexpr float degree = std::numbers::pi_v<float> / 180;

// The point of a patch's triangles at (s, t), not its bilinear surface.
glm::vec3 on_triangles(const Patch& patch, float s, float t) {
    const float x = s * static_cast<float>(patch.columns), y = t * static_cast<float>(patch.rows);
    const int column = std::min(static_cast<int>(x), patch.columns - 1), row = std::min(static_cast<int>(y), patch.rows - 1);
    const float u = x - static_cast<float>(column), v = y - static_cast<float>(row);
    const auto at = [&](int i, int j) { return patch.positions[static_cast<std::size_t>((row + j) * (patch.columns + 1) + column + i)]; };
    return u >= v ? at(0, 0) + u * (at(1, 0) - at(0, 0)) + v * (at(1, 1) - at(1, 0))
                  : at(0, 0) + v * (at(0, 1) - at(0, 0)) + u * (at(1, 1) - at(0, 1));
}

// A sphere about the origin, radius 1 m.
Patch ball(int columns, int rows) {
    Patch patch;
    patch.columns = columns;
    patch.rows = rows;
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column <= columns; ++column) {
            const float a = 360 * degree * static_cast<float>(column) / static_cast<float>(columns),
                        b = 180 * degree * static_cast<float>(row) / static_cast<float>(rows);
            patch.normals.emplace_back(std::sin(b) * std::cos(a), -std::cos(b), -std::sin(b) * std::sin(a));
            patch.positions.push_back(patch.normals.back());
        }
    }
    return patch;
}

// Looking along -z from the origin at `gaze_degrees` to the right, resolving a minute of arc, twice as much at 3.3 degrees.
EyeView eye(float gaze_degrees) {
    EyeView view;
    view.seen = {{std::sin(gaze_degrees * degree), 0, -std::cos(gaze_degrees * degree)}, degree / 60, 1 / (3.3F * degree)};
    return view;
}

Cover point_at(float degrees, float distance) {
    return {{glm::vec3(std::sin(degrees * degree), 0, -std::cos(degrees * degree)) * distance}, 0};
}

TEST(Detail, NoPointMovesFartherThanItsLevelSays) {
    for (const Patch& patch : {ball(32, 16), plant_leaves({0, 0, 0}, 7)[10], plant_leaves({0, 0, 0}, 7)[41]}) {
        const std::vector<DetailLevel> levels = detail_levels(patch);
        ASSERT_GT(levels.size(), 5U);
        EXPECT_EQ(levels.front().deviation_m, 0);
        for (std::size_t i = 1; i < levels.size(); ++i) {
            const Patch simple = reduced(patch, levels[i]);
            float largest = 0;
            for (int j = 0; j <= 333; ++j) {
                for (int k = 0; k <= 77; ++k) {
                    const float s = static_cast<float>(k) / 77, t = static_cast<float>(j) / 333;
                    largest = std::max(largest, glm::distance(on_triangles(patch, s, t), on_triangles(simple, s, t)));
                }
            }
            EXPECT_LE(largest, levels[i].deviation_m * 1.001F + 1e-6F) << i;
            EXPECT_GE(levels[i].deviation_m, levels[i - 1].deviation_m);
            EXPECT_EQ(2 * triangles_of(patch, levels[i]).size(), triangles_of(patch, levels[i - 1]).size());
        }
    }
}

// A chord of a circle of radius 1 over an angle of 2a lies 1 - cos(a) within it.
TEST(Detail, DeviationOfATubeIsThatOfItsChords) {
    Patch patch;
    patch.columns = 256;
    for (int row = 0; row <= 1; ++row) {
        for (int column = 0; column <= 256; ++column) {
            const float a = 360 * degree * static_cast<float>(column) / 256;
            patch.normals.emplace_back(std::cos(a), 0, -std::sin(a));
            patch.positions.push_back(patch.normals.back() + glm::vec3(0, row, 0));
        }
    }
    for (const DetailLevel& level : detail_levels(patch)) {
        const double expected = level.column_step > 1 ? 1 - std::cos(std::numbers::pi / 256 * level.column_step) : 0;
        if (level.column_step <= 32) { EXPECT_NEAR(level.deviation_m, expected, 2e-6) << level.column_step; }
    }
}

TEST(Detail, ReducedPatchHasTheLevelsTriangles) {
    const Patch patch = plant_leaves({0, 0, 0}, 3)[0];
    const DetailLevel level = detail_levels(patch)[4];
    const Patch simple = reduced(patch, level);
    const std::vector<std::uint32_t> of_whole = triangles_of(patch, level), of_simple = triangles_of(simple, {});
    ASSERT_EQ(of_whole.size(), of_simple.size());
    for (std::size_t i = 0; i < of_whole.size(); ++i) { EXPECT_EQ(patch.positions[of_whole[i]], simple.positions[of_simple[i]]); }
}

TEST(Detail, CoverHoldsThePatch) {
    const Patch patch = plant_leaves({0, 0, 0}, 3)[5];
    const Cover cover = cover_of(patch);
    for (const glm::vec3& point : patch.positions) {
        float nearest = 1e9F;
        for (const glm::vec3& centre : cover.centres) { nearest = std::min(nearest, glm::distance(point, centre)); }
        EXPECT_LE(nearest, cover.radius);
    }
    EXPECT_LT(cover.radius, 0.03F);
}

TEST(Detail, NothingIsSimplerNearTheGazeOrWithoutOne) {
    for (const float gaze : {-30.0F, 0.0F, 25.0F}) {
        for (float at = -50; at <= 50; at += 0.5F) {
            if (std::abs(std::abs(at - gaze) - 8) < 0.1F) { continue; }
            const float unseen = unseen_deviation(eye(gaze), point_at(at, 2));
            EXPECT_EQ(unseen == 0, std::abs(at - gaze) < 8) << gaze << " " << at;  // 5 degrees, and 3 for the tracker
        }
    }
    for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1.0F}) {
        EyeView resolves = eye(0), falls_off = eye(0), looks = eye(0);
        resolves.seen->resolved_angle = wrong;
        falls_off.seen->eccentricity_factor = wrong;
        looks.seen->gaze = glm::vec3(wrong < 0 ? 0 : wrong);
        for (const EyeView& view : {resolves, falls_off, looks}) {
            EXPECT_LE(unseen_deviation(view, point_at(50, 2)), unseen_deviation(eye(0), point_at(50, 2))) << wrong;
        }
    }
    EyeView blind = eye(0);
    blind.seen.reset();
    EXPECT_EQ(unseen_deviation(blind, point_at(50, 2)), 0);
    EXPECT_EQ(unseen_deviation(eye(0), {{{0.3F, 0, -0.3F}}, 0.3F}), 0);  // the eye is beside it
}

// The law of the extension, by hand: at 33 degrees less the margin of 3, half of a minute times 1 + 30/3.3, over 2 m.
TEST(Detail, WhatAnEyeDoesNotSeeIsHalfOfWhatItResolves) {
    const double resolved = std::numbers::pi / 180 / 60 * (1 + 30 / 3.3);
    EXPECT_NEAR(unseen_deviation(eye(0), point_at(33, 2)), 0.5 * resolved * 2, 1e-6);
    EXPECT_NEAR(unseen_deviation(eye(0), point_at(-33, 4)), 0.5 * resolved * 4, 2e-6);
}

TEST(Detail, ALevelAtTheEdgeStays) {
    const std::vector<DetailLevel> levels{{1, 1, 0}, {2, 1, 1e-3F}, {2, 2, 4e-3F}};
    EXPECT_EQ(choose_level(levels, 0, 2), 0U);        // finer at once
    EXPECT_EQ(choose_level(levels, 1.1e-3F, 0), 0U);  // coarser with a margin only
    EXPECT_EQ(choose_level(levels, 1.1e-3F, 1), 1U);  // but that one may stay
    EXPECT_EQ(choose_level(levels, 1.5e-3F, 0), 1U);
    EXPECT_EQ(choose_level(levels, 10e-3F, 0), 2U);
    std::size_t level = 0;
    int changes = 0;
    for (int i = 0; i < 200; ++i) {  // 10 % of noise about the edge
        const std::size_t next = choose_level(levels, 1e-3F * (1.2F + 0.12F * std::sin(static_cast<float>(i))), level);
        changes += next != level ? 1 : 0;
        level = next;
    }
    EXPECT_LE(changes, 1);
}

}  // namespace
}  // namespace samples
