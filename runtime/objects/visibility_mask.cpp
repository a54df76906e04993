#include "runtime/objects/visibility_mask.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace entoptic::runtime {

namespace {

constexpr int border_steps = 64;   // choice: a chord of such a circle lies less than 0.13 % of its radius inside
constexpr int panel_steps = 1024;  // positions on the panel's border of visibility that are looked at for each colour
constexpr float margin = 1.005f;   // so that no chord cuts off what is seen
constexpr float two_pi = 6.28318531f;

struct Rectangle {
    float left, right, down, up;
};

Rectangle view_rectangle(const Fov& fov) {
    return {std::tan(fov.angle_left), std::tan(fov.angle_right), std::tan(fov.angle_down), std::tan(fov.angle_up)};
}

// Direction that one colour shows at panel position (x, y) about its optical centre (interfaces/headset.h), as tangents.
glm::vec2 tangents_at(const Lens& lens, const ChannelDistortion& channel, glm::vec2 at) {
    const float r2 = glm::dot(at, at);
    const glm::vec3 k = channel.coefficients;
    const float d = 1 / (1 + r2 * (k.x + r2 * (k.y + r2 * k.z)));
    const glm::vec2 shown{at.x * d + channel.centre.x, (at.y * d + channel.centre.y) * lens.aspect};
    return {(shown.x + lens.principal_point.x) / lens.focal.x, (lens.principal_point.y - shown.y) / lens.focal.y};
}

// How far from the optical centre, along `direction` on the panel, something is seen: to the lens's cutoff or the panel's edge.
float visible_radius(const Lens& lens, const ChannelDistortion& channel, glm::vec2 direction) {
    const glm::vec2 edge{1, 1 / lens.aspect};
    float radius = std::sqrt(std::max(lens.r2_cutoff, 0.0f));
    for (int axis = 0; axis < 2; ++axis) {
        if (direction[axis] == 0) continue;
        const float limit = direction[axis] > 0 ? edge[axis] - channel.centre[axis] : -edge[axis] - channel.centre[axis];
        radius = std::min(radius, std::max(limit / direction[axis], 0.0f));
    }
    return radius;
}

// Length of the ray from the view's axis to the rectangle's side.
float to_rectangle(const Rectangle& view, glm::vec2 direction) {
    float length = 1e9f;
    if (direction.x != 0) length = std::min(length, (direction.x > 0 ? view.right : view.left) / direction.x);
    if (direction.y != 0) length = std::min(length, (direction.y > 0 ? view.up : view.down) / direction.y);
    return length;
}

// Largest radius seen in each of border_steps sectors of direction.
std::array<float, border_steps> sector_radii(const EyeOptics& optics) {
    std::array<float, border_steps> radii{};
    for (const ChannelDistortion& channel : optics.lens.channels) {
        for (int i = 0; i < panel_steps; ++i) {
            const float angle = two_pi * float(i) / panel_steps;
            const glm::vec2 direction{std::cos(angle), std::sin(angle)};
            const glm::vec2 seen = tangents_at(optics.lens, channel, direction * visible_radius(optics.lens, channel, direction));
            const float turn = std::atan2(seen.y, seen.x) / two_pi + 1;
            const auto sector = static_cast<std::size_t>(std::lround(turn * border_steps)) % border_steps;
            radii[sector] = std::max(radii[sector], glm::length(seen));
        }
    }
    return radii;
}

// Directions of the border: even steps, and the view's corners, so that the hidden area is bounded by exactly the rectangle.
std::vector<glm::vec2> border_directions(const Rectangle& view) {
    std::vector<float> angles;
    for (int i = 0; i < border_steps; ++i) angles.push_back(two_pi * float(i) / border_steps);
    for (const glm::vec2 corner : {glm::vec2(view.right, view.up), glm::vec2(view.left, view.up), glm::vec2(view.left, view.down),
                                   glm::vec2(view.right, view.down)}) {
        const float angle = std::atan2(corner.y, corner.x);
        angles.push_back(angle < 0 ? angle + two_pi : angle);
    }
    std::sort(angles.begin(), angles.end());
    angles.erase(std::unique(angles.begin(), angles.end(), [](float a, float b) { return b - a < 1e-4f; }), angles.end());
    std::vector<glm::vec2> directions;
    for (const float angle : angles) directions.emplace_back(std::cos(angle), std::sin(angle));
    return directions;
}

float border_radius(const std::array<float, border_steps>& radii, glm::vec2 direction) {
    const float at = (std::atan2(direction.y, direction.x) / two_pi + 1) * border_steps;
    const auto below = static_cast<std::size_t>(at);
    return std::max(radii[below % border_steps], radii[(below + 1) % border_steps]) * margin;
}

}  // namespace

Mesh visible_border(const EyeOptics& optics) {
    const Rectangle view = view_rectangle(optics.fov);
    const auto radii = sector_radii(optics);
    Mesh mesh;
    for (const glm::vec2 direction : border_directions(view)) {
        mesh.indices.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
        mesh.vertices.push_back(direction * std::min(border_radius(radii, direction), to_rectangle(view, direction)));
    }
    return mesh;
}

Mesh visible_area(const EyeOptics& optics) {
    Mesh mesh = visible_border(optics);
    const auto count = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.emplace_back(0.0f);
    mesh.indices.clear();
    for (std::uint32_t i = 0; i < count; ++i) mesh.indices.insert(mesh.indices.end(), {count, i, (i + 1) % count});
    return mesh;
}

Mesh hidden_area(const EyeOptics& optics) {
    const Rectangle view = view_rectangle(optics.fov);
    const std::vector<glm::vec2> inner = visible_border(optics).vertices;
    const auto count = static_cast<std::uint32_t>(inner.size());
    Mesh mesh;
    mesh.vertices = inner;
    for (const glm::vec2 at : inner) mesh.vertices.push_back(at * to_rectangle(view, at));
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const glm::vec2 u = mesh.vertices[b] - mesh.vertices[a], v = mesh.vertices[c] - mesh.vertices[a];
        if (u.x * v.y - u.y * v.x > 1e-7f) mesh.indices.insert(mesh.indices.end(), {a, b, c});  // where the border is not the rectangle
    };
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint32_t next = (i + 1) % count;
        add(i, count + i, count + next);
        add(i, count + next, next);
    }
    return mesh;
}

}  // namespace entoptic::runtime
