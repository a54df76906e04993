// labels: gpu
// Frames on a display that was measured: what its panel sends is what the frame holds, for both eyes' own panels.
#include "compositor/testing/frame_harness.h"
#include "shaders/colour_math.glsl"

#include <gtest/gtest.h>
#include <random>

namespace entoptic::compositor {
namespace {

using namespace testing;

// A panel that is not nominal: wider primaries, exponents of its own, a bluish black.
struct TruePanel {
    std::array<double, 3> exponent;
    glm::dmat3 light;
    glm::dvec3 black;

    double share(int c, double code) const { return std::pow(code / 255, exponent[static_cast<std::size_t>(c)]); }
    glm::dvec3 sends(glm::dvec3 code) const { return black + light * glm::dvec3(share(0, code.x), share(1, code.y), share(2, code.z)); }
    MeasuredPanel measured() const {
        MeasuredPanel panel;
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t code = 0; code < 256; ++code) panel.curve[c][code] = static_cast<float>(share(static_cast<int>(c), static_cast<double>(code)));
            panel.light[c] = light[static_cast<int>(c)];
        }
        panel.black = black;
        return panel;
    }
};
const std::array<TruePanel, 2> panels{{{{2.3, 2.2, 2.0}, glm::dmat3(118, -3, 1, 9, 104, 5, 2, -4, 121), {0.03, 0.04, 0.07}},
                                       {{2.2, 2.2, 2.2}, glm::dmat3(101, -2, 0, 6, 97, 4, 1, -3, 96), {0.04, 0.04, 0.05}}}};

FramePathOptions options_for(PictureSize size, bool dither) {
    FramePathOptions options;
    options.panel = size;
    options.eyes = flat_eyes();
    options.dither = dither;
    options.display = {95, 0.05f};
    options.measured = std::make_shared<std::array<MeasuredPanel, 2>>(std::array{panels[0].measured(), panels[1].measured()});
    return options;
}

Layer layer_of(const Texture& texture, const FramePathOptions& options) {
    Layer layer = projection_layer(texture, options.eyes);
    layer.luminance = {1, 0, LuminanceSource::layer_extension};
    return layer;
}

TEST(MeasuredPanel, SendsTheLightThatTheFrameHolds) {
    constexpr int n = 64;
    const FramePathOptions options = options_for({n, n}, false);
    SwapchainPool pool(test_device());
    const auto path = must(FramePath::create(test_device(), options));
    std::mt19937 random(3);
    std::vector<Linear> light(n * n);
    for (Linear& l : light) {
        // Colours of BT.709 that this panel can send, evenly over the steps that are seen.
        std::uniform_real_distribution<double> encoded(0.02, 0.9);
        const auto channel = [&] { return static_cast<float>(0.1 + 94 * colour::srgb_decode(encoded(random))); };
        l = {channel(), channel(), channel(), 1};
    }
    const Texture texture = make_float_texture(test_device(), pool, n, n, [&](int x, int y) { return light[static_cast<std::size_t>(y * n + x)]; });
    const std::vector<Layer> layers{layer_of(texture, options)};
    const FrameOutcome outcome = must(path->compose(description(layers, options.eyes), pool.use(layers), {false, false, false, true, false}));
    EXPECT_FALSE(outcome.fused);
    const Image8 picture = path->panel_picture(1);
    double worst = 0;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const Linear& l = light[static_cast<std::size_t>(y * n + x)];
            const glm::dvec3 wanted(glm::inverse(panels[1].light) * (glm::dvec3(l[0], l[1], l[2]) - panels[1].black));
            for (int c = 0; c < 3; ++c) {
                if (wanted[c] <= 0) continue;      // beyond the panel
                const double exponent = panels[1].exponent[static_cast<std::size_t>(c)], code = 255 * std::pow(wanted[c], 1 / exponent);
                // Half a code is rounding; between codes n and n + 1 a line is off by up to (exponent - 1) / (8 n) of a code.
                worst = std::max(worst, std::abs(picture.at(x, y, c) - code) - 0.5 - (exponent - 1) / (8 * std::max(std::floor(code), 1.0)));
            }
        }
    EXPECT_LT(worst, 1e-3);
}

// Each eye has its own panel: the same light needs other codes.
TEST(MeasuredPanel, EachEyeHasItsOwn) {
    const FramePathOptions options = options_for({16, 16}, false);
    SwapchainPool pool(test_device());
    const auto path = must(FramePath::create(test_device(), options));
    const Texture texture = make_float_texture(test_device(), pool, 4, 4, [](int, int) { return Linear{30, 30, 30, 1}; });
    const std::vector<Layer> layers{layer_of(texture, options)};
    must(path->compose(description(layers, options.eyes), pool.use(layers), {false, false, false, true, false}));
    for (int eye = 0; eye < 2; ++eye) {
        const Image8 picture = path->panel_picture(eye);
        const glm::dvec3 sent = panels[static_cast<std::size_t>(eye)].sends({picture.at(8, 8, 0), picture.at(8, 8, 1), picture.at(8, 8, 2)});
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(sent[c], 30, 0.3) << "eye " << eye << " channel " << c;
    }
    EXPECT_NE(path->panel_picture(0).at(8, 8, 2), path->panel_picture(1).at(8, 8, 2));
}

// Light beyond the panel's range is cut off: no code wraps round, and nothing that is not finite gets through.
TEST(MeasuredPanel, CutsOffWhatItCannotSend) {
    const FramePathOptions options = options_for({16, 16}, true);
    SwapchainPool pool(test_device());
    const auto path = must(FramePath::create(test_device(), options));
    const Texture texture = make_float_texture(test_device(), pool, 4, 1, [](int x, int) {
        constexpr float values[] = {1e7f, 0, 1e-6f, std::numeric_limits<float>::quiet_NaN()};
        return Linear{values[x], values[x], values[x], 1};
    });
    const std::vector<Layer> layers{layer_of(texture, options)};
    must(path->compose(description(layers, options.eyes), pool.use(layers), {false, false, false, true, false}));
    const Image8 picture = path->panel_picture(0);
    for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(picture.at(1, 8, c), 255);
        for (const int x : {6, 10, 14}) EXPECT_LE(picture.at(x, 8, c), 1) << "dither alone";
    }
}

TEST(MeasuredPanel, WhatTheEyeSeesIsTheLightOfItsPanel) {
    const FramePathOptions options = options_for({32, 32}, false);
    SwapchainPool pool(test_device());
    const auto path = must(FramePath::create(test_device(), options));
    const Texture texture = make_float_texture(test_device(), pool, 4, 4, [](int, int) { return Linear{20, 35, 50, 1}; });
    const std::vector<Layer> layers{layer_of(texture, options)};
    must(path->compose(description(layers, options.eyes), pool.use(layers), {false, false, false, true, true}));
    for (int eye = 0; eye < 2; ++eye) {
        const Image8 seen = path->seen_picture(eye);
        const double light[] = {20, 35, 50};
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen.at(16, 16, c), 255 * colour::srgb_encode(light[c] / 95), 2) << "eye " << eye;
    }
}

TEST(MeasuredPanel, PrimariesThatAreOneColourAreRefused) {
    FramePathOptions options = options_for({16, 16}, false);
    std::array<MeasuredPanel, 2> flat{panels[0].measured(), panels[1].measured()};
    flat[0].light[1] = flat[0].light[0];
    options.measured = std::make_shared<std::array<MeasuredPanel, 2>>(flat);
    EXPECT_FALSE(FramePath::create(test_device(), options));
}

}  // namespace
}  // namespace entoptic::compositor
