// labels: gpu frame
// How far away each pixel of the eye image is: layers with depth images in, dioptres out.
#include "compositor/testing/frame_harness.h"
#include "gpu/testing/validation_guard.h"

#include <glm/gtc/quaternion.hpp>
#include <gtest/gtest.h>
#include <limits>

namespace entoptic::compositor {
namespace {

using namespace testing;

const auto* const guard = ::testing::AddGlobalTestEnvironment(new gpu::testing::ValidationGuard(&test_device));

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr int size = 64;

struct Screen {
    explicit Screen(const std::vector<std::string>& models = {"dof=dioptric_disc"}) {
        options.panel = {size, size};
        options.eyes = flat_eyes();
        options.selection = must(perception::select("off", models, {}));
        path = must(FramePath::create(test_device(), options));
        grey = make_texture(test_device(), pool, 8, 8, [](int, int) { return Codes{128, 128, 128, 255}; });
    }
    // 1/m at the pixels of one eye.
    std::vector<float> dioptres(std::vector<Layer> layers, int eye = 0, const Pose& head = {}) {
        FrameDescription frame = description(std::move(layers), options.eyes, index++);
        frame.world_from_head = head;
        const ImageUse use = pool.use(frame.layers);
        outcome = must(path->compose(frame, use));
        EXPECT_EQ(outcome.problem, "");
        const perception::Stage& stage = *path->stage();
        auto readback = must(gpu::Buffer::create(test_device(), stage.depth().size(), gpu::BufferKind::readback, "depth"));
        auto commands = must(gpu::Commands::create(test_device(), "depth"));
        must(commands.begin());
        commands.copy(stage.depth(), readback, readback.size());
        commands.barrier();
        must(commands.submit());
        must(commands.wait());
        const auto all = readback.as<float>().subspan(std::size_t(eye) * size * size, size * size);
        return {all.begin(), all.end()};
    }
    Layer grey_layer() const { return projection_layer(grey, options.eyes); }
    // Depth for both eyes; `value(x, y)` is what the application's depth buffer holds.
    template <class Value>
    Layer deep_layer(int width, int height, VkFormat format, LayerDepth range, const std::function<Value(int, int)>& value) {
        std::vector<Value> texels;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) texels.push_back(value(x, y));
        range.image = {depth_swapchain(format, width, height), 0, 0, 0, 0, width, height};
        Layer layer = grey_layer();
        for (entoptic::LayerView& view : layer.views) view.depth = range;
        upload(layer, std::as_bytes(std::span(texels)));
        return layer;
    }
    Layer plane(float metres) {
        return deep_layer<float>(8, 8, VK_FORMAT_D32_SFLOAT, {{}, 0, 1, infinity, 0.1f}, [=](int, int) { return 0.1f / metres; });
    }

    FramePathOptions options;
    SwapchainPool pool{test_device()};
    std::unique_ptr<FramePath> path;
    Texture grey;
    FrameOutcome outcome;
    std::uint64_t index = 0;

private:
    std::uint64_t depth_swapchain(VkFormat format, int width, int height) {
        SwapchainRequest request;
        request.vk_format = format;
        request.width = std::uint32_t(width);
        request.height = std::uint32_t(height);
        request.vk_usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
        request.is_static = true;
        const SwapchainAllocation allocation = must(pool.create(request));
        for (const ImageMemory& memory : allocation.images) close(memory.fd);
        return allocation.id;
    }
    void upload(const Layer& layer, std::span<const std::byte> texels) {
        const ImageUse use = pool.use({layer});
        const SubImage& image = layer.views[0].depth.image;
        write_image(test_device(), must(use.find_depth(image)).image, std::uint32_t(image.width), std::uint32_t(image.height), 1, texels,
                    VK_IMAGE_ASPECT_DEPTH_BIT);
    }
};

// Most tests share one: its kernels take seconds to compile.
Screen& shared_screen() {
    static Screen screen;
    return screen;
}

// Cosine between a pixel's direction and straight ahead, on the flat panel of ±45 degrees.
double cosine(int x, int y) {
    const double a = 2 * (x + 0.5) / size - 1, b = 2 * (y + 0.5) / size - 1;
    return 1 / std::sqrt(1 + a * a + b * b);
}

template <class Expected> void expect_dioptres(const std::vector<float>& found, Expected expected, double tolerance = 2e-6) {
    int wrong = 0;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const double at = static_cast<double>(found[std::size_t(y * size + x)]), wanted = expected(x, y);
            if (std::abs(at - wanted) > tolerance * std::max(1.0, wanted) && ++wrong <= 3)
                ADD_FAILURE() << x << ", " << y << ": " << at << ", not " << wanted;
        }
    EXPECT_EQ(wrong, 0);
}

TEST(Depth, IsThatOfTheDepthBufferInEveryConvention) {
    Screen& screen = shared_screen();
    const auto metres = [](int x, int y) { return 0.3 + 0.2 * x + 0.05 * y; };
    const auto expected = [&](int x, int y) { return cosine(x, y) / metres(x, y); };
    struct Convention {
        const char* name;
        float min_depth, max_depth, near_z, far_z;
    };
    for (const Convention& c :
         {Convention{"near to far", 0, 1, 0.1f, 100}, Convention{"reversed", 0, 1, 100, 0.1f}, Convention{"infinite", 0, 1, 0.1f, infinity},
          Convention{"reversed, infinite", 0, 1, infinity, 0.1f}, Convention{"part of the range", 0.2f, 0.7f, 0.1f, 100}}) {
        SCOPED_TRACE(c.name);
        // The projection's own depth, z' = A + B/z with near at min_depth and far at max_depth.
        const auto value = [&](int x, int y) {
            const double near = 1 / double(c.near_z), far = 1 / double(c.far_z);
            return static_cast<float>(double(c.min_depth) + double(c.max_depth - c.min_depth) * (1 / metres(x, y) - near) / (far - near));
        };
        const LayerDepth range{{}, c.min_depth, c.max_depth, c.near_z, c.far_z};
        for (int eye : {0, 1})
            expect_dioptres(screen.dioptres({screen.deep_layer<float>(size, size, VK_FORMAT_D32_SFLOAT, range, value)}, eye), expected,
                            3e-5);
        const auto whole = [&](int x, int y) { return static_cast<std::uint16_t>(std::lround(65535 * double(value(x, y)))); };
        expect_dioptres(screen.dioptres({screen.deep_layer<std::uint16_t>(size, size, VK_FORMAT_D16_UNORM, range, whole)}), expected, 6e-4);
    }
}

TEST(Depth, UnusableValuesAreUnknown) {
    Screen& screen = shared_screen();
    const float values[] = {std::numeric_limits<float>::quiet_NaN(), 0.1f, 0.95f, 0.5f};  // the range is 0.2 to 0.9
    const Layer layer =
        screen.deep_layer<float>(4, 1, VK_FORMAT_D32_SFLOAT, {{}, 0.2f, 0.9f, 0.1f, infinity}, [&](int x, int) { return values[x]; });
    const auto found = screen.dioptres({layer});
    for (int column = 0; column < 3; ++column) EXPECT_EQ(found[std::size_t(20 * size + column * 16 + 8)], -1) << column;
    EXPECT_GT(found[20 * size + 56], 0);
    // Numbers that the runtime would have refused.
    for (const LayerDepth& bad : {LayerDepth{{}, 0, 1, 0, 1}, LayerDepth{{}, 1, 0, 0.1f, 1}, LayerDepth{{}, 0, 1, 2, 2}}) {
        Layer broken = layer;
        for (entoptic::LayerView& view : broken.views) {
            const SubImage image = view.depth.image;
            view.depth = bad;
            view.depth.image = image;
        }
        expect_dioptres(screen.dioptres({screen.plane(2), broken}), [](int, int) { return -1; });
    }
    // Nearer than 5 cm counts as 5 cm.
    const Layer touching =
        screen.deep_layer<float>(1, 1, VK_FORMAT_D32_SFLOAT, {{}, 0, 1, infinity, 0.001f}, [](int, int) { return 1.0f; });
    expect_dioptres(screen.dioptres({touching}), [](int, int) { return 20; });
}

TEST(Depth, SubImageAndResolutionAreTheDepthsOwn) {
    Screen& screen = shared_screen();
    Layer layer = screen.deep_layer<float>(16, 4, VK_FORMAT_D32_SFLOAT, {{}, 0, 1, infinity, 1}, [](int x, int) {
        return x < 8 ? 0.9f : x < 12 ? 0.25f : 0.5f;
    });
    for (entoptic::LayerView& view : layer.views) view.depth.image.x = 8, view.depth.image.width = 8;
    expect_dioptres(screen.dioptres({layer}), [](int x, int y) { return (x < 32 ? 0.25 : 0.5) * cosine(x, y); });
}

TEST(Depth, OfABottomUpPictureIsTurnedOver) {
    Screen& screen = shared_screen();
    Layer layer = screen.deep_layer<float>(4, 16, VK_FORMAT_D32_SFLOAT, {{}, 0, 1, infinity, 1}, [](int, int y) {
        return y < 8 ? 0.9f : y < 12 ? 0.25f : 0.5f;
    });
    for (entoptic::LayerView& view : layer.views) view.depth.image.y = 8, view.depth.image.height = 8, view.depth.image.bottom_up = true;
    expect_dioptres(screen.dioptres({layer}), [](int x, int y) { return (y < 32 ? 0.5 : 0.25) * cosine(x, y); });
}

TEST(Depth, TurnsWithTheHeadButKeepsItsDistance) {
    Screen& screen = shared_screen();
    Pose head;
    head.orientation = glm::angleAxis(0.3f, glm::vec3(0, 1, 0));
    const auto found = screen.dioptres({screen.plane(2)}, 0, head);
    // A pixel's direction, turned by 0.3 rad to the left, meets the plane 2 m ahead of where the picture was drawn for.
    int seen = 0;
    for (int x = 0; x < size; ++x) {
        const double a = 2 * (x + 0.5) / size - 1, angle = std::atan(a) - 0.3, b = 1.0 / size;
        if (std::abs(std::tan(angle)) > 0.98) continue;
        ++seen;
        const double dx = std::sin(angle) * std::hypot(1, a), dz = std::cos(angle) * std::hypot(1, a);
        EXPECT_NEAR(found[std::size_t(32 * size + x)], dz / std::sqrt(dx * dx + dz * dz + b * b) / 2, 1e-5) << x;
    }
    EXPECT_GT(seen, 40);
}

TEST(Depth, QuadsStandWhereTheyStand) {
    Screen& screen = shared_screen();
    const Layer quad = quad_layer(screen.grey, {-0.0315f, 0, -2}, 1, 1);  // before the left eye: within a quarter of the tangent
    const auto inside = [](int x, int y) { return std::abs(2 * (x + 0.5) / size - 1) < 0.25 && std::abs(2 * (y + 0.5) / size - 1) < 0.25; };
    expect_dioptres(
        screen.dioptres({screen.plane(5), quad}), [&](int x, int y) { return cosine(x, y) / (inside(x, y) ? 2 : 5); }, 1e-5);
    expect_dioptres(
        screen.dioptres({quad}), [&](int x, int y) { return inside(x, y) ? cosine(x, y) / 2 : -1; }, 1e-5);
    // Over a picture of unknown depth, and beneath one: painter's order, not distance.
    expect_dioptres(
        screen.dioptres({quad, screen.plane(5)}), [&](int x, int y) { return cosine(x, y) / 5; }, 1e-5);
    expect_dioptres(screen.dioptres({quad, screen.grey_layer()}), [](int, int) { return -1; });
}

TEST(Depth, CoverageDecidesBetweenLayers) {
    Screen& screen = shared_screen();
    const auto veil = [&](std::uint8_t alpha) {
        const Texture texture = make_texture(test_device(), screen.pool, 4, 4, [=](int, int) { return Codes{90, 90, 90, alpha}; });
        Layer layer = quad_layer(texture, {-0.0315f, 0, -0.5f}, 4, 4);
        layer.blend_texture_source_alpha = true;
        return layer;
    };
    for (int alpha : {0, 51, 153, 255}) {
        const double share = alpha / 255.0;
        expect_dioptres(
            screen.dioptres({screen.plane(4), veil(std::uint8_t(alpha))}),
            [&](int x, int y) { return cosine(x, y) * (share * 2 + (1 - share) * 0.25); }, 1e-5);
        // Where only one distance is known, what covers more speaks.
        expect_dioptres(
            screen.dioptres({screen.grey_layer(), veil(std::uint8_t(alpha))}),
            [&](int x, int y) { return share > 0.5 ? 2 * cosine(x, y) : -1; }, 1e-5);
    }
}

TEST(Depth, IsNotComputedUnlessAModelAsks) {
    Screen screen({"tone=key_reinhard"});
    FrameDescription frame = description({screen.plane(2)}, screen.options.eyes);
    const ImageUse use = screen.pool.use(frame.layers);
    must(screen.path->compose(frame, use));
    EXPECT_FALSE(screen.path->stage()->wants_depth());
    EXPECT_FALSE(static_cast<bool>(screen.path->stage()->depth()));
}

TEST(Depth, LinesOfSightMeetWhereTheyMeet) {
    Observer observer;
    const auto eyes = flat_eyes();
    const std::array<Pose, 2> places{eyes[0].head_from_eye, eyes[1].head_from_eye};
    for (const glm::vec3 at : {glm::vec3(0, 0, -1), glm::vec3(0.3f, 0.1f, -0.5f), glm::vec3(-2, 1, -8)}) {
        for (std::size_t eye = 0; eye < 2; ++eye)
            observer.eyes[eye].gaze_direction = glm::normalize(at - places[eye].position),
            observer.eyes[eye].gaze_provenance = Provenance::measured;
        EXPECT_NEAR(vergence_dioptre(observer, places), -1 / at.z, 1e-4);
    }
    std::swap(observer.eyes[0].gaze_direction, observer.eyes[1].gaze_direction);
    EXPECT_EQ(vergence_dioptre(observer, places), 0) << "beyond infinity";
    observer.eyes[1].gaze_provenance = Provenance::modelled;
    EXPECT_LT(vergence_dioptre(observer, places), 0);
}

TEST(Depth, BlursWhatTheEyesDoNotLookAt) {
    Screen& screen = shared_screen();
    const Texture stripes = make_texture(test_device(), screen.pool, size, size, [](int x, int) {
        const std::uint8_t code = x % 4 < 2 ? 230 : 30;
        return Codes{code, code, code, 255};
    });
    // Left half 0.1 m away, right half 10 m; a wide pupil, since 64 pixels for 90 degrees are coarse.
    Layer layer =
        screen.deep_layer<float>(2, 1, VK_FORMAT_D32_SFLOAT, {{}, 0, 1, infinity, 0.1f}, [](int x, int) { return x == 0 ? 1.0f : 0.01f; });
    for (entoptic::LayerView& view : layer.views) view.image = whole(stripes);
    const auto contrast = [&](int from, float gaze_x) {
        FrameDescription frame = description({layer}, screen.options.eyes, 0);
        for (perception::EyeInput& eye : frame.perception.eyes)
            eye.gaze_direction = glm::normalize(glm::vec3(gaze_x, 0, -1)), eye.pupil_diameter_mm = 8;
        const ImageUse use = screen.pool.use(frame.layers);
        must(screen.path->compose(frame, use, {false, true, false, false, false}));
        const ImageF picture = screen.path->perceive_picture(0);
        float low = 1e9f, high = 0;
        for (int x = from; x < from + 12; ++x) low = std::min(low, picture.at(x, 32, 1)), high = std::max(high, picture.at(x, 32, 1));
        return (high - low) / (high + low);
    };
    EXPECT_GT(contrast(8, -0.5f), 0.9f);
    EXPECT_LT(contrast(44, -0.5f), 0.7f);
    EXPECT_GT(contrast(44, 0.5f), 0.9f);
    EXPECT_LT(contrast(8, 0.5f), 0.7f);
}

}  // namespace
}  // namespace entoptic::compositor
