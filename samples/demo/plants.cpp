#include "samples/demo/plants.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace samples {

namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr int leaves = 36, columns = 16, rows = 64;
constexpr float half_thickness = 4e-4F;  // m

// A leaf that rises from the foot, bends over, is folded along its midrib and wavy at its margins.
struct Leaf {
    glm::vec3 foot;
    float azimuth, rise, bend;  // rad: direction, elevation at the foot, and how much of it is lost to the tip
    float length, half_width;   // m
    float waves, wave_height, phase;
};

Leaf leaf_of(glm::vec3 foot, std::uint32_t seed, std::uint32_t i) {
    const auto random = [&](std::uint32_t which, float from, float to) { return std::lerp(from, to, hash01(i, which, seed)); };
    const float outer = static_cast<float>(i) / leaves;                               // the first leaves stand upright
    const float azimuth = 2.39996F * static_cast<float>(i) + random(1, -0.3F, 0.3F);  // the golden angle, as most plants
    const glm::vec3 start = foot + 0.02F * outer * glm::vec3(std::cos(azimuth), 0, std::sin(azimuth));
    return {start,
            azimuth,
            std::lerp(1.45F, 0.85F, outer),
            random(2, 0.9F, 1.5F) + 0.5F * outer,
            random(3, 0.17F, 0.30F),
            random(4, 0.011F, 0.019F),
            random(5, 4, 7),
            random(6, 0.0015F, 0.0035F),
            random(7, 0, 2 * pi)};
}

struct Frame {
    glm::vec3 at, along, up;
};

// The midrib's frame at each row: the direction sinks as it goes.
std::vector<Frame> midrib(const Leaf& leaf) {
    const glm::vec3 out(std::cos(leaf.azimuth), 0, std::sin(leaf.azimuth)), up(0, 1, 0);
    std::vector<Frame> frames;
    glm::vec3 at = leaf.foot;
    for (int row = 0; row <= rows; ++row) {
        const float t = static_cast<float>(row) / rows, elevation = leaf.rise - leaf.bend * std::pow(t, 1.5F);
        const glm::vec3 along = out * std::cos(elevation) + up * std::sin(elevation);
        frames.push_back({at, along, up * std::cos(elevation) - out * std::sin(elevation)});
        at += along * (leaf.length / rows);
    }
    return frames;
}

glm::vec3 point_of(const Leaf& leaf, const Frame& frame, float across, float t) {
    const float half_width = leaf.half_width * std::max(std::pow(std::max(std::sin(pi * std::pow(t, 0.8F)), 0.0F), 0.7F), 0.04F);
    const float fold = 0.35F * half_width * across * across;
    const float wave = leaf.wave_height * across * across * (half_width / leaf.half_width) *
                       std::sin(2 * pi * leaf.waves * t + leaf.phase + (across > 0 ? 1.3F : 0.0F));
    return frame.at + glm::cross(frame.along, frame.up) * (across * half_width) + frame.up * (fold + wave);
}

Patch side_of(const Leaf& leaf, bool upper, glm::vec3 tint) {
    Patch patch;
    patch.columns = columns;
    patch.rows = rows;
    patch.tint = tint;
    patch.texels_per_m = 40;
    const std::vector<Frame> frames = midrib(leaf);
    const auto across_of = [&](int column) { return (upper ? 1.0F : -1.0F) * (2.0F * static_cast<float>(column) / columns - 1.0F); };
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column <= columns; ++column) {
            patch.positions.push_back(
                point_of(leaf, frames[static_cast<std::size_t>(row)], across_of(column), static_cast<float>(row) / rows));
        }
    }
    const auto at = [&](int column, int row) {
        return patch.positions[static_cast<std::size_t>(std::clamp(row, 0, rows) * (columns + 1) + std::clamp(column, 0, columns))];
    };
    for (int row = 0; row <= rows; ++row) {
        for (int column = 0; column <= columns; ++column) {
            patch.normals.push_back(
                glm::normalize(glm::cross(at(column + 1, row) - at(column - 1, row), at(column, row + 1) - at(column, row - 1))));
        }
    }
    for (std::size_t i = 0; i < patch.positions.size(); ++i) { patch.positions[i] += patch.normals[i] * half_thickness; }
    return patch;
}

}  // namespace

std::vector<Patch> plant_leaves(glm::vec3 foot, std::uint32_t seed) {
    std::vector<Patch> patches;
    for (std::uint32_t i = 0; i < leaves; ++i) {
        const Leaf leaf = leaf_of(foot, seed, i);
        const glm::vec3 green = glm::mix(glm::vec3(0.05F, 0.14F, 0.03F), glm::vec3(0.12F, 0.25F, 0.05F), hash01(i, 8, seed));
        patches.push_back(side_of(leaf, true, green));
        patches.push_back(side_of(leaf, false, green * 1.3F));  // undersides are paler
    }
    return patches;
}

}  // namespace samples
