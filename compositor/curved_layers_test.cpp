// labels: gpu frame
// Cylinders and spheres against rays traced in double precision, minified layers, tints and insets; both paths of a frame.
#include "compositor/testing/frame_harness.h"

#include <gtest/gtest.h>
#include <optional>

namespace entoptic::compositor {
namespace {

using namespace testing;

constexpr PictureSize panel{72, 60};

struct Screen {
    explicit Screen(bool fuse) : pool(test_device()) {
        options.panel = panel;
        options.eyes = flat_eyes();
        options.fuse = fuse;
        options.dither = false;
        options.display = {130, 0.04f};
        path = must(FramePath::create(test_device(), options));
    }
    void compose(std::vector<Layer> layers, const Pose& head = {}, const WantedPictures& wanted = {true, false, false, true, false}) {
        FrameDescription frame = description(std::move(layers), options.eyes, index++);
        frame.world_from_head = head;
        const ImageUse use = pool.use(frame.layers);
        const FrameOutcome outcome = must(path->compose(frame, use, wanted));
        EXPECT_EQ(outcome.problem, "");
    }
    SwapchainPool pool;
    FramePathOptions options;
    std::unique_ptr<FramePath> path;
    std::uint64_t index = 0;
};

// R and G hold the place in the image, 0..1: bilinear interpolation gives back exactly where it was looked at.
Texture place_texture(SwapchainPool& pool, int width = 64, int height = 32) {
    return make_float_texture(test_device(), pool, width, height, [=](int x, int y) {
        return Linear{(float(x) + 0.5f) / float(width), (float(y) + 0.5f) / float(height), 1, 1};
    });
}

Layer curved(LayerKind kind, const Texture& texture, const CurvedSurface& surface) {
    Layer layer;
    layer.kind = kind;
    layer.luminance = {1, 0, LuminanceSource::layer_extension};
    layer.views[0].image = whole(texture);
    layer.surface = surface;
    return layer;
}

glm::dvec3 direction_of_pixel(int x, int y) {
    return {(x + 0.5) / panel.width * 2 - 1, 1 - (y + 0.5) / panel.height * 2, -1};  // flat_eyes: tangents of ±1
}

// Where along the ray the last crossing of the surface lies, by bisection from far outside.
double far_crossing(glm::dvec3 origin, glm::dvec3 direction, double radius, bool cylinder) {
    const auto outside = [&](double t) {
        glm::dvec3 at = origin + t * direction;
        if (cylinder) at.y = 0;
        return glm::length(at) > radius;
    };
    double low = 0, high = 1e4;
    if (outside(low) || !outside(high)) return -1;  // these tests stand inside
    for (int i = 0; i < 80; ++i) (outside((low + high) / 2) ? high : low) = (low + high) / 2;
    return low;
}

// Place in the image, 0..1 each way; nothing where the surface ends.
std::optional<glm::dvec2> expected_place(const Layer& layer, glm::dvec3 eye, glm::dvec3 direction) {
    const CurvedSurface& s = layer.surface;
    const bool cylinder = layer.kind == LayerKind::cylinder, infinite = !(s.radius_m > 0) || std::isinf(s.radius_m);
    const glm::dquat turn = glm::conjugate(glm::dquat(s.space_from_centre.orientation));
    const double radius = infinite ? 1 : double(s.radius_m);
    const glm::dvec3 origin = infinite ? glm::dvec3(0) : turn * (eye - glm::dvec3(s.space_from_centre.position));
    const glm::dvec3 ray = turn * direction;
    const glm::dvec3 at = origin + far_crossing(origin, ray, radius, cylinder) * ray;
    const double u = (std::atan2(at.x, -at.z) - double(s.longitude_centre)) / double(s.longitude_extent) + 0.5;
    const double v = cylinder ? 0.5 - at.y / double(s.height_m)
                              : (double(s.latitude_top) - std::asin(at.y / radius)) / (double(s.latitude_top) - double(s.latitude_bottom));
    if (u < 0 || u > 1 || v < 0 || v > 1) return std::nullopt;
    return glm::dvec2(u, v);
}

class Curved : public ::testing::TestWithParam<std::tuple<LayerKind, float>> {};

TEST_P(Curved, MeetsTheRaysOfAnIndependentTrace) {
    const auto [kind, radius] = GetParam();
    Screen screen(false);
    const Texture texture = place_texture(screen.pool);
    CurvedSurface surface;
    surface.space_from_centre = {glm::angleAxis(0.4f, glm::normalize(glm::vec3(0.2f, 1, 0.1f))), {0.1f, -0.05f, -0.2f}};
    surface.radius_m = radius;
    surface.longitude_centre = 0.15f;
    surface.longitude_extent = 1.2f;
    surface.latitude_top = 0.5f;
    surface.latitude_bottom = -0.3f;
    surface.height_m = 0.9f * (radius > 0 && std::isfinite(radius) ? radius : 1);
    const Layer layer = curved(kind, texture, surface);
    const Pose head{glm::angleAxis(0.1f, glm::vec3(1, 0, 0)), {0.2f, 0.1f, 0.3f}};
    screen.compose({layer}, head);
    int seen = 0, edges = 0;
    for (int eye = 0; eye < 2; ++eye) {
        const ImageF picture = screen.path->warp_picture(eye);
        const glm::dvec3 at = glm::dvec3(head.position) + glm::dquat(head.orientation) * glm::dvec3(eye == 0 ? -0.0315 : 0.0315, 0, 0);
        for (int y = 0; y < int(panel.height); ++y) {
            for (int x = 0; x < int(panel.width); ++x) {
                const auto place = expected_place(layer, at, glm::dquat(head.orientation) * direction_of_pixel(x, y));
                const bool shown = picture.at(x, y, 2) > 0;
                if (place.has_value() != shown) {
                    ++edges;  // within rounding of the surface's end
                    continue;
                }
                if (!place) continue;
                ++seen;
                // Half a texel from the image's rim there is no neighbour to interpolate to.
                EXPECT_NEAR(picture.at(x, y, 0), glm::clamp(place->x, 0.5 / 64, 1 - 0.5 / 64), 2e-4) << x << "," << y;
                EXPECT_NEAR(picture.at(x, y, 1), glm::clamp(place->y, 0.5 / 32, 1 - 0.5 / 32), 2e-4) << x << "," << y;
            }
        }
    }
    EXPECT_GT(seen, 500);
    EXPECT_LE(edges, 4);
}

INSTANTIATE_TEST_SUITE_P(Surfaces, Curved,
                         ::testing::Combine(::testing::Values(LayerKind::cylinder, LayerKind::equirect),
                                            ::testing::Values(0.0f, 1.5f, std::numeric_limits<float>::infinity())));

// The same picture stored from its lowest row on, in a part of a larger image, is shown the same way up.
TEST(BottomUp, IsThePictureOfTheTurnedImage) {
    Screen screen(false);
    const int width = 64, height = 48;
    const auto place = [](int x, int y) { return Linear{(float(x) + 0.5f) / 64, (float(y) + 0.5f) / 48, 1, 1}; };
    const Texture down = make_float_texture(test_device(), screen.pool, width, height, place);
    const Texture up =
        make_float_texture(test_device(), screen.pool, width, height, [&](int x, int y) { return place(x, height - 1 - y); });
    CurvedSurface surface;
    surface.radius_m = 1.5f;
    surface.longitude_extent = 1.2f;
    surface.latitude_top = 0.5f;
    surface.latitude_bottom = -0.3f;
    surface.height_m = 1.4f;
    std::vector<Layer> layers{projection_layer(down, screen.options.eyes), quad_layer(down, {0.1f, 0.05f, -1}, 1.1f, 0.9f),
                              curved(LayerKind::cylinder, down, surface), curved(LayerKind::equirect, down, surface)};
    for (Layer& layer : layers) {
        layer.luminance = {1, 0, LuminanceSource::layer_extension};
        Layer turned = layer;
        for (std::size_t eye = 0; eye < 2; ++eye) {
            layer.views[eye].image = {down.swapchain, 0, 0, 6, 4, 50, 30};
            turned.views[eye].image = {up.swapchain, 0, 0, 6, height - 4 - 30, 50, 30, true};
        }
        screen.compose({layer});
        const ImageF expected = screen.path->warp_picture(0);
        screen.compose({turned});
        const ImageF found = screen.path->warp_picture(0);
        int seen = 0;
        for (int y = 0; y < expected.height; ++y) {
            for (int x = 0; x < expected.width; ++x) {
                seen += expected.at(x, y, 2) > 0 ? 1 : 0;
                // A 256th of a texel, to which places are rounded.
                for (int c = 0; c < 3; ++c) ASSERT_NEAR(found.at(x, y, c), expected.at(x, y, c), 1.0 / 256 / 48 + 1e-6) << int(layer.kind);
            }
        }
        EXPECT_GT(seen, 500) << int(layer.kind);
    }
}

// A board of single black and white texels, sixteen a pixel: the mean of its light, not one texel of it.
TEST(Minified, ABoardIsGrey) {
    for (const bool fuse : {false, true}) {
        Screen screen(fuse);
        const Texture board = make_texture(test_device(), screen.pool, 1152, 960, [](int x, int y) {
            const auto code = std::uint8_t((x + y) % 2 * 255);
            return Codes{code, code, code, 255};
        });
        screen.compose({projection_layer(board, screen.options.eyes)}, {}, {!fuse, false, false, true, false});
        const Image8 picture = screen.path->panel_picture(0);
        for (int y = 0; y < picture.height; ++y)
            for (int x = 0; x < picture.width; ++x)
                ASSERT_NEAR(picture.at(x, y, 1), 188, 1) << "half the light is code 188; " << x << "," << y;
    }
}

TEST(Tint, ScaleAndBiasComeBeforeBlending) {
    Screen screen(false);
    const auto flat = [&](Linear value) { return make_float_texture(test_device(), screen.pool, 4, 4, [=](int, int) { return value; }); };
    Layer below = projection_layer(flat({0.5f, 0.5f, 0.5f, 1}), screen.options.eyes);
    below.luminance = {10, 0, LuminanceSource::layer_extension};
    Layer above = projection_layer(flat({0.4f, 0.2f, 0.1f, 0.5f}), screen.options.eyes);
    above.luminance = {10, 0, LuminanceSource::layer_extension};
    above.blend_texture_source_alpha = true;
    above.tint.scale = {2, 1, 1, 0.5f};
    above.tint.bias = {0, 0.1f, 0, 0.25f};
    screen.compose({below, above});
    const ImageF picture = screen.path->warp_picture(0);
    EXPECT_NEAR(picture.at(30, 30, 0), 10 * (0.4 * 2) + 5 * 0.5, 1e-4);
    EXPECT_NEAR(picture.at(30, 30, 1), 10 * (0.2 + 0.1) + 5 * 0.5, 1e-4);
    EXPECT_NEAR(picture.at(30, 30, 2), 10 * 0.1 + 5 * 0.5, 1e-4);
}

// Inside its field an inset takes the place of the outer view, over what was beneath both.
TEST(Inset, ReplacesTheViewBeforeIt) {
    Screen screen(false);
    const auto flat = [&](Linear value) { return make_float_texture(test_device(), screen.pool, 4, 4, [=](int, int) { return value; }); };
    const auto layer = [&](const Texture& texture) {
        Layer made = projection_layer(texture, screen.options.eyes);
        made.luminance = {1, 0, LuminanceSource::layer_extension};
        return made;
    };
    Layer outer = layer(flat({0.25f, 0.25f, 0.25f, 0.5f})), inset = layer(flat({0.1f, 0.1f, 0.1f, 0.75f}));
    outer.blend_texture_source_alpha = inset.blend_texture_source_alpha = true;
    inset.replaces_previous = true;
    for (entoptic::LayerView& view : inset.views) view.fov = {-0.3f, 0.3f, 0.3f, -0.3f};
    screen.compose({layer(flat({1, 1, 1, 1})), outer, inset});
    const ImageF picture = screen.path->warp_picture(0);
    EXPECT_NEAR(picture.at(36, 30, 0), 0.1 + 0.25 * 1, 1e-5);
    EXPECT_NEAR(picture.at(4, 30, 0), 0.25 + 0.5 * 1, 1e-5);
}

}  // namespace
}  // namespace entoptic::compositor
