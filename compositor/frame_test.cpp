// labels: gpu frame
// Whole frames: layers in, panel codes and pictures out.
#include "compositor/eye_view.h"
#include "compositor/lens_math.glsl"
#include "compositor/testing/frame_harness.h"
#include "gpu/testing/validation_guard.h"
#include "shaders/colour_math.glsl"

#include <gtest/gtest.h>
#include <limits>

namespace entoptic::compositor {
namespace {

using namespace testing;

const auto* const guard = ::testing::AddGlobalTestEnvironment(new gpu::testing::ValidationGuard(&test_device));

constexpr perception::DisplayRange vive_range{130, 0.04f};

// A path and its images.
struct Screen {
    explicit Screen(PictureSize panel, const std::array<EyeOptics, 2>& eyes, bool fuse = true, bool dither = true, double eye_scale = 1)
        : pool(test_device()) {
        options.panel = panel;
        options.eyes = eyes;
        options.fuse = fuse;
        options.dither = dither;
        options.eye_scale = eye_scale;
        options.display = vive_range;
        path = must(FramePath::create(test_device(), options));
    }
    FrameOutcome compose(FrameDescription frame, const WantedPictures& wanted = {false, false, false, true, false}) {
        const ImageUse use = pool.use(frame.layers);
        return must(path->compose(frame, use, wanted));
    }
    FrameOutcome compose(std::vector<Layer> layers, const WantedPictures& wanted = {false, false, false, true, false}) {
        return compose(description(std::move(layers), options.eyes, index++), wanted);
    }
    SwapchainPool pool;
    FramePathOptions options;
    std::unique_ptr<FramePath> path;
    std::uint64_t index = 0;
};

constexpr WantedPictures stages{true, true, true, true, false};

// All codes appear, next to very different ones.
Codes all_codes(int x, int y) {
    return {std::uint8_t(x + 16 * y), std::uint8_t(255 - (x * 37 + y * 11) % 256), std::uint8_t((x ^ y) * 5), 255};
}

void expect_codes(const Image8& picture, const std::function<Codes(int, int)>& expected) {
    int wrong = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            for (int c = 0; c < 3; ++c)
                if (picture.at(x, y, c) != expected(x, y)[std::size_t(c)] && ++wrong <= 5)
                    ADD_FAILURE() << "pixel " << x << "," << y << " channel " << c << " is " << int(picture.at(x, y, c)) << ", not "
                                  << int(expected(x, y)[std::size_t(c)]);
    EXPECT_EQ(wrong, 0);
}

TEST(Frame, SdrCodesComeBackExactly) {
    for (const bool fuse : {true, false}) {
        for (const VkFormat format : {VK_FORMAT_R8G8B8A8_SRGB, VK_FORMAT_B8G8R8A8_SRGB}) {
            SCOPED_TRACE(fuse ? "fused" : "stages");
            Screen screen({99, 67}, flat_eyes(), fuse);
            const Texture texture = make_texture(
                test_device(), screen.pool, 99, 67,
                [&](int x, int y) {
                    const Codes c = all_codes(x, y);
                    return format == VK_FORMAT_R8G8B8A8_SRGB ? c : Codes{c[2], c[1], c[0], c[3]};
                },
                format);
            for (int frame = 0; frame < 3; ++frame) {  // with different dither
                const FrameOutcome outcome = screen.compose({projection_layer(texture, screen.options.eyes)});
                EXPECT_EQ(outcome.fused, fuse);
                EXPECT_EQ(outcome.problem, "");
                for (int eye = 0; eye < 2; ++eye) expect_codes(screen.path->panel_picture(eye), all_codes);
            }
        }
    }
}

TEST(Frame, ZeroLayersAreBlack) {
    for (const bool fuse : {true, false}) {
        Screen screen({64, 48}, vive_pro_eyes(), fuse);
        screen.compose(std::vector<Layer>{});
        for (int eye = 0; eye < 2; ++eye) expect_codes(screen.path->panel_picture(eye), [](int, int) { return Codes{0, 0, 0, 0}; });
    }
}

// Centre of the pixels of a picture above a code in one channel, weighted by linear light.
glm::dvec2 centroid(const Image8& picture, int channel, int above = 0) {
    glm::dvec2 sum(0);
    double weight = 0;
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const double light = picture.at(x, y, channel) > above ? colour::srgb_decode(picture.at(x, y, channel) / 255.0) : 0;
            sum += light * glm::dvec2(x + 0.5, y + 0.5);
            weight += light;
        }
    return sum / weight;
}

TEST(Frame, TurningTheHeadMovesTheProjectionLayer) {
    for (const bool fuse : {true, false}) {
        Screen screen({160, 120}, flat_eyes(), fuse);
        // A dot straight ahead of where the picture was drawn.
        const Texture texture = make_texture(test_device(), screen.pool, 160, 120, [](int x, int y) {
            return std::abs(x - 79.5) < 3 && std::abs(y - 59.5) < 3 ? Codes{255, 255, 255, 255} : Codes{0, 0, 0, 255};
        });
        FrameDescription frame = description({projection_layer(texture, screen.options.eyes)}, screen.options.eyes);
        const double yaw = 0.2, pitch = -0.1;  // to the left, and down
        frame.world_from_head.orientation =
            glm::angleAxis(float(yaw), glm::vec3(0, 1, 0)) * glm::angleAxis(float(pitch), glm::vec3(1, 0, 0));
        screen.compose(frame);
        const glm::dvec3 seen = glm::inverse(glm::dquat(frame.world_from_head.orientation)) * glm::dvec3(0, 0, -1);
        const double x = (seen.x / -seen.z * 0.5 + 0.5) * 160, y = (0.5 - seen.y / -seen.z * 0.5) * 120;
        for (int eye = 0; eye < 2; ++eye) {
            const glm::dvec2 at = centroid(screen.path->panel_picture(eye), 1);
            EXPECT_NEAR(at.x, x, 0.2);
            EXPECT_NEAR(at.y, y, 0.2);
        }
    }
}

TEST(Frame, HeadLockedLayersStayWithTheHead) {
    Screen screen({80, 80}, flat_eyes());
    const Texture texture = make_texture(test_device(), screen.pool, 80, 80, all_codes);
    Layer layer = projection_layer(texture, screen.options.eyes);
    layer.head_locked = true;
    FrameDescription frame = description({layer}, screen.options.eyes);
    frame.world_from_head = {glm::angleAxis(0.7f, glm::normalize(glm::vec3(1, 2, 3))), {1, 2, 3}};
    screen.compose(frame);
    for (int eye = 0; eye < 2; ++eye) expect_codes(screen.path->panel_picture(eye), all_codes);
}

TEST(Frame, AQuadCoversThePixelsGeometrySays) {
    for (const bool fuse : {true, false}) {
        Screen screen({200, 200}, flat_eyes(), fuse, false);
        const Texture white = make_texture(test_device(), screen.pool, 8, 8, [](int, int) { return Codes{255, 255, 255, 255}; });
        const glm::vec3 centre(0.1f, -0.05f, -0.6f);
        const double width = 0.3, height = 0.2;
        screen.compose({quad_layer(white, centre, float(width), float(height))});
        for (int eye = 0; eye < 2; ++eye) {
            const Image8 picture = screen.path->panel_picture(eye);
            const double eye_x = double(screen.options.eyes[std::size_t(eye)].head_from_eye.position.x);
            int wrong = 0;
            for (int y = 0; y < 200; ++y)
                for (int x = 0; x < 200; ++x) {
                    const double hit_x = eye_x + ((x + 0.5) / 100 - 1) * 0.6, hit_y = (1 - (y + 0.5) / 100) * 0.6;
                    const bool inside = std::abs(hit_x - double(centre.x)) <= width / 2 && std::abs(hit_y - double(centre.y)) <= height / 2;
                    wrong += picture.at(x, y, 1) != (inside ? 255 : 0);
                }
            EXPECT_EQ(wrong, 0);
        }
    }
}

TEST(Frame, AQuadIsSeenFromItsFrontOnly) {
    Screen screen({40, 40}, flat_eyes());
    const Texture white = make_texture(test_device(), screen.pool, 8, 8, [](int, int) { return Codes{255, 255, 255, 255}; });
    Layer quad = quad_layer(white, {0, 0, -1}, 0.5f, 0.5f);
    quad.space_from_quad.orientation = glm::angleAxis(3.14159265f, glm::vec3(0, 1, 0));
    screen.compose({quad});
    EXPECT_EQ(screen.path->panel_picture(0).at(20, 20, 1), 0);
    quad.space_from_quad.orientation = glm::angleAxis(0.5f, glm::vec3(0, 1, 0));
    screen.compose({quad});
    EXPECT_EQ(screen.path->panel_picture(0).at(20, 20, 1), 255);
    quad.space_from_quad.position.z = 1;  // behind the eye
    screen.compose({quad});
    EXPECT_EQ(screen.path->panel_picture(0).at(20, 20, 1), 0);
}

TEST(Frame, EyeVisibilityIsRespected) {
    Screen screen({40, 40}, flat_eyes());
    const Texture white = make_texture(test_device(), screen.pool, 8, 8, [](int, int) { return Codes{255, 255, 255, 255}; });
    Layer quad = quad_layer(white, {0, 0, -1}, 1, 1);
    for (const EyeVisibility visibility : {EyeVisibility::left, EyeVisibility::right}) {
        quad.visibility = visibility;
        screen.compose({quad});
        EXPECT_EQ(screen.path->panel_picture(0).at(20, 20, 1), visibility == EyeVisibility::left ? 255 : 0);
        EXPECT_EQ(screen.path->panel_picture(1).at(20, 20, 1), visibility == EyeVisibility::right ? 255 : 0);
    }
}

// Independent reference of blending at one pixel, in cd/m².
struct Sample {
    glm::dvec3 linear;
    double alpha;
};
glm::dvec3 blended(const std::vector<std::pair<Layer, Sample>>& layers) {
    glm::dvec3 light(0);
    for (const auto& [layer, sample] : layers) {
        const double scale = double(layer.luminance.cd_per_unit), offset = double(layer.luminance.offset_cd);
        if (!layer.blend_texture_source_alpha)
            light = sample.linear * scale + offset;
        else {
            const glm::dvec3 premultiplied = layer.unpremultiplied_alpha ? sample.linear * sample.alpha : sample.linear;
            light = premultiplied * scale + offset * sample.alpha + (1 - sample.alpha) * light;
        }
    }
    return light;
}

TEST(Frame, BlendFlagsAgreeWithTheReference) {
    constexpr int size = 32;
    Screen screen({size, size}, flat_eyes(), false);
    const auto below = [](int x, int y) { return Linear{0.1f + 0.02f * float(x), 0.5f, 0.9f - 0.02f * float(y), 1}; };
    const auto above = [](int x, int y) { return Linear{0.02f * float(y), 0.7f, 0.03f * float(x), float(x) / (size - 1)}; };
    const Texture a = make_float_texture(test_device(), screen.pool, size, size, below),
                  b = make_float_texture(test_device(), screen.pool, size, size, above);
    for (const bool blend : {false, true})
        for (const bool unpremultiplied : {false, true}) {
            Layer bottom = projection_layer(a, screen.options.eyes), top = projection_layer(b, screen.options.eyes);
            bottom.luminance = {1000, 0.5f, LuminanceSource::layer_extension};
            top.luminance = {200, 3, LuminanceSource::layer_extension};
            top.blend_texture_source_alpha = blend;
            top.unpremultiplied_alpha = unpremultiplied;
            screen.compose({bottom, top}, stages);
            const ImageF picture = screen.path->warp_picture(1);
            double worst = 0;
            for (int y = 0; y < size; ++y)
                for (int x = 0; x < size; ++x) {
                    const auto sample = [](const Linear& v) { return Sample{{double(v[0]), double(v[1]), double(v[2])}, double(v[3])}; };
                    const glm::dvec3 expected = blended({{bottom, sample(below(x, y))}, {top, sample(above(x, y))}});
                    for (int c = 0; c < 3; ++c)
                        worst = std::max(worst, std::abs(double(picture.at(x, y, c)) - expected[c]) / (expected[c] + 1e-3));
                }
            EXPECT_LT(worst, 2e-6) << "blend " << blend << " unpremultiplied " << unpremultiplied;
        }
}

TEST(Frame, SubImagesAndArraySlicesStayWithinTheirBorders) {
    constexpr int slices = 3, width = 64, height = 48;
    for (const bool fuse : {true, false}) {
        Screen screen({40, 20}, flat_eyes(), fuse);
        const auto texel = [](int x, int y, int slice) {
            return Codes{std::uint8_t(x * 4), std::uint8_t(y * 5), std::uint8_t(slice * 100), 255};
        };
        std::vector<Codes> texels;
        for (int slice = 0; slice < slices; ++slice)
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) texels.push_back(texel(x, y, slice));
        const Texture texture{make_swapchain(screen.pool, VK_FORMAT_R8G8B8A8_SRGB, width, height, slices), width, height};
        write_image(test_device(), screen.pool, texture.swapchain, 0, width, height, slices, std::as_bytes(std::span(texels)));
        Layer layer = projection_layer(texture, screen.options.eyes);
        layer.views[0].image = {texture.swapchain, 0, 2, 11, 7, 40, 20};
        layer.views[1].image = {texture.swapchain, 0, 1, 3, 9, 40, 20};
        screen.compose({layer});
        expect_codes(screen.path->panel_picture(0), [&](int x, int y) { return texel(x + 11, y + 7, 2); });
        expect_codes(screen.path->panel_picture(1), [&](int x, int y) { return texel(x + 3, y + 9, 1); });
        // Magnified 4 times: nothing of the texels around the rectangle may show.
        layer.views[0].image = layer.views[1].image = {texture.swapchain, 0, 1, 20, 20, 10, 5};
        screen.compose({layer});
        const Image8 large = screen.path->panel_picture(0);
        EXPECT_EQ(large.at(0, 0, 0), 80);
        EXPECT_EQ(large.at(39, 19, 0), 29 * 4);
        EXPECT_EQ(large.at(0, 19, 1), 24 * 5);
    }
}

TEST(Frame, ValuesThatAreNotFiniteAreCleanedAndCounted) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    for (const bool fuse : {true, false}) {
        Screen screen({32, 16}, flat_eyes(), fuse, false);
        const Texture texture = make_float_texture(test_device(), screen.pool, 32, 16, [&](int x, int y) {
            if (x == 4 && y == 4) return Linear{nan, 1, 1, 1};
            if (x == 9 && y == 4) return Linear{inf, 0.5f, 0.5f, 1};
            if (x == 14 && y == 4) return Linear{-1, 0.5f, 0.5f, 1};
            if (x == 20 && y == 8) return Linear{0.5f, 0.5f, 0.5f, nan};
            return Linear{0.5f, 0.5f, 0.5f, 1};
        });
        Layer layer = projection_layer(texture, screen.options.eyes);
        const FrameOutcome outcome = screen.compose({layer}, fuse ? WantedPictures{false, false, false, true, false} : stages);
        EXPECT_EQ(outcome.views[0].cleaned, 3u);
        const int grey = screen.path->panel_picture(0).at(0, 0, 0);
        const Image8 picture = screen.path->panel_picture(0);
        EXPECT_EQ(picture.at(4, 4, 0), 0);
        EXPECT_EQ(picture.at(4, 4, 1), 255);
        EXPECT_EQ(picture.at(9, 4, 0), 255);
        EXPECT_NEAR(picture.at(9, 4, 1), grey, 1);
        EXPECT_EQ(picture.at(14, 4, 0), 0);
        for (const int x : {3, 5, 8, 10, 13, 15}) EXPECT_NEAR(picture.at(x, 4, 0), grey, 1) << x;  // neighbours are well
        // A layer that is not finite must not shine through a blend with alpha 0, nor spoil what is below.
        const Texture below = make_texture(test_device(), screen.pool, 32, 16, all_codes);
        const Texture clear = make_float_texture(test_device(), screen.pool, 32, 16, [&](int, int) { return Linear{nan, nan, nan, 0}; });
        Layer top = projection_layer(clear, screen.options.eyes);
        top.blend_texture_source_alpha = true;
        screen.compose({projection_layer(below, screen.options.eyes), top});
        expect_codes(screen.path->panel_picture(0), all_codes);
    }
}

TEST(Frame, SixteenLayersInPaintersOrder) {
    for (const bool fuse : {true, false}) {
        Screen screen({64, 16}, flat_eyes(1, 0.25f), fuse);
        std::vector<Layer> layers;
        for (int i = 0; i < 16; ++i) {
            const Texture colour = make_texture(test_device(), screen.pool, 4, 4, [i](int, int) {
                return Codes{std::uint8_t(10 * i + 5), 50, 60, 255};
            });
            // Each covers the field from its left edge on: the later one wins.
            Layer quad = quad_layer(colour, {-1 + i / 8.0f + 1, 0, -1}, 2, 2);
            quad.head_locked = true;
            quad.visibility = EyeVisibility::both;
            layers.push_back(quad);
        }
        screen.options.eyes[0].head_from_eye.position = screen.options.eyes[1].head_from_eye.position = {0, 0, 0};
        screen.compose(layers);
        for (int eye = 0; eye < 2; ++eye)
            expect_codes(screen.path->panel_picture(eye), [](int x, int) { return Codes{std::uint8_t(10 * (x / 4) + 5), 50, 60, 255}; });
    }
}

TEST(Frame, LayersThatCannotBeShownAreLeftOut) {
    Screen screen({16, 16}, flat_eyes());
    const Texture texture = make_texture(test_device(), screen.pool, 16, 16, all_codes);
    Layer gone = projection_layer(texture, screen.options.eyes), empty = gone, flat = gone;
    gone.views[0].image.swapchain = gone.views[1].image.swapchain = 4711;
    empty.views[0].image.width = empty.views[1].image.height = 0;
    flat.views[0].fov = flat.views[1].fov = {};
    const FrameOutcome outcome = screen.compose({projection_layer(texture, screen.options.eyes), gone, empty, flat});
    EXPECT_NE(outcome.problem.find("4711"), std::string::npos);
    expect_codes(screen.path->panel_picture(0), all_codes);
}

TEST(Frame, EachColourLeavesThePanelWhereTheLensAsks) {
    // A white dot in a known direction: red, green and blue must light the panel where each one's lens shows that direction.
    const auto eyes = vive_pro_eyes();
    const PictureSize panel{360, 400};
    for (const bool fuse : {true, false}) {
        Screen screen(panel, eyes, fuse, false);
        const Texture white = make_texture(test_device(), screen.pool, 16, 16, [](int, int) { return Codes{255, 255, 255, 255}; });
        for (const glm::dvec2 tangents : {glm::dvec2(0.0, 0.0), glm::dvec2(0.5, 0.3), glm::dvec2(-0.6, -0.5)}) {
            Layer quad = quad_layer(white, {float(tangents.x) * 100, float(tangents.y) * 100, -100}, 3, 3);
            screen.compose({quad});
            for (int eye = 0; eye < 2; ++eye) {
                const EyeGeometry g = panel_geometry(eyes[std::size_t(eye)], panel.width, panel.height);
                const double eye_x = double(eyes[std::size_t(eye)].head_from_eye.position.x);
                for (int c = 0; c < 3; ++c) {
                    const glm::dvec2 expected = geometry::lens_pixel(g, g.channels[c], tangents - glm::dvec2(eye_x / 100, 0));
                    const glm::dvec2 at = centroid(screen.path->panel_picture(eye), c);
                    EXPECT_NEAR(at.x, expected.x, 0.3) << "eye " << eye << " channel " << c;
                    EXPECT_NEAR(at.y, expected.y, 0.3) << "eye " << eye << " channel " << c;
                }
            }
        }
    }
}

// A smooth picture, for comparisons of paths that sample differently.
Codes smooth(int x, int y) {
    const auto wave = [](double phase) { return std::uint8_t(std::lround(128 + 100 * std::sin(phase))); };
    return {wave(x * 0.05), wave(y * 0.04), wave((x + y) * 0.03), 255};
}

TEST(Frame, FusedAndStagesAgree) {
    const auto eyes = vive_pro_eyes();
    Screen fused({360, 400}, eyes, true, false), stepwise({360, 400}, eyes, false, false);
    const auto compose = [&](Screen& screen) {
        const Texture view = make_texture(test_device(), screen.pool, 500, 550, smooth),
                      picture = make_texture(test_device(), screen.pool, 100, 100, smooth);
        Layer quad = quad_layer(picture, {0, 0, -2}, 20, 20);
        quad.blend_texture_source_alpha = true;
        EXPECT_EQ(screen.compose({projection_layer(view, eyes), quad}).fused, screen.options.fuse);
    };
    compose(fused);
    compose(stepwise);
    for (int eye = 0; eye < 2; ++eye) {
        const Image8 a = fused.path->panel_picture(eye), b = stepwise.path->panel_picture(eye);
        const EyeGeometry g = panel_geometry(eyes[std::size_t(eye)], 360, 400);
        int worst_green = 0, worst = 0, compared = 0;
        for (int y = 0; y < 400; ++y)
            for (int x = 0; x < 360; ++x) {
                const glm::dvec2 px(x + 0.5, y + 0.5);
                worst_green = std::max(worst_green, std::abs(int(a.at(x, y, 1)) - int(b.at(x, y, 1))));
                if (!geometry::lens_visible(g, px)) continue;
                for (const int c : {0, 2}) {  // where blue comes from beyond the panel's edge, the last pixel is repeated
                    const glm::dvec2 from = lens_math::green_pixel_of_colour(g, g.channels[c], px);
                    if (from.x < 2 || from.y < 2 || from.x > 358 || from.y > 398) continue;
                    worst = std::max(worst, std::abs(int(a.at(x, y, c)) - int(b.at(x, y, c))));
                    ++compared;
                }
            }
        EXPECT_EQ(worst_green, 0);  // the same text on the same grid
        EXPECT_LE(worst, 1);
        EXPECT_GT(compared, 150000);
    }
}

TEST(Frame, HiddenPixelsAreBlackAndNotWorkedOn) {
    for (const bool fuse : {true, false}) {
        Screen screen({180, 200}, vive_pro_eyes(), fuse);
        const Texture white = make_texture(test_device(), screen.pool, 16, 16, [](int, int) { return Codes{255, 255, 255, 255}; });
        screen.compose({projection_layer(white, screen.options.eyes)});
        const EyeGeometry g = panel_geometry(screen.options.eyes[0], 180, 200);
        const Image8 picture = screen.path->panel_picture(0);
        int wrong = 0;
        for (int y = 0; y < 200; ++y)
            for (int x = 0; x < 180; ++x) {
                const glm::dvec2 p = geometry::lens_position(g, g.channels[1], glm::dvec2(x + 0.5, y + 0.5));
                if (std::abs(glm::dot(p, p) - double(g.r2_cutoff.y)) < 1e-4) continue;  // on the rim
                wrong += picture.at(x, y, 1) != (geometry::lens_shows(g, 1, glm::dvec2(x + 0.5, y + 0.5)) ? 255 : 0);
            }
        EXPECT_EQ(wrong, 0);
        EXPECT_EQ(picture.at(0, 0, 1), 0);
    }
}

TEST(Frame, EyeScaleChangesTheEyeImageOnly) {
    const auto eyes = vive_pro_eyes();
    Screen whole_size({180, 200}, eyes, false, false), half({180, 200}, eyes, false, false, 0.5);
    EXPECT_EQ(half.path->eye_size().width, 90u);
    for (Screen* screen : {&whole_size, &half}) {
        const Texture view = make_texture(test_device(), screen->pool, 250, 270, [](int x, int y) { return smooth(x, y); });
        screen->compose({projection_layer(view, eyes)}, stages);
    }
    EXPECT_EQ(half.path->warp_picture(0).width, 90);
    EXPECT_EQ(half.path->lens_picture(0).width, 180);
    const Image8 a = whole_size.path->panel_picture(0), b = half.path->panel_picture(0);
    int worst = 0;
    for (int y = 60; y < 140; ++y)
        for (int x = 60; x < 120; ++x)
            for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(int(a.at(x, y, c)) - int(b.at(x, y, c))));
    EXPECT_LE(worst, 4);
}

TEST(Frame, TheDumpedStagesAreWhatTheyAreCalled) {
    Screen screen({64, 64}, flat_eyes(), true, false);
    const auto value = [](int x, int y) { return Linear{0.001f * float(x), 0.02f * float(y), float(x * y), 1}; };
    const Texture texture = make_float_texture(test_device(), screen.pool, 64, 64, value);
    Layer layer = projection_layer(texture, screen.options.eyes);
    layer.luminance = {300, 0, LuminanceSource::layer_extension};
    const FrameOutcome outcome = screen.compose({layer}, stages);
    EXPECT_FALSE(outcome.fused);
    const ImageF warp = screen.path->warp_picture(0), perceived = screen.path->perceive_picture(0), lens = screen.path->lens_picture(0);
    EXPECT_EQ(warp.data, perceived.data);  // nothing is simulated
    EXPECT_EQ(warp.data, lens.data);       // this lens does nothing
    double worst = 0;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c) {
                const double expected = 300 * double(value(x, y)[std::size_t(c)]);
                worst = std::max(worst, std::abs(double(warp.at(x, y, c)) - expected) / (expected + 1e-3));
            }
    EXPECT_LT(worst, 1e-6);
}

// Light of every code, through float layers, with the dither of several frames: that code and no other.
TEST(Frame, LightOfACodeIsThatCodeWhateverTheDither) {
    for (const bool fuse : {true, false}) {
        Screen screen({256, 8}, flat_eyes(), fuse);
        const Texture texture = make_float_texture(test_device(), screen.pool, 256, 8, [](int x, int) {
            const auto linear = static_cast<float>(colour::srgb_decode(x / 255.0));
            return Linear{linear, linear, linear, 1};
        });
        for (int frame = 0; frame < 5; ++frame) {
            screen.compose({projection_layer(texture, screen.options.eyes)});
            expect_codes(screen.path->panel_picture(frame % 2), [](int x, int) {
                return Codes{std::uint8_t(x), std::uint8_t(x), std::uint8_t(x), 255};
            });
        }
    }
}

TEST(Frame, DitherKeepsTheMean) {
    Screen screen({256, 256}, flat_eyes());
    const double value = 100.3 / 255;  // between two codes
    const auto linear = static_cast<float>(colour::srgb_decode(value));
    const Texture texture = make_float_texture(test_device(), screen.pool, 4, 4, [&](int, int) {
        return Linear{linear, linear, linear, 1};
    });
    screen.compose({projection_layer(texture, screen.options.eyes)});
    const Image8 picture = screen.path->panel_picture(0);
    double sum = 0;
    for (const std::uint8_t code : picture.data) {
        ASSERT_TRUE(code == 100 || code == 101);
        sum += code;
    }
    EXPECT_NEAR(sum / double(picture.data.size()), 100.3, 0.01);
}

TEST(Frame, WhatTheEyeSeesUndoesTheLens) {
    // A grid of dots in known directions must be seen in these directions, in all colours alike.
    const auto eyes = vive_pro_eyes();
    Screen screen({360, 400}, eyes, true, false);
    const Texture white = make_texture(test_device(), screen.pool, 16, 16, [](int, int) { return Codes{255, 255, 255, 255}; });
    for (const glm::dvec2 tangents : {glm::dvec2(0.0, 0.0), glm::dvec2(0.6, 0.4), glm::dvec2(-0.5, -0.7)}) {
        screen.compose({quad_layer(white, {float(tangents.x) * 100, float(tangents.y) * 100, -100}, 4, 4)},
                       {false, false, false, true, true});
        for (int eye = 0; eye < 2; ++eye) {
            const Fov& fov = eyes[std::size_t(eye)].fov;
            const double left = std::tan(double(fov.angle_left)), right = std::tan(double(fov.angle_right));
            const double up = std::tan(double(fov.angle_up)), down = std::tan(double(fov.angle_down));
            const double tx = tangents.x - double(eyes[std::size_t(eye)].head_from_eye.position.x) / 100;
            for (int c = 0; c < 3; ++c) {
                const glm::dvec2 at = centroid(screen.path->seen_picture(eye), c, 20);  // the panel's black shines too
                EXPECT_NEAR(at.x, (tx - left) / (right - left) * 360, 0.4);
                EXPECT_NEAR(at.y, (tangents.y - up) / (down - up) * 400, 0.4);
            }
        }
    }
}

TEST(Frame, TheSameFrameTwiceIsTheSameToTheBit) {
    for (const bool fuse : {true, false}) {
        Screen screen({120, 130}, vive_pro_eyes(), fuse);
        const Texture view = make_float_texture(test_device(), screen.pool, 150, 160, [](int x, int y) {
            return Linear{0.004f * float(x), 0.5f, 0.003f * float(y), 1};
        });
        const FrameDescription frame = description({projection_layer(view, screen.options.eyes)}, screen.options.eyes, 7);
        screen.compose(frame);
        const Image8 first = screen.path->panel_picture(0);
        screen.compose(frame);
        EXPECT_EQ(screen.path->panel_picture(0).data, first.data);
        FrameDescription next = frame;
        next.index = 8;
        screen.compose(next);
        EXPECT_NE(screen.path->panel_picture(0).data, first.data);  // another dither
    }
}

// The residual law: an ordinary application has the codes that it has with nothing simulated, by the same path.
TEST(Frame, OrdinaryApplicationsKeepTheirCodesUnderCombined) {
    for (const bool fuse : {true, false}) {
        SCOPED_TRACE(fuse ? "fused" : "stages");
        Screen off({120, 130}, vive_pro_eyes(), fuse), on({120, 130}, vive_pro_eyes(), fuse);
        must(on.path->select(must(perception::select("combined"))));
        const auto layers = [](Screen& screen) {
            const Texture view = make_texture(test_device(), screen.pool, 150, 160, all_codes);
            const Texture dark = make_texture(test_device(), screen.pool, 40, 40, [](int x, int y) { return Codes{std::uint8_t(x / 8), std::uint8_t(y / 8), 0, 128}; });
            Layer quad = quad_layer(dark, {0, 0, -1}, 0.5f, 0.5f);
            quad.blend_texture_source_alpha = true;
            return std::vector<Layer>{projection_layer(view, screen.options.eyes), quad};
        };
        const std::vector<Layer> plain = layers(off), simulated = layers(on);
        for (int i = 0; i < 3; ++i) {
            off.compose(plain);
            const FrameOutcome outcome = on.compose(simulated);
            EXPECT_EQ(outcome.fused, fuse);
            EXPECT_TRUE(outcome.ordinary);
            EXPECT_GT(outcome.views[0].adaptation_cd_m2, 1);      // the eye adapts all the same
            for (int eye = 0; eye < 2; ++eye) EXPECT_EQ(on.path->panel_picture(eye).data, off.path->panel_picture(eye).data);
        }
        // Nothing but a dark quad: what is not drawn is the panel's black, not a night to be brightened.
        off.compose({plain[1]});
        on.compose({simulated[1]});
        EXPECT_EQ(on.path->panel_picture(0).data, off.path->panel_picture(0).data);
    }
}

// A lamp beyond the panel takes the long way; when it is gone and its traces have faded, the short way is taken again, with the same codes.
TEST(Frame, OrdinaryAgainAfterALamp) {
    Screen off({120, 130}, vive_pro_eyes()), on({120, 130}, vive_pro_eyes());
    must(on.path->select(must(perception::select("combined"))));
    const auto lamp = make_float_texture(test_device(), on.pool, 150, 160, [](int x, int y) { return Linear{x < 80 && y < 80 ? 50.0f : 0.1f, 0.1f, 0.1f, 1}; });
    const Layer bright = projection_layer(lamp, on.options.eyes), ordinary = projection_layer(make_texture(test_device(), on.pool, 150, 160, all_codes), on.options.eyes);
    EXPECT_FALSE(on.compose({bright}).ordinary);
    int frames = 0;
    for (; frames < 300; ++frames) {       // 30 s: the lamp's afterimage takes its time
        FrameDescription frame = description({ordinary}, on.options.eyes, 1 + std::uint64_t(frames));
        frame.perception.snap = false;
        frame.perception.dt_s = 0.1;
        if (on.compose(frame).ordinary) break;
    }
    EXPECT_GT(frames, 1);
    EXPECT_LT(frames, 250);
    off.compose({projection_layer(make_texture(test_device(), off.pool, 150, 160, all_codes), off.options.eyes)});
    EXPECT_EQ(on.path->panel_picture(0).data, off.path->panel_picture(0).data);
}

// Around the gaze a foveated frame has the codes of a full one; an eye whose gaze is not known gets the full frame, to the bit.
TEST(Frame, FoveatedFramesKeepTheFovea) {
    Screen full({300, 333}, vive_pro_eyes()), foveated({300, 333}, vive_pro_eyes());
    perception::Selection selection = must(perception::select("off", {"adaptation=krawczyk_exp_log", "tone=key_reinhard"}));
    must(full.path->select(selection));
    selection.foveation.inverse = perception::FoveationInverse::exact;
    must(foveated.path->select(selection));
    const auto layers = [](Screen& screen) {
        const auto noise = [](int x, int y) { return Linear{float((x * 7919 + y * 104729) % 97) / 9, float((x * 31 + y * 17) % 61) / 5, 1, 1}; };
        return std::vector<Layer>{projection_layer(make_float_texture(test_device(), screen.pool, 400, 440, noise), screen.options.eyes)};
    };
    const std::vector<Layer> plain = layers(full), same = layers(foveated);
    for (const bool known : {true, false}) {
        FrameDescription frame = description(plain, full.options.eyes), other = description(same, foveated.options.eyes);
        for (auto* of : {&frame, &other})
            for (auto& eye : of->perception.eyes) eye.gaze_known = known;
        full.compose(frame);
        const FrameOutcome outcome = foveated.compose(other);
        ASSERT_FALSE(outcome.effects.empty());
        EXPECT_EQ(outcome.effects.back().slot, "foveation");
        EXPECT_EQ(outcome.effects.back().recorded, known);
        EXPECT_EQ(full.path->panel_picture(0).data == foveated.path->panel_picture(0).data, !known);
        const EyeGeometry g = panel_geometry(full.options.eyes[0], 300, 333);
        const glm::dvec2 at = geometry::geometry_pixel(g, {0, 0, -1});
        int wrong = 0;
        for (int y = int(at.y) - 8; y <= int(at.y) + 8; ++y)
            for (int x = int(at.x) - 8; x <= int(at.x) + 8; ++x)
                for (int c = 0; c < 3; ++c) wrong += full.path->panel_picture(0).at(x, y, c) != foveated.path->panel_picture(0).at(x, y, c);
        EXPECT_EQ(wrong, 0);
    }
}

// What the eye adapts to is the same whether 16 points of a tile are looked at or all.
TEST(Frame, AGlanceIsAsGoodAsALook) {
    Screen glance({360, 400}, vive_pro_eyes(), true), look({360, 400}, vive_pro_eyes(), false);
    for (Screen* screen : {&glance, &look}) {
        must(screen->path->select(must(perception::select("combined"))));
        const Texture view = make_texture(test_device(), screen->pool, 400, 400, [](int x, int y) { return Codes{std::uint8_t(x / 2), std::uint8_t(y / 2), std::uint8_t(128 + 90 * std::sin(x * 0.2)), 255}; });
        screen->compose({projection_layer(view, screen->options.eyes)}, screen == &look ? stages : WantedPictures{});
    }
    const FrameOutcome a = glance.compose(std::vector<Layer>{}), b = look.compose(std::vector<Layer>{}, stages);
    EXPECT_TRUE(a.fused);
    EXPECT_FALSE(b.fused);
    EXPECT_NEAR(glance.path->stage()->view(0).adaptation_cd_m2 / look.path->stage()->view(0).adaptation_cd_m2, 1, 0.02);
}

TEST(Frame, PredictTurnsTheGazeIntoEyeAxes) {
    struct StillHead : PoseSource {
        PoseState pose_at(TimeNs time) override {
            PoseState state;
            state.pose.position.x = float(time);
            return state;
        }
    } head;
    struct Eyes : EyeSource {
        Observer observer_at(TimeNs time) override {
            Observer observer;
            observer.time = time;
            observer.eyes[0].gaze_direction = glm::normalize(glm::vec3(0.3f, 0, -1));
            observer.eyes[0].gaze_provenance = Provenance::measured;
            observer.eyes[1].gaze_provenance = Provenance::modelled;
            observer.eyes[1].pupil_diameter_mm = 3;
            return observer;
        }
        std::optional<RawEyeSample> raw_at(int, TimeNs) override { return std::nullopt; }
        bool present() const override { return true; }
        std::string description() const override { return "test"; }
    } tracker;
    Headset headset;
    headset.eyes = flat_eyes();
    headset.eyes[0].head_from_eye.orientation = glm::angleAxis(0.1f, glm::vec3(0, 1, 0));
    headset.head = &head;
    headset.eye_tracker = &tracker;
    FrameDescription frame;
    predict(frame, headset, 5, 17, 0);
    EXPECT_EQ(frame.display_time, 17);
    EXPECT_EQ(frame.world_from_head.position.x, 17.0f);
    EXPECT_TRUE(frame.perception.snap);
    const glm::vec3 back = headset.eyes[0].head_from_eye.rotate(frame.perception.eyes[0].gaze_direction);
    EXPECT_NEAR(back.x, 0.3 / std::sqrt(1.09), 1e-6);
    EXPECT_EQ(frame.perception.eyes[1].pupil_diameter_mm, 3.0f);
    EXPECT_TRUE(frame.perception.eyes[0].gaze_known);
    EXPECT_FALSE(frame.perception.eyes[1].gaze_known);
    predict(frame, headset, 5, 17 + ns_per_s, 17);
    EXPECT_FALSE(frame.perception.snap);
    EXPECT_NEAR(frame.perception.dt_s, 1, 1e-9);
    predict(frame, headset, 5, 17 + 3 * ns_per_s, 17);
    EXPECT_TRUE(frame.perception.snap);
}

}  // namespace
}  // namespace entoptic::compositor
