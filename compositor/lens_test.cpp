// labels: unit
// Geometry of the lens in double: published test vectors, inverses, and the compositor's own shortcuts.
#include "compositor/eye_view.h"
#include "compositor/layer_views.h"
#include "compositor/lens_math.glsl"
#include "compositor/testing/frame_harness.h"

#include <gtest/gtest.h>

namespace entoptic::compositor {
namespace {

// facts/devices.md 1.4: (u,v) on the panel → (U,V) on the render target, for red, green, blue.
TEST(Lens, ViveProTestVectors) {
    const EyeGeometry g = panel_geometry(testing::vive_pro_eyes()[0], 1440, 1600);
    struct Vector {
        glm::dvec2 uv, red, green, blue;
    };
    const Vector vectors[] = {
        {{0.5, 0.5}, {0.499974, 0.499999}, {0.499968, 0.499999}, {0.499962, 0.499999}},
        {{0.25, 0.5}, {0.332235, 0.499968}, {0.330226, 0.499956}, {0.328129, 0.499942}},
        {{0.5, 0.2}, {0.497705, 0.295389}, {0.497298, 0.292425}, {0.496865, 0.289308}},
        {{0.9, 0.8}, {0.810697, 0.737993}, {0.823477, 0.748623}, {0.837944, 0.760665}},
    };
    for (const Vector& v : vectors) {
        const glm::dvec2 expected[] = {v.red, v.green, v.blue};
        for (int c = 0; c < 3; ++c) {
            const glm::dvec2 tangents = geometry::lens_tangents(g, g.channels[c], v.uv * glm::dvec2(1440, 1600));
            // X = tan_x fx - cx etc. (interfaces/headset.h), then U = 0.5 + X * 0.5/(1+grow).
            const double x = tangents.x * double(g.focal.x) - double(g.principal_point.x),
                         y = double(g.principal_point.y) - tangents.y * double(g.focal.y);
            EXPECT_NEAR(0.5 + x * 0.5 / 1.6, expected[c].x, 2e-6);
            EXPECT_NEAR(0.5 + y * 0.5 / 1.6, expected[c].y, 2e-6);
        }
    }
}

TEST(Lens, PixelIsTheInverseOfTangents) {
    for (const EyeOptics& optics : testing::vive_pro_eyes()) {
        const EyeGeometry g = panel_geometry(optics, 1440, 1600);
        double worst = 0;
        for (double y = 0.5; y < 1600; y += 13)
            for (double x = 0.5; x < 1440; x += 11) {
                if (!geometry::lens_visible(g, {x, y})) continue;
                for (int c = 0; c < 3; ++c) {
                    const glm::dvec2 back = geometry::lens_pixel(g, g.channels[c], geometry::lens_tangents(g, g.channels[c], {x, y}));
                    worst = std::max(worst, glm::length(back - glm::dvec2(x, y)));
                }
            }
        EXPECT_LT(worst, 1e-3);
    }
}

TEST(Lens, ThreeStepsFindGreensPixelOfAColour) {
    for (const EyeOptics& optics : testing::vive_pro_eyes()) {
        const EyeGeometry g = panel_geometry(optics, 1440, 1600);
        double worst = 0;
        for (double y = 0.5; y < 1600; y += 13)
            for (double x = 0.5; x < 1440; x += 11) {
                if (!geometry::lens_visible(g, {x, y})) continue;
                for (const int c : {0, 1, 2}) {
                    const glm::dvec2 quick = lens_math::green_pixel_of_colour(g, g.channels[c], {x, y});
                    const glm::dvec2 direct =
                        geometry::lens_tangents(g, g.channels[1], quick) - geometry::lens_tangents(g, g.channels[c], {x, y});
                    worst = std::max(worst, glm::length(direct));  // tangents
                }
            }
        EXPECT_LT(worst, 1e-6);  // a pixel is about 1.4e-3
    }
}

TEST(Lens, TheEyeImageReachesBeyondThePanelsRim) {
    const EyeOptics optics = testing::vive_pro_eyes()[0];
    const EyeGeometry panel = panel_geometry(optics, 720, 800), eye = eye_geometry(optics, 720, 800);
    EXPECT_GT(eye.r2_cutoff.y, panel.r2_cutoff.y);
    EXPECT_LT(eye.r2_cutoff.y, 1.1f * panel.r2_cutoff.y);
    for (double y = 0.5; y < 800; ++y)
        for (double x = 0.5; x < 720; ++x) {
            for (const int c : {0, 2}) {
                if (!geometry::lens_shows(panel, c, {x, y})) continue;
                const glm::dvec2 from = lens_math::green_pixel_of_colour(panel, panel.channels[c], {x, y});
                if (from.x < 0 || from.y < 0 || from.x > 720 || from.y > 800) continue;
                ASSERT_TRUE(geometry::lens_visible(eye, from)) << x << "," << y;
            }
        }
}

TEST(Lens, AllColoursEndAtOneDirection) {
    const EyeGeometry g = panel_geometry(testing::vive_pro_eyes()[0], 1440, 1600);
    double end[3];
    for (int c = 0; c < 3; ++c) {
        const double r2 = double(g.r2_cutoff[c]);
        end[c] = std::sqrt(r2) / geometry::lens_denominator(g.channels[c], r2);
    }
    EXPECT_NEAR(end[0], end[1], 1e-5);
    EXPECT_NEAR(end[2], end[1], 1e-5);
    EXPECT_NEAR(double(g.r2_cutoff[0]), 1.11, 1e-5) << "red bends least and gives the end";
}

TEST(Lens, TilesCoverEveryVisiblePixel) {
    for (const EyeOptics& optics : testing::vive_pro_eyes()) {
        const EyeGeometry g = panel_geometry(optics, 717, 803);
        const TileLists lists = tile_lists(g, 32, 8);
        EXPECT_EQ(lists.shown.size() + lists.hidden.size(), 23u * 101u);
        EXPECT_GT(lists.hidden.size(), 200u);
        for (const std::uint32_t tile : lists.hidden)
            for (std::uint32_t y = (tile >> 16) * 8; y < std::min((tile >> 16) * 8 + 8, 803u); ++y)
                for (std::uint32_t x = (tile & 0xffff) * 32; x < std::min((tile & 0xffff) * 32 + 32, 717u); ++x)
                    ASSERT_FALSE(geometry::lens_visible(g, {x + 0.5, y + 0.5}));
    }
}

// Texel of a layer at a panel pixel, by the shader's formula in double.
glm::dvec2 texel_at(const LayerView& view, const EyeGeometry& g, int colour, glm::dvec2 px) {
    const glm::dvec2 p = geometry::lens_position(g, g.channels[colour], px);
    const glm::dvec3 at(p, geometry::lens_denominator(g.channels[colour], glm::dot(p, p)));
    const auto row = [&](int i) { return glm::dot(glm::dvec3(view.texel_from_lens[3 * colour + i]), at); };
    return {row(0) / row(2), row(1) / row(2)};
}

TEST(LayerView, TheMatrixIsTheWholeGeometry) {
    const auto eyes = testing::vive_pro_eyes();
    const EyeGeometry g = panel_geometry(eyes[0], 1440, 1600);
    Layer layer;
    layer.views[0].fov = {-0.9f, 0.8f, 0.85f, -0.95f};
    layer.views[0].space_from_view = {glm::angleAxis(0.1f, glm::normalize(glm::vec3(1, 1, 0))), {0, 0, 0}};
    layer.views[0].image = {1, 0, 0, 100, 50, 1000, 900};
    layer.anchor = {glm::angleAxis(0.3f, glm::vec3(0, 1, 0)), {1, 2, 3}};
    const EyePlace place{{glm::angleAxis(0.35f, glm::vec3(0, 1, 0)), {1, 1.5f, 0}}, eyes[0].head_from_eye};
    const auto view = layer_view(layer, 0, place, g, false);
    ASSERT_TRUE(view);
    for (const glm::dvec2 px : {glm::dvec2(700, 800), glm::dvec2(300, 500), glm::dvec2(1200, 1100)})
        for (int c = 0; c < 3; ++c) {
            const glm::dvec2 t = geometry::lens_tangents(g, g.channels[c], px);
            const glm::dvec3 world =
                glm::dquat(place.world_from_head.orientation) * glm::dquat(place.head_from_eye.orientation) * glm::dvec3(t, -1);
            const glm::dvec3 d =
                glm::inverse(glm::dquat(layer.anchor.orientation) * glm::dquat(layer.views[0].space_from_view.orientation)) * world;
            const double left = std::tan(-0.9), right = std::tan(0.8), up = std::tan(0.85), down = std::tan(-0.95);
            const glm::dvec2 expected(100 + (d.x / -d.z - left) / (right - left) * 1000, 50 + (up - d.y / -d.z) / (up - down) * 900);
            EXPECT_LT(glm::length(texel_at(*view, g, c, px) - expected), 1e-3);
        }
}

TEST(LayerView, WhatCannotBeSeenIsNotThere) {
    const auto eyes = testing::vive_pro_eyes();
    const EyeGeometry g = panel_geometry(eyes[0], 100, 100);
    Layer layer;
    layer.views[0].fov = {-0.5f, 0.5f, 0.5f, -0.5f};
    layer.views[0].image = {1, 0, 0, 0, 0, 10, 10};
    EXPECT_TRUE(layer_view(layer, 0, {}, g, false));
    layer.visibility = EyeVisibility::right;
    EXPECT_FALSE(layer_view(layer, 0, {}, g, false));
    layer.visibility = EyeVisibility::both;
    layer.views[0].fov = {0.5f, 0.5f, 0.5f, -0.5f};
    EXPECT_FALSE(layer_view(layer, 0, {}, g, false));
    layer.kind = LayerKind::quad;
    EXPECT_FALSE(layer_view(layer, 0, {}, g, false));  // no extent
    layer.quad_width_m = layer.quad_height_m = 1;
    layer.space_from_quad.position = {0, 0, -1};
    EXPECT_TRUE(layer_view(layer, 0, {}, g, false));
    layer.views[0].image.width = 0;
    EXPECT_FALSE(layer_view(layer, 0, {}, g, false));
}

}  // namespace
}  // namespace entoptic::compositor
