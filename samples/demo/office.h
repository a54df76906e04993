// The geometry of the office: rectangles and surfaces of revolution, in metres. Origin at the eye of someone seated at the
// desk, x to the right, y up, looking along -z: OpenXR's LOCAL space.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "samples/demo/materials.h"

namespace samples {

// What a patch emits, beside what it reflects.
enum class Emitter : std::uint8_t { none, outdoors, ceiling_panel, bulb, moon, stars, power_led };

// Whether light falls on it that can be seen: a bulb and a panel that are off look white.
constexpr bool reflects(Emitter emitter) {
    return emitter == Emitter::none || emitter == Emitter::ceiling_panel || emitter == Emitter::bulb;
}

// A piece of surface with its own part of the lightmap: a grid of (columns + 1) x (rows + 1) vertices whose parameters
// (s, t) run from 0 to 1, s along the columns. cross(d/ds, d/dt) points to the side that is seen and lit.
struct Patch {
    int columns = 1, rows = 1;
    std::vector<glm::vec3> positions;  // row by row, s fastest
    std::vector<glm::vec3> normals;
    glm::vec4 texture{0, 1, 1, 0};  // u, v at (s, t) = (0, 0), then at (1, 1)
    bool texture_turned = false;    // u runs along t and v along s
    Material material = Material::plain;
    glm::vec3 tint{1};        // multiplies the texture's albedo
    float texels_per_m = 16;  // density of the lightmap
    Emitter emitter = Emitter::none;
    float emission = 1;           // stars: own luminance in cd/m²; others: factor on the emitter's luminance
    bool lamp_reflector = false;  // inside of the lamp's shade: baked as a light of its own
};

// The point and normal of a patch at (s, t), linear between its vertices.
struct SurfacePoint {
    glm::vec3 position, normal;
};
SurfacePoint evaluate(const Patch& patch, float s, float t);

// A rectangular opening or light: the points corner + a * edge_a + b * edge_b, facing into the room.
struct RectangleLight {
    glm::vec3 corner, edge_a, edge_b, normal;
};

struct Office {
    std::vector<Patch> patches;
    RectangleLight window;  // the opening in the wall, where the light of the sky comes in
    RectangleLight ceiling_panel;
    glm::vec3 bulb_centre{0};
    float bulb_radius = 0;
    glm::vec3 to_moon{0};  // unit vector
};

constexpr float eye_height = 1.2F;  // of a seated person above the floor, m

constexpr int most_plants = 5;

// `plants`: potted plants on the sill, the cabinet and the desk, 0 to most_plants; each has 72 leaves' sides of 2048 triangles.
Office build_office(int plants = 0);

}  // namespace samples
