// labels: device
// The panel's target against the kernel's own display code: vkms with a Vive Pro's EDID. Runs on tests/devices/run_um.sh --edid.
#include "compositor/targets/kms/lease.h"
#include "compositor/targets/kms/scanout.h"
#include "compositor/testing/frame_harness.h"
#include "tests/devices/panel_on_kernel.h"

#include <cmath>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

namespace entoptic::devices {
namespace {

using namespace compositor;
using namespace compositor::kms;
using compositor::testing::must;
using compositor::testing::test_device;

constexpr const char* connector_status = "/sys/class/drm/card0-DP-1/status";
constexpr PictureSize eye_size{1440, 1600};
constexpr double period_ns = 1e9 * (2880 + 80) * (1600 + 24) / 432'830'000.0;  // vive_panel_edid.py's pixel clock, in steps of 10 kHz

MonotonicClock the_clock;

// One frame at the panel's full size, another colour in each corner.
struct Picture {
    Picture() : pool(test_device()) {
        FramePathOptions options;
        options.panel = eye_size;
        options.eyes = testing::flat_eyes();
        path = must(FramePath::create(test_device(), options));
        const auto texture = testing::make_texture(test_device(), pool, 64, 64, [](int x, int y) {
            return testing::Codes{std::uint8_t(4 * x), std::uint8_t(4 * y), std::uint8_t(x < 32 ? 200 : 20), 255};
        });
        frame = testing::description({testing::projection_layer(texture, options.eyes)}, options.eyes);
        WantedPictures wanted;
        wanted.panel = true;
        must(path->compose(frame, pool.use(frame.layers), wanted));
    }
    std::unique_ptr<FramePath> path;
    SwapchainPool pool;
    FrameDescription frame;
};
Picture& picture() {
    static Picture p;
    return p;
}

Result<PresentFeedback> show(DisplayTarget& target) {
    const PresentState state{&picture().frame, picture().path.get()};
    ENTOPTIC_CHECK(target.test(state));
    ENTOPTIC_CHECK(target.commit(state));
    return target.wait_shown();
}

void set_connector(const char* status) {
    std::ofstream out(connector_status);
    out << status;
    out.close();
    ASSERT_TRUE(out) << connector_status;
}

TEST(PanelOnTheKernel, IsFoundByItsEdidAndTheKernelsOwnMark) {
    const auto held = hold_card(panel_wish());
    ASSERT_TRUE(held) << held.error().message;
    EXPECT_EQ(held->choice.headset, "HTC Vive Pro");
    EXPECT_EQ(held->choice.connector.name, "DP-1");
    EXPECT_TRUE(held->choice.connector.non_desktop);  // the kernel's table of headsets, from the EDID
    EXPECT_EQ(held->choice.mode.hdisplay, 2880);
    EXPECT_EQ(held->choice.mode.vdisplay, 1600);
    EXPECT_NEAR(refresh_hz(held->choice.mode), 90.04, 0.001);
}

TEST(PanelOnTheKernel, EachPictureIsShownAtTheNextRefreshForTenSeconds) {
    PanelOptions options;
    options.wish = panel_wish();
    options.hold = hold_card;
    auto target = make_panel_target(test_device(), the_clock, options);
    ASSERT_TRUE(target) << target.error().message;
    std::printf("%s\n", (*target)->description().c_str());
    TimeNs first = 0, last = 0;
    double worst_ns = 0;
    constexpr int frames = 900;
    for (int i = 0; i < frames; ++i) {
        const auto shown = show(**target);
        ASSERT_TRUE(shown) << shown.error().message;
        ASSERT_TRUE(shown->shown);
        if (i == 0) continue;  // sets the mode
        ASSERT_NE(shown->vblank_time, 0);
        if (i == 1) first = shown->vblank_time;
        worst_ns = std::max(worst_ns, std::abs(static_cast<double>(shown->vblank_time - first) - (i - 1) * period_ns));
        last = shown->vblank_time;
    }
    std::printf("%d flips, %.6f Hz, farthest from the mode's own grid %.0f ns\n", frames - 1, (frames - 2) * 1e9 / double(last - first),
                worst_ns);
    EXPECT_LT(worst_ns, 5000);  // no refresh was missed, and stamps are whole microseconds
}

TEST(PanelOnTheKernel, EveryPixelThatIsScannedOutIsTheFramesCode) {
    PanelOptions options;
    options.wish = panel_wish();
    options.hold = hold_card;
    auto target = must(make_panel_target(test_device(), the_clock, options));
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(show(*target));
    const int fd = open(card_node, O_RDWR | O_CLOEXEC);
    ASSERT_GE(fd, 0);
    const std::vector<std::uint32_t> pixels = scanned_out(fd);
    close(fd);
    ASSERT_EQ(pixels.size(), std::size_t(2880) * 1600);
    std::size_t wrong = 0;
    for (int eye = 0; eye < 2; ++eye) {
        const Image8 expected = picture().path->panel_picture(eye);
        for (int y = 0; y < 1600; ++y)
            for (int x = 0; x < 1440; ++x) {
                const std::uint32_t word = pixels[std::size_t(y) * 2880 + std::size_t(eye * 1440 + x)];
                const std::uint32_t code =
                    std::uint32_t(expected.at(x, y, 0)) << 16 | std::uint32_t(expected.at(x, y, 1)) << 8 | expected.at(x, y, 2);
                wrong += (word & 0xffffffu) != code;
            }
    }
    EXPECT_EQ(wrong, 0u);
}

TEST(PanelOnTheKernel, UnpluggedInMidSessionAndBack) {
    PanelOptions options;
    options.wish = panel_wish();
    options.hold = hold_card;
    auto target = must(make_panel_target(test_device(), the_clock, options));
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(show(*target));
    set_connector("off");
    std::string why;
    for (int i = 0; i < 200 && why.empty(); ++i)
        if (const auto shown = show(*target); !shown) why = shown.error().message;
    EXPECT_NE(why.find("unplugged from DP-1"), std::string::npos) << why;
    EXPECT_FALSE(target->lit());
    for (int i = 0; i < 3; ++i) {
        the_clock.sleep_until(the_clock.now() + ns_per_s);
        const auto shown = show(*target);
        ASSERT_TRUE(shown);
        EXPECT_FALSE(shown->shown);
    }
    set_connector("detect");
    the_clock.sleep_until(the_clock.now() + 2 * ns_per_s);
    const auto back = show(*target);
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_TRUE(back->shown);
    EXPECT_TRUE(target->lit());
    for (int i = 0; i < 5; ++i) EXPECT_TRUE(show(*target)->vblank_time);
}

TEST(PanelOnTheKernel, AnotherProcessThatHoldsTheCardIsNamedAsTheReason) {
    int ready[2];
    ASSERT_EQ(pipe(ready), 0);
    const pid_t child = fork();
    if (child == 0) {
        const int fd = open(card_node, O_RDWR);
        const char told = drmIsMaster(fd) ? 'm' : '-';
        (void)!write(ready[1], &told, 1);
        pause();
        _exit(0);
    }
    char told = 0;
    ASSERT_EQ(read(ready[0], &told, 1), 1);
    EXPECT_EQ(told, 'm');
    const auto held = hold_card(panel_wish());
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    ASSERT_FALSE(held);
    EXPECT_EQ(held.error().kind, ErrorKind::failed);
    EXPECT_NE(held.error().message.find("another program, most likely a display server, holds"), std::string::npos) << held.error().message;
    EXPECT_TRUE(hold_card(panel_wish()));  // and after it, all is well
}

TEST(PanelOnTheKernel, ALeaseIsTakenBackInMidSessionAndGivenAgain) {
    Lessor server;
    bool gives = true;
    PanelOptions options;
    options.wish = panel_wish();
    options.hold = [&](const PanelWish& w) -> Result<HeldPanel> {
        if (!gives) return failure("not now");
        ENTOPTIC_TRY(card, card_of(server.lease(), "a lease"));
        std::vector<Connector> connectors;
        (void)card->connectors(true, connectors);
        ENTOPTIC_TRY(choice, choose_panel(connectors, w));
        return HeldPanel{std::move(card), std::move(choice)};
    };
    auto target = make_panel_target(test_device(), the_clock, options);
    ASSERT_TRUE(target) << target.error().message;
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(show(**target));
    server.revoke();
    gives = false;
    const auto lost = show(**target);
    ASSERT_FALSE(lost);
    EXPECT_NE(lost.error().message.find("taken back by the display server"), std::string::npos) << lost.error().message;
    for (int i = 0; i < 3; ++i) {
        the_clock.sleep_until(the_clock.now() + ns_per_s);
        EXPECT_FALSE(show(**target)->shown);
    }
    gives = true;
    the_clock.sleep_until(the_clock.now() + ns_per_s);
    for (int i = 0; i < 20; ++i) {
        const auto shown = show(**target);
        ASSERT_TRUE(shown) << shown.error().message;
        EXPECT_TRUE(shown->shown);
    }
}

}  // namespace
}  // namespace entoptic::devices
