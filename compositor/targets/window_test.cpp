// labels: gpu frame
// The window on an X server of our own; and the message where there is none.
#include "compositor/targets/window.h"

#include "base/testing/x_server.h"
#include "compositor/testing/frame_harness.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include <xcb/xcb.h>

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

// Presses the key of this symbol in every window of the server.
void press(const std::string& display, xcb_keysym_t symbol) {
    xcb_connection_t* x = xcb_connect(display.c_str(), nullptr);
    const xcb_setup_t* setup = xcb_get_setup(x);
    const xcb_window_t root = xcb_setup_roots_iterator(setup).data->root;
    const auto first = setup->min_keycode, count = static_cast<xcb_keycode_t>(setup->max_keycode - setup->min_keycode + 1);
    auto* map = xcb_get_keyboard_mapping_reply(x, xcb_get_keyboard_mapping(x, first, count), nullptr);
    auto* tree = xcb_query_tree_reply(x, xcb_query_tree(x, root), nullptr);
    ASSERT_TRUE(map && tree);
    const xcb_keysym_t* symbols = xcb_get_keyboard_mapping_keysyms(map);
    xcb_key_press_event_t event{};
    event.response_type = XCB_KEY_PRESS;
    event.root = root;
    for (int i = 0; i < count && event.detail == 0; ++i)
        if (symbols[i * map->keysyms_per_keycode] == symbol) event.detail = static_cast<xcb_keycode_t>(first + i);
    ASSERT_NE(event.detail, 0) << "the server's keyboard lacks it";
    for (int i = 0; i < xcb_query_tree_children_length(tree); ++i) {
        event.event = xcb_query_tree_children(tree)[i];
        xcb_send_event(x, 0, event.event, XCB_EVENT_MASK_KEY_PRESS, reinterpret_cast<const char*>(&event));
    }
    std::free(map);
    std::free(tree);
    std::free(xcb_get_input_focus_reply(x, xcb_get_input_focus(x), nullptr));  // the server has done all of it
    xcb_disconnect(x);
}

TEST(Window, KeysAreUnderstood) {
    const entoptic::testing::VirtualServer server;
    ASSERT_FALSE(server.display().empty()) << "install the package xvfb";
    setenv("DISPLAY", server.display().c_str(), 1);
    const auto device = window_device();
    auto target = must(make_window_target(*device, {{64, 64}, "test", false}));
    must(target->test({}));
    EXPECT_FALSE(target->take_recentre_wish());
    press(server.display(), 'c');
    must(target->test({}));
    EXPECT_TRUE(target->take_recentre_wish());
    EXPECT_FALSE(target->take_recentre_wish()) << "once a press";
    EXPECT_FALSE(target->close_wanted());
    press(server.display(), 'q');
    must(target->test({}));
    EXPECT_TRUE(target->close_wanted());
    unsetenv("DISPLAY");
}

}  // namespace
}  // namespace entoptic::compositor
