#include "samples/demo/detail.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace samples {

static constexpr float degree = std::numbers::pi_v<float> / 180;
static constexpr float whole_within = 5 * degree;  // Liu et al. 2021, equation 14
static constexpr float gaze_margin = 3 * degree;   // choice: 1 degree of error, and a small saccade that is under way
static constexpr float share_of_resolved = 0.5F;   // choice: an edge moves by at most half of the finest detail there (demo_detail_test)
static constexpr float margin_of_coarser = 0.7F;   // choice: of the deviation that is allowed

static std::size_t vertex(const Patch& patch, int column, int row) { return static_cast<std::size_t>(row * (patch.columns + 1) + column); }

// The point of a level's triangles, as in triangles_of(), at a place in cells of the whole patch.
static glm::vec3 on_level(const Patch& patch, const DetailLevel& level, float column, float row) {
    const int left = std::min(static_cast<int>(column) / level.column_step * level.column_step, patch.columns - level.column_step);
    const int low = std::min(static_cast<int>(row) / level.row_step * level.row_step, patch.rows - level.row_step);
    const float x = (column - static_cast<float>(left)) / static_cast<float>(level.column_step),
                y = (row - static_cast<float>(low)) / static_cast<float>(level.row_step);
    const auto at = [&](int i, int j) { return patch.positions[vertex(patch, left + i * level.column_step, low + j * level.row_step)]; };
    const glm::vec3 a = at(0, 0), d = at(1, 1);
    if (x >= y) { return a + x * (at(1, 0) - a) + y * (d - at(1, 0)); }
    return a + y * (at(0, 1) - a) + x * (d - at(0, 1));
}

// Both surfaces are linear on the pieces into which the whole patch's triangles and the level's diagonals cut each other, so that the largest
// distance lies at a corner of a piece: at a vertex of the whole, or where a diagonal of the level crosses an edge of the whole.
static float deviation(const Patch& patch, const DetailLevel& level) {
    float largest = 0;
    const auto compare = [&](float column, float row) {
        largest = std::max(largest, glm::distance(on_level(patch, {}, column, row), on_level(patch, level, column, row)));
    };
    for (int row = 0; row <= patch.rows; ++row) {
        for (int column = 0; column <= patch.columns; ++column) { compare(static_cast<float>(column), static_cast<float>(row)); }
    }
    for (const int crossings : {level.column_step, level.row_step, std::abs(level.column_step - level.row_step)}) {
        for (int row = 0; row < patch.rows; row += level.row_step) {
            for (int column = 0; column < patch.columns; column += level.column_step) {
                for (int i = 1; i < crossings; ++i) {
                    const float along = static_cast<float>(i) / static_cast<float>(crossings);
                    compare(static_cast<float>(column) + along * static_cast<float>(level.column_step),
                            static_cast<float>(row) + along * static_cast<float>(level.row_step));
                }
            }
        }
    }
    return largest;
}

std::vector<DetailLevel> detail_levels(const Patch& patch) {
    std::vector<DetailLevel> levels{{}};
    const auto coarser = [&](int columns, int rows) -> std::optional<DetailLevel> {
        DetailLevel level{levels.back().column_step * columns, levels.back().row_step * rows, 0};
        if (patch.columns % level.column_step != 0 || patch.rows % level.row_step != 0) { return std::nullopt; }
        level.deviation_m = std::max(deviation(patch, level), levels.back().deviation_m);
        return level;
    };
    for (;;) {
        const auto fewer_columns = coarser(2, 1), fewer_rows = coarser(1, 2);
        if (!fewer_columns && !fewer_rows) { return levels; }
        const bool columns = fewer_columns && (!fewer_rows || fewer_columns->deviation_m <= fewer_rows->deviation_m);
        levels.push_back(columns ? *fewer_columns : *fewer_rows);
    }
}

std::vector<std::uint32_t> triangles_of(const Patch& patch, const DetailLevel& level) {
    std::vector<std::uint32_t> indices;
    for (int row = 0; row < patch.rows; row += level.row_step) {
        for (int column = 0; column < patch.columns; column += level.column_step) {
            const auto at = [&](int i, int j) {
                return static_cast<std::uint32_t>(vertex(patch, column + i * level.column_step, row + j * level.row_step));
            };
            for (const std::uint32_t index : {at(0, 0), at(1, 0), at(1, 1), at(0, 0), at(1, 1), at(0, 1)}) { indices.push_back(index); }
        }
    }
    return indices;
}

Patch reduced(const Patch& patch, const DetailLevel& level) {
    Patch result = patch;
    result.columns = patch.columns / level.column_step;
    result.rows = patch.rows / level.row_step;
    result.positions.clear();
    result.normals.clear();
    for (int row = 0; row <= patch.rows; row += level.row_step) {
        for (int column = 0; column <= patch.columns; column += level.column_step) {
            result.positions.push_back(patch.positions[vertex(patch, column, row)]);
            result.normals.push_back(patch.normals[vertex(patch, column, row)]);
        }
    }
    return result;
}

Cover cover_of(const Patch& patch) {
    constexpr int across = 2, along = 8;  // spheres less one: a long leaf is far from round
    Cover cover;
    for (int j = 0; j <= along; ++j) {
        for (int i = 0; i <= across; ++i) {
            cover.centres.push_back(patch.positions[vertex(patch, patch.columns * i / across, patch.rows * j / along)]);
        }
    }
    for (const glm::vec3& point : patch.positions) {
        float nearest = 1e9F;
        for (const glm::vec3& centre : cover.centres) { nearest = std::min(nearest, glm::distance(point, centre)); }
        cover.radius = std::max(cover.radius, nearest);
    }
    return cover;
}

float unseen_deviation(const EyeView& view, const Cover& cover) {
    // What a runtime says may be anything.
    if (!view.seen || !std::isfinite(view.seen->resolved_angle) || !std::isfinite(view.seen->eccentricity_factor)) { return 0; }
    const glm::vec3 gaze = view.orientation * glm::normalize(view.seen->gaze);
    float unseen = 1e9F;
    for (const glm::vec3& centre : cover.centres) {
        const glm::vec3 way = centre - view.position;
        const float distance = glm::length(way);
        if (!(distance > 2 * cover.radius)) { return 0; }
        const float eccentricity =
            std::acos(std::clamp(glm::dot(way / distance, gaze), -1.0F, 1.0F)) - std::asin(cover.radius / distance) - gaze_margin;
        if (!(eccentricity > whole_within)) { return 0; }
        const float resolved = view.seen->resolved_angle * (1 + view.seen->eccentricity_factor * eccentricity);
        unseen = std::min(unseen, share_of_resolved * resolved * (distance - cover.radius));
    }
    return unseen;
}

std::size_t choose_level(const std::vector<DetailLevel>& levels, float unseen_m, std::size_t current) {
    std::size_t chosen = 0;
    for (std::size_t i = 1; i < levels.size(); ++i) {
        if (levels[i].deviation_m <= unseen_m * (i > current ? margin_of_coarser : 1.0F)) { chosen = i; }
    }
    return chosen;
}

}  // namespace samples
