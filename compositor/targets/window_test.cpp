// labels: gpu frame
// The window on an X server of our own; and the message where there is none.
#include "compositor/targets/window.h"

#include "base/testing/x_server.h"
#include "compositor/testing/frame_harness.h"

#include <cstdlib>
#include <gtest/gtest.h>

namespace entoptic::compositor {
namespace {

using namespace testing;

std::unique_ptr<gpu::Device> window_device() {
    gpu::DeviceOptions options;
    options.windows = true;
    options.validation = std::getenv("ENTOPTIC_TEST_VALIDATION") != nullptr;
    return must(gpu::Device::create(options));
}

TEST(Window, WithoutAnXServerSaysWhatToDo) {
    const char* display = std::getenv("DISPLAY");
    const std::string before = display ? display : "";
    setenv("DISPLAY", ":4711", 1);
    const auto device = window_device();
    const auto target = make_window_target(*device, {{64, 64}, "test", false});
    if (before.empty())
        unsetenv("DISPLAY");
    else
        setenv("DISPLAY", before.c_str(), 1);
    ASSERT_FALSE(target);
    EXPECT_EQ(target.error().kind, ErrorKind::missing);
    EXPECT_NE(target.error().message.find("DISPLAY"), std::string::npos);
}

TEST(Window, ShowsFrames) {
    const entoptic::testing::VirtualServer server;
    ASSERT_FALSE(server.display().empty()) << "install the package xvfb";
    setenv("DISPLAY", server.display().c_str(), 1);
    const auto device = window_device();
    SwapchainPool pool(*device);
    FramePathOptions options;
    options.panel = {80, 90};
    options.eyes = vive_pro_eyes();
    const auto path = must(FramePath::create(*device, options));
    const Texture texture = make_texture(*device, pool, 32, 32, [](int x, int y) {
        return Codes{std::uint8_t(x * 8), std::uint8_t(y * 8), 128, 255};
    });
    const std::vector<Layer> layers{projection_layer(texture, options.eyes)};
    for (const bool seen : {false, true}) {
        auto target = must(make_window_target(*device, {options.panel, "test", seen}));
        for (std::uint64_t i = 0; i < 4; ++i) {
            const FrameDescription frame = description(layers, options.eyes, i);
            const ImageUse use = pool.use(layers);
            must(path->compose(frame, use));
            const PresentState state{&frame, path.get()};
            must(target->test(state));
            EXPECT_TRUE(target->commit(state));
        }
        EXPECT_FALSE(target->close_wanted());
    }
    unsetenv("DISPLAY");
    EXPECT_EQ(device->validation_messages(), 0u);
}

}  // namespace
}  // namespace entoptic::compositor
