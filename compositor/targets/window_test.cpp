// labels: gpu frame
// The window on an X server of our own; and the message where there is none.
#include "compositor/targets/window.h"

#include "compositor/testing/frame_harness.h"

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <gtest/gtest.h>
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

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

// An X server without a screen of its own (Debian's package xvfb), for as long as this lives.
class VirtualServer {
public:
    VirtualServer() {
        int ends[2];
        if (pipe(ends) != 0) return;
        process_ = fork();
        if (process_ == 0) {
            // It must not outlive a test that crashes, nor hold its output open.
            prctl(PR_SET_PDEATHSIG, SIGTERM);
            const int nowhere = open("/dev/null", O_RDWR);
            dup2(nowhere, 1);
            dup2(nowhere, 2);
            const std::string number = std::to_string(ends[1]);
            execlp("Xvfb", "Xvfb", "-displayfd", number.c_str(), "-screen", "0", "640x480x24", static_cast<char*>(nullptr));
            _exit(127);
        }
        close(ends[1]);
        char text[16] = {};
        // The number comes before the line's end, sometimes by itself.
        for (std::size_t length = 0; length < sizeof text - 1 && !std::strchr(text, '\n');) {
            const ssize_t got = read(ends[0], text + length, sizeof text - 1 - length);
            if (got <= 0) break;
            length += static_cast<std::size_t>(got);
        }
        if (std::strchr(text, '\n')) display_ = ":" + std::to_string(std::atoi(text));
        close(ends[0]);
    }
    ~VirtualServer() {
        if (process_ <= 0) return;
        kill(process_, SIGTERM);
        waitpid(process_, nullptr, 0);
    }
    const std::string& display() const { return display_; }  // empty: there is no Xvfb

private:
    pid_t process_ = -1;
    std::string display_;
};

TEST(Window, ShowsFrames) {
    const VirtualServer server;
    if (server.display().empty()) GTEST_SKIP() << "install the package xvfb";
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
