#include "samples/demo/bvh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace samples {

static constexpr std::uint32_t triangles_per_leaf = 4;

Bvh::Bvh(const std::vector<Patch>& patches) {
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const Patch& patch = patches[i];
        for (int row = 0; patch.emitter == Emitter::none && row < patch.rows; ++row) {
            for (int column = 0; column < patch.columns; ++column) { add_cell(patch, static_cast<int>(i), column, row); }
        }
    }
    nodes_.reserve(triangles_.size() * 2);
    nodes_.emplace_back();
    build(0, 0, static_cast<std::uint32_t>(triangles_.size()));
}

void Bvh::add_cell(const Patch& patch, int index, int column, int row) {
    const auto at = static_cast<std::size_t>(row * (patch.columns + 1) + column);
    const std::size_t above = at + static_cast<std::size_t>(patch.columns) + 1;
    const glm::vec2 step(1.0F / static_cast<float>(patch.columns), 1.0F / static_cast<float>(patch.rows));
    const glm::vec2 st = glm::vec2(column, row) * step;
    const auto& p = patch.positions;
    triangles_.push_back({p[at], p[at + 1] - p[at], p[above + 1] - p[at], index, st, {step.x, 0}, step});
    triangles_.push_back({p[at], p[above + 1] - p[at], p[above] - p[at], index, st, step, {0, step.y}});
}

namespace {

struct Bounds {
    glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};

    void add(glm::vec3 p) {
        low = glm::min(low, p);
        high = glm::max(high, p);
    }
    void add(const Bounds& other) {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
    float area() const {  // half of it: only ratios count
        const glm::vec3 size = glm::max(high - low, 0.0F);
        return size.x * size.y + size.y * size.z + size.z * size.x;
    }
};

struct Split {
    int axis = 0;
    float position = 0;
    float cost = std::numeric_limits<float>::infinity();
};

}  // namespace

// The best of a few planes across each axis by the surface-area heuristic: a child is visited in proportion to its area.
// `bounds_of` and `centre_of` take a triangle's number.
template <typename BoundsOf, typename CentreOf>
static Split best_split(std::uint32_t count, const Bounds& centres, const BoundsOf& bounds_of, const CentreOf& centre_of) {
    constexpr int bins = 12;
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
        const float low = centres.low[axis], size = centres.high[axis] - low;
        if (size <= 0) { continue; }
        std::array<Bounds, bins> bounds;
        std::array<int, bins> counts{};
        for (std::uint32_t i = 0; i < count; ++i) {
            const auto bin = static_cast<std::size_t>(std::min((centre_of(i)[axis] - low) / size * bins, bins - 1.0F));
            bounds[bin].add(bounds_of(i));
            ++counts[bin];
        }
        std::array<float, bins> right_costs{};
        Bounds right;
        for (int bin = bins - 1, n = 0; bin > 0; --bin) {
            right.add(bounds[static_cast<std::size_t>(bin)]);
            n += counts[static_cast<std::size_t>(bin)];
            right_costs[static_cast<std::size_t>(bin)] = n > 0 ? right.area() * static_cast<float>(n) : 0.0F;
        }
        Bounds left;
        for (int bin = 0, n = 0; bin + 1 < bins; ++bin) {
            left.add(bounds[static_cast<std::size_t>(bin)]);
            n += counts[static_cast<std::size_t>(bin)];
            const float cost = (n > 0 ? left.area() * static_cast<float>(n) : 0.0F) + right_costs[static_cast<std::size_t>(bin) + 1];
            if (cost < best.cost) { best = {axis, low + size * static_cast<float>(bin + 1) / bins, cost}; }
        }
    }
    return best;
}

void Bvh::build(std::uint32_t node, std::uint32_t first, std::uint32_t count) {
    const auto bounds_of = [](const Triangle& t) {
        Bounds bounds;
        for (const glm::vec3& p : {t.corner, t.corner + t.edge_a, t.corner + t.edge_b}) { bounds.add(p); }
        return bounds;
    };
    const auto centre_of = [](const Triangle& t) { return t.corner + (t.edge_a + t.edge_b) / 3.0F; };
    Bounds bounds, centres;
    for (std::uint32_t i = first; i < first + count; ++i) {
        bounds.add(bounds_of(triangles_[i]));
        centres.add(centre_of(triangles_[i]));
    }
    const glm::vec3 low = bounds.low - 1e-5F, high = bounds.high + 1e-5F;
    nodes_[node] = Node{Float4{low.x, low.y, low.z, 0}, Float4{high.x, high.y, high.z, 1e30F}, first, count};
    if (count <= triangles_per_leaf) { return; }
    const Split split = best_split(
        count, centres, [&](std::uint32_t i) { return bounds_of(triangles_[first + i]); },
        [&](std::uint32_t i) { return centre_of(triangles_[first + i]); });
    const auto begin = triangles_.begin() + first, end = begin + count;
    auto middle = std::partition(begin, end, [&](const Triangle& t) { return centre_of(t)[split.axis] < split.position; });
    if (middle == begin || middle == end) {  // all centres in one place
        middle = begin + count / 2;
    }
    const auto left_count = static_cast<std::uint32_t>(middle - begin);
    const auto left = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    nodes_.emplace_back();
    nodes_[node].first = left;
    nodes_[node].count = 0;
    build(left, first, left_count);
    build(left + 1, first + left_count, count - left_count);
}

// Calls on_hit(triangle, distance, a, b) for hits nearer than `distance`; it returns the new limit, 0 to stop.
template <typename OnHit> void Bvh::traverse(glm::vec3 from, glm::vec3 direction, float distance, OnHit&& on_hit) const {
    // Infinite inverses are right for the slab test: a ray along a slab is within it always or never.
    const Float4 origin{from.x, from.y, from.z, 0}, inverse{1.0F / direction.x, 1.0F / direction.y, 1.0F / direction.z, 1};
    const auto entry = [&](const Node& node) __attribute__((always_inline)) {  // where the ray enters a node; infinite when it misses
        const Float4 a = (node.low - origin) * inverse, b = (node.high - origin) * inverse;
        const Float4 near = a < b ? a : b, far = a > b ? a : b;
        const float in = std::max(std::max(near[0], near[1]), std::max(near[2], near[3]));
        const float out = std::min(std::min(far[0], far[1]), std::min(far[2], distance));
        return in <= out ? in : std::numeric_limits<float>::infinity();
    };
    struct Entry {
        std::uint32_t node;
        float at;
    };
    std::array<Entry, 64> stack;
    std::size_t depth = 0;
    stack[depth++] = {0, entry(nodes_[0])};
    while (depth > 0) {
        const Entry top = stack[--depth];
        if (top.at >= distance) { continue; }
        const Node& node = nodes_[top.node];
        if (node.count == 0) {
            Entry near{node.first, entry(nodes_[node.first])}, far{node.first + 1, entry(nodes_[node.first + 1])};
            if (near.at > far.at) { std::swap(near, far); }
            if (far.at < distance) { stack[depth++] = far; }
            if (near.at < distance) { stack[depth++] = near; }
            continue;
        }
        for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
            const Triangle& t = triangles_[i];  // Möller and Trumbore 1997
            const glm::vec3 p = glm::cross(direction, t.edge_b);
            const float determinant = glm::dot(t.edge_a, p);
            if (std::abs(determinant) < 1e-12F) { continue; }
            const float scale = 1.0F / determinant;
            const glm::vec3 s = from - t.corner;
            const float u = glm::dot(s, p) * scale;
            const glm::vec3 q = glm::cross(s, t.edge_a);
            const float v = glm::dot(direction, q) * scale;
            const float d = glm::dot(t.edge_b, q) * scale;
            if (u < 0 || v < 0 || u + v > 1 || d <= 0 || d >= distance) { continue; }
            distance = on_hit(t, d, u, v, determinant > 0);
            if (distance <= 0) { return; }
        }
    }
}

bool Bvh::blocked(glm::vec3 from, glm::vec3 to) const {
    const glm::vec3 way = to - from;
    const float length = glm::length(way);
    bool hit = false;
    traverse(from, way / length, length * 0.9999F, [&](const Triangle&, float, float, float, bool) {
        hit = true;
        return 0.0F;
    });
    return hit;
}

Hit Bvh::closest(glm::vec3 from, glm::vec3 direction, float distance) const {
    Hit hit;
    traverse(from, direction, distance, [&](const Triangle& t, float d, float a, float b, bool front) {
        const glm::vec2 st = t.st + a * t.st_a + b * t.st_b;
        hit = {t.patch, st.x, st.y, front};
        return d;
    });
    return hit;
}

}  // namespace samples
