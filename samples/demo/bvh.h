// Rays against the office: a bounding-volume hierarchy over the triangles of its patches.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "samples/demo/office.h"

namespace samples {

struct Hit {
    int patch = -1;  // -1: nothing was hit
    float s = 0, t = 0;
    bool front = false;  // the side that is lit
};

class Bvh {
public:
    // Patches that emit are left out: light passes through them, since what they give is counted at the source.
    explicit Bvh(const std::vector<Patch>& patches);

    // Whether anything lies between the two points.
    bool blocked(glm::vec3 from, glm::vec3 to) const;
    // The first patch hit within `distance` along the unit vector `direction`.
    Hit closest(glm::vec3 from, glm::vec3 direction, float distance) const;

private:
    struct Triangle {
        glm::vec3 corner, edge_a, edge_b;
        int patch;
        glm::vec2 st, st_a, st_b;  // parameters at the corner and along the edges
    };
    // Four floats in one register (GCC and Clang): testing boxes is most of the work of baking.
    using Float4 = float __attribute__((vector_size(16)));
    struct Node {
        Float4 low, high;     // the fourth: 0 and a very large number, which leave a ray's range as it is
        std::uint32_t first;  // leaf: first triangle; else the left child, whose neighbour is the right one
        std::uint32_t count;  // 0: inner node
    };
    void add_cell(const Patch& patch, int index, int column, int row);
    void build(std::uint32_t node, std::uint32_t first, std::uint32_t count);
    template <typename OnHit> void traverse(glm::vec3 from, glm::vec3 direction, float distance, OnHit&& on_hit) const;

    std::vector<Triangle> triangles_;
    std::vector<Node> nodes_;
};

}  // namespace samples
