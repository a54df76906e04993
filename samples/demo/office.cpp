#include "samples/demo/office.h"

#include "samples/demo/plants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

namespace samples {

namespace {

constexpr float pi = std::numbers::pi_v<float>;

// Heights in this file are above the floor; the builder lowers everything by the eye height at the end.
constexpr float room_left = -2.6F, room_right = 1.4F, room_front = -2.4F, room_back = 2.6F, room_height = 2.7F;
constexpr float desk_top = 0.73F;

struct Finish {
    Material material = Material::plain;
    glm::vec3 tint{1};
    float texels_per_m = 40;
};

const glm::vec4 whole_texture{0, 1, 1, 0};

class Builder {
public:
    Office office;

    // A rectangle seen from the side where `right` x `up` points.
    Patch& rectangle(glm::vec3 bottom_left, glm::vec3 right, glm::vec3 up, const Finish& finish, glm::vec4 texture = whole_texture) {
        Patch& patch = office.patches.emplace_back();
        const glm::vec3 normal = glm::normalize(glm::cross(right, up));
        patch.positions = {bottom_left, bottom_left + right, bottom_left + up, bottom_left + right + up};
        patch.normals.assign(4, normal);
        patch.texture = texture;
        apply(patch, finish);
        return patch;
    }

    // A box of full size `size` about the origin of `place`. Faces: 0 right, 1 left, 2 top, 3 bottom, 4 front (+z), 5 back.
    // Returns the index of its first patch.
    std::size_t box(const glm::mat4& place, glm::vec3 size, const Finish& finish) {
        const std::size_t first = office.patches.size();
        const glm::vec3 h = size * 0.5F;
        const auto face = [&](glm::vec3 corner, glm::vec3 right, glm::vec3 up) {
            rectangle(point(place, corner), vector(place, right), vector(place, up), finish);
        };
        face({h.x, -h.y, h.z}, {0, 0, -size.z}, {0, size.y, 0});
        face({-h.x, -h.y, -h.z}, {0, 0, size.z}, {0, size.y, 0});
        face({-h.x, h.y, h.z}, {size.x, 0, 0}, {0, 0, -size.z});
        face({-h.x, -h.y, -h.z}, {size.x, 0, 0}, {0, 0, size.z});
        face({-h.x, -h.y, h.z}, {size.x, 0, 0}, {0, size.y, 0});
        face({h.x, -h.y, -h.z}, {-size.x, 0, 0}, {0, size.y, 0});
        return first;
    }

    // A box standing on `base` (centre of its bottom), turned by `yaw` about the vertical.
    std::size_t standing_box(glm::vec3 base, glm::vec3 size, const Finish& finish, float yaw = 0) {
        return box(placed(base + glm::vec3(0, 0.5F * size.y, 0), yaw), size, finish);
    }

    // A surface of revolution about the y axis of `place` through the profile's (radius, height) points. Going up the profile
    // with the axis on the left, the outside is seen; a profile that goes down shows the inside.
    Patch& lathe(const glm::mat4& place, const std::vector<glm::vec2>& profile, int segments, const Finish& finish) {
        Patch& patch = office.patches.emplace_back();
        patch.columns = segments;
        patch.rows = static_cast<int>(profile.size()) - 1;
        for (std::size_t row = 0; row < profile.size(); ++row) {
            const glm::vec2 before = profile[row > 0 ? row - 1 : row], after = profile[std::min(row + 1, profile.size() - 1)];
            const glm::vec2 along = glm::normalize(after - before);
            for (int column = 0; column <= segments; ++column) {
                const float angle = 2 * pi * static_cast<float>(column) / static_cast<float>(segments);
                const glm::vec3 radial(std::cos(angle), 0, -std::sin(angle));
                patch.positions.push_back(point(place, radial * profile[row].x + glm::vec3(0, profile[row].y, 0)));
                patch.normals.push_back(glm::normalize(vector(place, radial * along.y - glm::vec3(0, along.x, 0))));
            }
        }
        apply(patch, finish);
        return patch;
    }

    // A closed cylinder standing on `base`.
    void cylinder(const glm::mat4& place, float radius, float height, const Finish& finish, int segments = 16) {
        lathe(place, {{radius, 0}, {radius, height}}, segments, finish);
        lathe(place, {{radius, height}, {1e-4F, height}}, segments, finish);
    }

    // A rod of square section from one point to another.
    void rod(glm::vec3 from, glm::vec3 to, float thickness, const Finish& finish) {
        const glm::vec3 axis = to - from;
        const glm::vec3 y = glm::normalize(axis);
        const glm::vec3 x = glm::normalize(glm::cross(std::abs(y.z) < 0.9F ? glm::vec3(0, 0, 1) : glm::vec3(1, 0, 0), y));
        const glm::mat4 place(glm::vec4(x, 0), glm::vec4(y, 0), glm::vec4(glm::cross(x, y), 0), glm::vec4((from + to) * 0.5F, 1));
        box(place, {thickness, glm::length(axis), thickness}, finish);
    }

    static glm::mat4 placed(glm::vec3 at, float yaw = 0) { return glm::rotate(glm::translate(glm::mat4(1), at), yaw, {0, 1, 0}); }
    static glm::vec3 point(const glm::mat4& m, glm::vec3 p) { return glm::vec3(m * glm::vec4(p, 1)); }
    static glm::vec3 vector(const glm::mat4& m, glm::vec3 v) { return glm::vec3(m * glm::vec4(v, 0)); }

private:
    static void apply(Patch& patch, const Finish& finish) {
        patch.material = finish.material;
        patch.tint = finish.tint;
        patch.texels_per_m = finish.texels_per_m;
    }
};

// ---- the room -------------------------------------------------------------------------------------------------------------------

// The window: an opening in the right wall, 1.6 m wide from 0.85 to 2.35 m above the floor.
constexpr float window_front = -2.25F, window_back = -0.65F, window_bottom = 0.85F, window_top = 2.35F;

struct RoomFinish {
    Finish front, left, other, floor, ceiling;
};

// Walls, floor and ceiling, each moved outwards by `out`.
void add_shell(Builder& b, const RoomFinish& finish, float out) {
    const float left = room_left - out, right = room_right + out, front = room_front - out, back = room_back + out;
    const float low = -out, high = room_height + out;
    const float width = right - left, depth = back - front, height = high - low;
    constexpr float board = 1.6F;  // m of floor that one texture covers
    // Edges that meet without sharing their vertices leave gaps by rounding: each rectangle reaches a little beyond its own.
    const auto add = [&b](glm::vec3 corner, glm::vec3 along, glm::vec3 up, const Finish& surface, glm::vec4 texture) {
        constexpr float overlap = 0.002F;
        const glm::vec3 a = glm::normalize(along) * overlap, u = glm::normalize(up) * overlap;
        b.rectangle(corner - a - u, along + 2.0F * a, up + 2.0F * u, surface, texture);
    };
    add({left, low, back}, {width, 0, 0}, {0, 0, -depth}, finish.floor, {0, depth / board, width / board, 0});
    add({left, high, front}, {width, 0, 0}, {0, 0, depth}, finish.ceiling, {0, depth, width, 0});
    add({left, low, front}, {width, 0, 0}, {0, height, 0}, finish.front, {0, height, width, 0});
    add({right, low, back}, {-width, 0, 0}, {0, height, 0}, finish.other, {0, height, width, 0});
    add({left, low, back}, {0, 0, -depth}, {0, height, 0}, finish.left, {0, height, depth, 0});
    // The right wall, about its window. Seen from inside, right is towards +z.
    const auto piece = [&](float z_back, float z_front, float y_low, float y_high) {
        const glm::vec4 texture{0, y_high - y_low, z_back - z_front, 0};
        add({right, y_low, z_front}, {0, 0, z_back - z_front}, {0, y_high - y_low, 0}, finish.other, texture);
    };
    piece(back, window_back, low, high);
    piece(window_front, front, low, high);
    piece(window_back, window_front, low, window_bottom);
    piece(window_back, window_front, window_top, high);
}

void add_room(Builder& b) {
    RoomFinish finish;
    finish.other = {Material::plaster, glm::vec3(0.78F, 0.76F, 0.72F), 24};
    finish.front = {Material::plaster, finish.other.tint, 40};
    finish.left = {Material::plaster, glm::vec3(0.42F, 0.52F, 0.55F), 24};  // muted blue-green
    finish.floor = {Material::floor, glm::vec3(1), 24};
    finish.ceiling = {Material::plaster, glm::vec3(0.86F), 16};
    add_shell(b, finish, 0);
    // Outside it may be a thousand times brighter than within: a second, dark shell sees to it that no sample slips through.
    const Finish dark{Material::plain, glm::vec3(0.05F), 0.5F};
    add_shell(b, {dark, dark, dark, dark, dark}, 0.012F);

    const float width = room_right - room_left, depth = room_back - room_front;
    const Finish white{Material::plain, glm::vec3(0.8F), 12};
    b.standing_box({0.5F * (room_left + room_right), 0, room_front + 0.008F}, {width, 0.08F, 0.016F}, white);
    b.standing_box({room_left + 0.008F, 0, 0.5F * (room_back + room_front)}, {0.016F, 0.08F, depth}, white);
    b.standing_box({room_right - 0.008F, 0, 0.5F * (room_back + room_front)}, {0.016F, 0.08F, depth}, white);
    b.standing_box({-1.4F, 0, room_back - 0.02F}, {0.9F, 2.05F, 0.04F}, {Material::wood, glm::vec3(1.3F), 12});  // door
}

void add_window(Builder& b) {
    const Finish frame{Material::plain, glm::vec3(0.82F), 24};
    const float width = window_back - window_front, height = window_top - window_bottom;
    const float middle = 0.5F * (window_front + window_back);
    constexpr float thickness = 0.06F, bar = 0.05F;
    const float x = room_right + 0.5F * thickness;
    b.standing_box({x, window_bottom, window_front + 0.5F * bar}, {thickness, height, bar}, frame);
    b.standing_box({x, window_bottom, window_back - 0.5F * bar}, {thickness, height, bar}, frame);
    b.standing_box({x, window_bottom, middle}, {thickness, height, bar}, frame);
    b.standing_box({x, window_bottom, middle}, {thickness, bar, width}, frame);
    b.standing_box({x, window_top - bar, middle}, {thickness, bar, width}, frame);
    b.standing_box({x, window_bottom + 0.68F * height, middle}, {thickness, 0.035F, width}, frame);
    b.standing_box({room_right - 0.07F, window_bottom - 0.03F, middle}, {0.18F, 0.03F, width + 0.12F}, frame);  // sill
    b.office.window = {{room_right, window_bottom, window_front}, {0, 0, width}, {0, height, 0}, {-1, 0, 0}};
}

void add_ceiling_panel(Builder& b) {
    constexpr float side = 0.6F;  // m; the usual LED panel
    const glm::vec3 corner(-0.6F, room_height - 0.012F, -1.55F);
    Patch& panel = b.rectangle(corner, {side, 0, 0}, {0, 0, side}, {Material::plain, glm::vec3(0.85F), 12});
    panel.emitter = Emitter::ceiling_panel;
    b.standing_box(corner + glm::vec3(0.5F * side, 0, -0.01F), {side + 0.04F, 0.012F, 0.02F}, {});
    b.standing_box(corner + glm::vec3(0.5F * side, 0, side + 0.01F), {side + 0.04F, 0.012F, 0.02F}, {});
    b.office.ceiling_panel = {corner, {side, 0, 0}, {0, 0, side}, {0, -1, 0}};
}

// The view outside, far enough away that heads can move. The horizon is at eye height.
void add_outdoors(Builder& b) {
    constexpr float x = 24.0F, z_front = -90.0F, z_back = 60.0F, top = 60.0F, horizon_v = 0.78F;
    const float bottom = eye_height - (top - eye_height) * (1.0F - horizon_v) / horizon_v;
    Patch& view = b.rectangle({x, bottom, z_front}, {0, 0, z_back - z_front}, {0, top - bottom, 0}, {Material::outdoors}, {0, 1, 1, 0});
    view.emitter = Emitter::outdoors;
}

// A square or disc on the sky in the direction `to` from the eye, facing it.
Patch& add_on_sky(Builder& b, glm::vec3 to, float width_radians, int segments) {
    constexpr float distance = 20.0F;  // m; nearer than the view outside, which is drawn first
    const glm::vec3 eye(0, eye_height, 0);
    const glm::vec3 side = glm::normalize(glm::cross(to, glm::vec3(0, 1, 0)));
    const glm::mat4 place(glm::vec4(side, 0), glm::vec4(-to, 0), glm::vec4(glm::cross(side, -to), 0), glm::vec4(eye + to * distance, 1));
    return b.lathe(place, {{0.5F * width_radians * distance, 0}, {1e-3F, 0}}, segments, {});
}

glm::vec3 direction(float azimuth_degrees, float elevation_degrees) {
    const float azimuth = glm::radians(azimuth_degrees), elevation = glm::radians(elevation_degrees);
    return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), -std::cos(azimuth) * std::cos(elevation)};
}

// Stars by the usual count, N(brighter than m) ~ 10^(0.45 m), down to magnitude 5.0. A star of magnitude m gives
// 2.54e-6 lx * 10^(-0.4 m) outside the atmosphere; drawn 5' wide, so that no eye image's pixel can miss it.
void add_stars(Builder& b) {
    constexpr float width = 5.0F / 60.0F * pi / 180.0F;
    constexpr float solid_angle = pi * 0.25F * width * width;
    for (std::uint32_t i = 0; i < 130; ++i) {
        const float elevation = glm::degrees(std::asin(0.20F + 0.65F * hash01(i, 1, 200)));
        const float azimuth = 18.0F + 90.0F * hash01(i, 2, 200);
        const float magnitude = std::max(5.0F + std::log10(hash01(i, 3, 200) + 1e-6F) / 0.45F, 0.0F);
        Patch& star = add_on_sky(b, direction(azimuth, elevation), width, 6);
        star.emitter = Emitter::stars;
        star.emission = 2.54e-6F * std::pow(10.0F, -0.4F * magnitude) / solid_angle;
        star.tint = glm::mix(glm::vec3(0.75F, 0.85F, 1.0F), glm::vec3(1.0F, 0.85F, 0.7F), hash01(i, 4, 200));
    }
}

void add_moon(Builder& b) {
    b.office.to_moon = direction(41.0F, 21.0F);
    add_on_sky(b, b.office.to_moon, glm::radians(0.52F), 24).emitter = Emitter::moon;
}

// ---- furniture --------------------------------------------------------------------------------------------------------------------

void add_desk(Builder& b) {
    const Finish wood{Material::wood, glm::vec3(1), 48};
    const Finish steel{Material::plain, glm::vec3(0.12F), 20};
    const glm::vec3 size(1.85F, 0.03F, 0.85F), centre(-0.05F, desk_top - 0.03F, -0.725F);
    const std::size_t first = b.standing_box(centre, size, wood);
    b.office.patches[first + 2].texels_per_m = 80;  // the top, where the lamp's shadows fall
    for (const float x : {-0.85F, 0.75F}) {
        for (const float z : {-1.08F, -0.37F}) { b.standing_box({x, 0, z}, {0.05F, desk_top - 0.03F, 0.05F}, steel); }
    }
    b.standing_box({-0.05F, 0.35F, -1.1F}, {1.6F, 0.34F, 0.015F}, {Material::plain, glm::vec3(0.55F), 20});  // modesty panel
}

void add_monitor(Builder& b) {
    const float yaw = glm::radians(-24.0F);
    const glm::vec3 foot(0.43F, desk_top, -0.95F);
    const Finish plastic{Material::plain, glm::vec3(0.03F), 40};
    b.standing_box(foot, {0.24F, 0.012F, 0.17F}, plastic, yaw);
    b.standing_box(foot + glm::vec3(0, 0.012F, 0), {0.05F, 0.25F, 0.03F}, plastic, yaw);
    const glm::vec3 back_to_front(std::sin(yaw), 0, std::cos(yaw));
    const glm::vec3 body = foot + glm::vec3(0, 0.10F, 0) + back_to_front * 0.03F;
    const std::size_t first = b.standing_box(body, {0.54F, 0.335F, 0.03F}, plastic, yaw);
    Patch& front = b.office.patches[first + 4];
    front.material = Material::screen;
    front.tint = glm::vec3(1);
    const glm::mat4 place = Builder::placed(body + glm::vec3(0, 0.012F, 0) + back_to_front * 0.0155F, yaw);
    Patch& led = b.rectangle(Builder::point(place, {0.235F, -0.002F, 0.0005F}), Builder::vector(place, {0.005F, 0, 0}),
                             Builder::vector(place, {0, 0.003F, 0}), {});
    led.emitter = Emitter::power_led;
    led.tint = glm::vec3(0.1F, 1.0F, 0.25F);
}

void add_keyboard(Builder& b) {
    const std::size_t first =
        b.standing_box({0.26F, desk_top, -0.52F}, {0.42F, 0.018F, 0.155F}, {Material::plain, glm::vec3(0.035F), 60}, glm::radians(-8.0F));
    b.office.patches[first + 2].material = Material::keyboard;
    b.office.patches[first + 2].tint = glm::vec3(1);
    b.standing_box({0.60F, desk_top, -0.50F}, {0.06F, 0.03F, 0.10F}, {Material::plain, glm::vec3(0.05F), 60}, 0.2F);  // mouse
}

void add_paper(Builder& b, glm::vec3 centre, float yaw) {
    constexpr float width = 0.21F, height = 0.297F;  // A4
    const glm::mat4 place = Builder::placed(centre, yaw);
    b.rectangle(Builder::point(place, {-0.5F * width, 0, 0.5F * height}), Builder::vector(place, {width, 0, 0}),
                Builder::vector(place, {0, 0, -height}), {Material::paper, glm::vec3(1), 90});
}

// A book lying flat, its spine towards -x turned by yaw; `row` picks the cover from the spines texture.
void add_lying_book(Builder& b, glm::vec3 base, glm::vec3 size, int row, float yaw) {
    const std::size_t first = b.standing_box(base, size, {Material::plain, glm::vec3(0.72F, 0.69F, 0.6F), 60}, yaw);
    const float top = static_cast<float>(row) / spines_per_texture, bottom = top + 1.0F / spines_per_texture;
    const glm::vec4 cover{0.3F, top + 0.02F / spines_per_texture, 0.301F, top + 0.1F / spines_per_texture};
    for (const std::size_t face : {2U, 3U, 4U}) {
        Patch& patch = b.office.patches[first + face];
        patch.material = Material::book_spines;
        patch.tint = glm::vec3(1);
        patch.texture = face == 4 ? glm::vec4(0, bottom, 1, top) : cover;
    }
}

// Upright books from `from` along +x, spines to +z.
void add_standing_books(Builder& b, glm::vec3 from, int count, std::uint32_t seed) {
    float x = from.x;
    for (int i = 0; i < count; ++i) {
        const auto index = static_cast<std::uint32_t>(i);
        const glm::vec3 size(0.028F + 0.022F * hash01(index, 1, seed), 0.20F + 0.08F * hash01(index, 2, seed),
                             0.15F + 0.03F * hash01(index, 3, seed));
        const int row = static_cast<int>((seed + static_cast<std::uint32_t>(i) * 5U) % spines_per_texture);
        const std::size_t first = b.standing_box({x + 0.5F * size.x, from.y, from.z - 0.5F * size.z}, size,
                                                 {Material::plain, glm::vec3(0.70F, 0.67F, 0.58F), 30});
        const float top = static_cast<float>(row) / spines_per_texture, bottom = top + 1.0F / spines_per_texture;
        for (const std::size_t face : {0U, 1U, 4U}) {
            Patch& patch = b.office.patches[first + face];
            patch.material = Material::book_spines;
            patch.tint = glm::vec3(1);
            patch.texture = {0.3F, top + 0.02F / spines_per_texture, 0.301F, top + 0.1F / spines_per_texture};
        }
        Patch& spine = b.office.patches[first + 4];
        spine.texture_turned = true;  // the title reads from the top down
        spine.texture = {1, bottom, 0, top};
        x += size.x + 0.002F;
    }
}

void add_shelves(Builder& b) {
    const Finish wood{Material::wood, glm::vec3(1.15F), 30};
    for (const float y : {1.32F, 1.72F}) {
        b.standing_box({-1.62F, y, room_front + 0.115F}, {1.10F, 0.022F, 0.23F}, wood);
        for (const float x : {-2.0F, -1.24F}) {
            b.standing_box({x, y - 0.08F, room_front + 0.06F}, {0.02F, 0.08F, 0.12F}, {Material::plain, glm::vec3(0.15F), 30});
        }
    }
    add_standing_books(b, {-2.12F, 1.342F, room_front + 0.215F}, 15, 3);
    add_standing_books(b, {-2.10F, 1.742F, room_front + 0.215F}, 9, 8);
    add_standing_books(b, {-1.50F, 1.742F, room_front + 0.215F}, 6, 13);
    // A cabinet against the left wall, with a globe.
    const glm::vec3 cabinet(room_left + 0.22F, 0, -1.35F);
    b.standing_box(cabinet, {0.42F, 0.85F, 1.1F}, {Material::wood, glm::vec3(0.85F), 24});
    b.standing_box(cabinet + glm::vec3(0.213F, 0.03F, 0), {0.006F, 0.79F, 0.008F}, {Material::plain, glm::vec3(0.02F), 24});
    for (const float z : {-0.06F, 0.06F}) {
        b.standing_box(cabinet + glm::vec3(0.22F, 0.42F, z), {0.015F, 0.12F, 0.012F}, {Material::plain, glm::vec3(0.5F), 24});
    }
    std::vector<glm::vec2> ball;
    for (int i = 0; i <= 10; ++i) {
        const float angle = -0.5F * pi + pi * static_cast<float>(i) / 10.0F;
        ball.push_back({std::max(0.15F * std::cos(angle), 1e-4F), 0.15F * std::sin(angle)});
    }
    b.cylinder(Builder::placed(cabinet + glm::vec3(0, 0.85F, 0)), 0.09F, 0.03F, {Material::plain, glm::vec3(0.08F), 40});
    b.lathe(Builder::placed(cabinet + glm::vec3(0, 1.03F, 0)), ball, 20, {Material::plain, srgb(0x2A6FA8), 40});
}

void add_posters(Builder& b) {
    const auto poster = [&](glm::vec2 centre, glm::vec2 size, Material material) {
        constexpr float frame = 0.018F;
        const glm::vec3 base(centre.x, centre.y - 0.5F * size.y - frame, room_front + 0.008F);
        b.standing_box(base, {size.x + 2 * frame, size.y + 2 * frame, 0.016F}, {Material::plain, glm::vec3(0.05F), 30});
        b.rectangle({centre.x - 0.5F * size.x, centre.y - 0.5F * size.y, room_front + 0.0175F}, {size.x, 0, 0}, {0, size.y, 0},
                    {material, glm::vec3(1), 40});
    };
    poster({0.02F, 1.62F}, {0.60F, 0.80F}, Material::acuity_chart);
    poster({-0.68F, 1.62F}, {0.54F, 0.72F}, Material::colour_poster);
    poster({0.72F, 1.62F}, {0.54F, 0.72F}, Material::stripes_poster);
    poster({1.17F, 1.60F}, {0.26F, 0.26F}, Material::calendar);
}

void add_chair(Builder& b) {
    const Finish fabric{Material::fabric, srgb(0x9E2B25), 30};
    const Finish steel{Material::plain, glm::vec3(0.35F), 24};
    const glm::vec3 at(-1.55F, 0, -1.45F);
    const float yaw = glm::radians(35.0F);
    const glm::mat4 place = Builder::placed(at, yaw);
    const auto put = [&](glm::vec3 base, glm::vec3 size, const Finish& finish) {
        b.standing_box(Builder::point(place, base), size, finish, yaw);
    };
    put({0, 0.43F, 0}, {0.46F, 0.06F, 0.44F}, fabric);
    put({0, 0.60F, -0.21F}, {0.44F, 0.36F, 0.04F}, fabric);
    for (const float x : {-0.2F, 0.2F}) {
        for (const float z : {-0.19F, 0.19F}) { put({x, 0, z}, {0.025F, 0.43F, 0.025F}, steel); }
        put({x, 0.49F, -0.21F}, {0.025F, 0.12F, 0.02F}, steel);
    }
}

void add_mug(Builder& b) {
    const glm::mat4 place = Builder::placed({-0.10F, desk_top, -0.80F});
    Patch& outside = b.lathe(place, {{0.038F, 0}, {0.040F, 0.005F}, {0.041F, 0.095F}}, 24, {Material::mug, glm::vec3(1), 90});
    outside.texture = {0, 1, 1, 0};
    const Finish glaze{Material::plain, glm::vec3(0.75F, 0.72F, 0.66F), 90};
    b.lathe(place, {{0.041F, 0.095F}, {0.037F, 0.095F}}, 24, glaze);
    b.lathe(place, {{0.037F, 0.095F}, {0.037F, 0.07F}}, 24, glaze);
    b.lathe(place, {{0.037F, 0.07F}, {1e-4F, 0.07F}}, 24, {Material::plain, glm::vec3(0.05F, 0.025F, 0.012F), 60});  // coffee
    for (int i = 0; i < 6; ++i) {  // the handle, of short rods on an arc
        const auto on_arc = [](int step) {
            const float angle = -0.5F * pi + pi * static_cast<float>(step) / 6.0F;
            return glm::vec3(0.040F + 0.028F * std::cos(angle), 0.05F + 0.028F * std::sin(angle), 0);
        };
        b.rod(Builder::point(place, on_arc(i)), Builder::point(place, on_arc(i + 1)), 0.009F, glaze);
    }
}

void add_apple_and_pens(Builder& b) {
    std::vector<glm::vec2> apple;
    for (int i = 0; i <= 10; ++i) {
        const float angle = -0.5F * pi + pi * static_cast<float>(i) / 10.0F;
        apple.push_back({std::max(0.038F * std::cos(angle), 1e-4F), 0.036F + 0.036F * std::sin(angle) * (1.0F - 0.12F * std::sin(angle))});
    }
    b.lathe(Builder::placed({0.12F, desk_top, -0.72F}), apple, 20, {Material::plain, srgb(0xB5161C), 90});
    b.rod({0.12F, desk_top + 0.062F, -0.72F}, {0.126F, desk_top + 0.085F, -0.722F}, 0.004F, {Material::plain, srgb(0x4A3018), 60});

    const glm::vec3 cup(0.07F, desk_top, -1.02F);
    const Finish tin{Material::plain, srgb(0x1F8A70), 80};
    b.lathe(Builder::placed(cup), {{0.036F, 0}, {0.036F, 0.10F}}, 16, tin);
    b.lathe(Builder::placed(cup), {{0.034F, 0.10F}, {0.034F, 0.02F}, {1e-4F, 0.02F}}, 16, {Material::plain, glm::vec3(0.1F), 60});
    constexpr std::array<std::uint32_t, 5> pens{0xD0312D, 0xF2C12E, 0x1B5FC1, 0x202020, 0x3FA34D};
    for (std::size_t i = 0; i < pens.size(); ++i) {
        const float angle = 1.3F * static_cast<float>(i);
        const glm::vec3 lean(std::cos(angle), 0, std::sin(angle));
        b.rod(cup + glm::vec3(0, 0.02F, 0) - lean * 0.01F, cup + glm::vec3(0, 0.17F, 0) + lean * 0.04F, 0.007F,
              {Material::plain, srgb(pens[i]), 40});
    }
}

// ---- the lamp ---------------------------------------------------------------------------------------------------------------------

// An articulated desk lamp. The bulb hangs 25° to the left, 1 m away and 0.12 m below the eye; the shade is turned towards the
// desk and a little towards the sitter, who just sees the bulb below its rim.
void add_lamp(Builder& b) {
    const Finish enamel{Material::plain, srgb(0x1E5A4B), 60};
    const Finish steel{Material::plain, glm::vec3(0.45F), 40};
    const glm::vec3 bulb(-0.42F, eye_height - 0.12F, -0.90F);
    const glm::vec3 foot(-0.74F, desk_top, -1.02F), elbow(-0.84F, desk_top + 0.42F, -1.05F);
    constexpr float bulb_radius = 0.03F;  // m; a 60 mm bulb (A60)

    // The axis of the shade, from the socket through the bulb.
    const glm::vec3 axis = glm::normalize(glm::vec3(0.16F, -0.80F, 0.55F));
    const glm::vec3 neck = bulb - axis * 0.115F;
    b.cylinder(Builder::placed(foot), 0.095F, 0.022F, enamel, 24);
    b.rod(foot + glm::vec3(0, 0.02F, 0), elbow, 0.014F, steel);
    b.rod(elbow, neck, 0.014F, steel);
    const Finish black{Material::plain, glm::vec3(0.04F), 60};
    b.lathe(Builder::placed(elbow - glm::vec3(0, 0.02F, 0)), {{0.018F, 0}, {0.018F, 0.04F}, {1e-4F, 0.04F}}, 12, black);

    const glm::vec3 x = glm::normalize(glm::cross(glm::vec3(0, 0, 1), -axis));
    const glm::mat4 place(glm::vec4(x, 0), glm::vec4(-axis, 0), glm::vec4(glm::cross(x, -axis), 0), glm::vec4(bulb, 1));
    // Local y points from the rim to the neck; heights are from the bulb's centre.
    const std::vector<glm::vec2> profile{{0.088F, -0.018F}, {0.080F, 0.020F}, {0.064F, 0.058F}, {0.042F, 0.088F}, {0.022F, 0.105F}};
    b.lathe(place, profile, 28, enamel);
    b.lathe(place, {{0.022F, 0.105F}, {0.022F, 0.15F}, {1e-4F, 0.15F}}, 16, enamel);
    std::vector<glm::vec2> inside;
    for (auto point = profile.rbegin(); point != profile.rend(); ++point) { inside.push_back({point->x - 0.0015F, point->y - 0.0005F}); }
    Patch& reflector = b.lathe(place, inside, 28, {Material::plain, glm::vec3(0.78F), 70});
    reflector.lamp_reflector = true;

    std::vector<glm::vec2> globe;
    for (int i = 0; i <= 12; ++i) {
        const float angle = -0.5F * pi + 0.82F * pi * static_cast<float>(i) / 12.0F;
        globe.push_back({std::max(bulb_radius * std::cos(angle), 1e-4F), bulb_radius * std::sin(angle)});
    }
    b.lathe(place, globe, 24, {Material::plain, glm::vec3(0.85F), 60}).emitter = Emitter::bulb;
    b.lathe(place, {{0.0145F, 0.024F}, {0.0145F, 0.10F}}, 12, {Material::plain, glm::vec3(0.5F), 60});  // socket
    b.office.bulb_centre = bulb;
    b.office.bulb_radius = bulb_radius;
}

// A pot with its plant, standing on `base`.
void add_plant(Builder& b, glm::vec3 base, std::uint32_t seed) {
    const Finish clay{Material::plain, srgb(0xA0522D), 60};
    const glm::mat4 place = Builder::placed(base);
    b.lathe(place, {{0.045F, 0}, {0.065F, 0.09F}, {0.068F, 0.09F}, {0.068F, 0.105F}, {0.060F, 0.105F}}, 24, clay);
    b.lathe(place, {{0.060F, 0.105F}, {0.058F, 0.095F}, {1e-4F, 0.095F}}, 24, {Material::plain, glm::vec3(0.04F, 0.03F, 0.02F), 60});
    for (Patch& leaf : plant_leaves(base + glm::vec3(0, 0.09F, 0), seed)) { b.office.patches.push_back(std::move(leaf)); }
}

void add_plants(Builder& b, int count) {
    constexpr float sill = room_right - 0.085F;
    const std::array<glm::vec3, most_plants> places{{{sill, window_bottom, -1.40F},
                                                     {sill, window_bottom, -0.95F},
                                                     {sill, window_bottom, -1.95F},
                                                     {room_left + 0.22F, 0.85F, -1.75F},
                                                     {0.78F, desk_top, -0.95F}}};
    for (int i = 0; i < std::clamp(count, 0, most_plants); ++i) {
        add_plant(b, places[static_cast<std::size_t>(i)], 300U + static_cast<std::uint32_t>(i));
    }
}

void lower_to_eye(Office& office) {
    const glm::vec3 down(0, -eye_height, 0);
    for (Patch& patch : office.patches) {
        for (glm::vec3& position : patch.positions) { position += down; }
    }
    office.window.corner += down;
    office.ceiling_panel.corner += down;
    office.bulb_centre += down;
}

}  // namespace

SurfacePoint evaluate(const Patch& patch, float s, float t) {
    const float x = std::clamp(s, 0.0F, 1.0F) * static_cast<float>(patch.columns);
    const float y = std::clamp(t, 0.0F, 1.0F) * static_cast<float>(patch.rows);
    const int column = std::min(static_cast<int>(x), patch.columns - 1), row = std::min(static_cast<int>(y), patch.rows - 1);
    const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
    const auto at = [&](const std::vector<glm::vec3>& values) {
        const auto index = static_cast<std::size_t>(row * (patch.columns + 1) + column);
        const std::size_t above = index + static_cast<std::size_t>(patch.columns) + 1;
        return glm::mix(glm::mix(values[index], values[index + 1], fx), glm::mix(values[above], values[above + 1], fx), fy);
    };
    return {at(patch.positions), glm::normalize(at(patch.normals))};
}

Office build_office(int plants) {
    Builder b;
    add_lamp(b);
    add_mug(b);
    add_apple_and_pens(b);
    add_paper(b, {-0.36F, desk_top + 0.002F, -0.60F}, glm::radians(12.0F));
    add_paper(b, {-0.05F, desk_top + 0.0015F, -0.52F}, glm::radians(-6.0F));
    add_lying_book(b, {-0.74F, desk_top, -0.62F}, {0.17F, 0.032F, 0.24F}, 1, glm::radians(70.0F));
    add_lying_book(b, {-0.73F, desk_top + 0.032F, -0.62F}, {0.16F, 0.026F, 0.23F}, 2, glm::radians(80.0F));
    add_lying_book(b, {-0.74F, desk_top + 0.058F, -0.63F}, {0.14F, 0.022F, 0.21F}, 9, glm::radians(62.0F));
    add_keyboard(b);
    add_monitor(b);
    add_desk(b);
    add_chair(b);
    add_shelves(b);
    add_posters(b);
    add_ceiling_panel(b);
    add_window(b);
    add_room(b);
    add_outdoors(b);
    add_moon(b);
    add_stars(b);
    add_plants(b, plants);
    lower_to_eye(b.office);
    return std::move(b.office);
}

}  // namespace samples
