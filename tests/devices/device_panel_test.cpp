// labels: device
// The panel's target against the kernel's own display code: vkms with a Vive Pro's EDID. Runs on tests/devices/run_um.sh --edid.
#include "compositor/targets/kms/lease.h"
#include "compositor/targets/kms/scanout.h"
#include "compositor/testing/frame_harness.h"
#include "drivers/display/edid.h"

#include <cmath>
#include <csignal>
#include <drm_fourcc.h>
#include <fcntl.h>
#include <fstream>
#include <gtest/gtest.h>
#include <sys/mman.h>
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

constexpr const char* card_node = "/dev/dri/card0";
constexpr const char* connector_status = "/sys/class/drm/card0-DP-1/status";
constexpr PictureSize eye_size{1440, 1600};
constexpr double period_ns = 1e9 * (2880 + 80) * (1600 + 24) / 432'830'000.0;  // vive_panel_edid.py's pixel clock, in steps of 10 kHz

MonotonicClock the_clock;

PanelWish wish() {
    PanelWish w;
    w.refresh_hz = 90.04;
    w.headset_of_edid = [](std::span<const std::uint8_t> bytes) -> std::string {
        const auto edid = drivers::parse_edid(bytes);
        const char* headset = edid ? drivers::headset_of_edid(*edid) : nullptr;
        return headset ? headset : "";
    };
    return w;
}

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

// What the card scans out now, by the kernel's own account: the framebuffer of the lit CRTC, mapped through another descriptor.
std::vector<std::uint32_t> scanned_out(int fd) {
    std::vector<std::uint32_t> pixels;
    drmModeRes* resources = drmModeGetResources(fd);
    for (int i = 0; resources && i < resources->count_crtcs; ++i) {
        drmModeCrtc* crtc = drmModeGetCrtc(fd, resources->crtcs[i]);
        drmModeFB* buffer = crtc && crtc->buffer_id ? drmModeGetFB(fd, crtc->buffer_id) : nullptr;
        std::uint64_t offset = 0;
        if (buffer && drmModeMapDumbBuffer(fd, buffer->handle, &offset) == 0) {
            const std::size_t size = std::size_t(buffer->pitch) * buffer->height;
            void* mapped = mmap(nullptr, size, PROT_READ, MAP_SHARED, fd, static_cast<off_t>(offset));
            for (std::uint32_t y = 0; mapped != MAP_FAILED && y < buffer->height; ++y) {
                const auto* row =
                    reinterpret_cast<const std::uint32_t*>(static_cast<const std::byte*>(mapped) + std::size_t(y) * buffer->pitch);
                pixels.insert(pixels.end(), row, row + buffer->width);
            }
            if (mapped != MAP_FAILED) munmap(mapped, size);
        }
        drmModeFreeFB(buffer);
        drmModeFreeCrtc(crtc);
    }
    drmModeFreeResources(resources);
    return pixels;
}

void set_connector(const char* status) {
    std::ofstream out(connector_status);
    out << status;
    out.close();
    ASSERT_TRUE(out) << connector_status;
}

TEST(PanelOnTheKernel, IsFoundByItsEdidAndTheKernelsOwnMark) {
    const auto held = hold_card(wish());
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
    options.wish = wish();
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
    options.wish = wish();
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
    options.wish = wish();
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
    const auto held = hold_card(wish());
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    ASSERT_FALSE(held);
    EXPECT_EQ(held.error().kind, ErrorKind::failed);
    EXPECT_NE(held.error().message.find("another program, most likely a display server, holds"), std::string::npos) << held.error().message;
    EXPECT_TRUE(hold_card(wish()));  // and after it, all is well
}

// A display server's part: it is the card's master, and leases connector, CRTC and plane.
class Lessor {
public:
    Lessor() : fd_(open(card_node, O_RDWR | O_CLOEXEC)) {
        drmSetClientCap(fd_, DRM_CLIENT_CAP_UNIVERSAL_PLANES, 1);
        drmModeRes* resources = drmModeGetResources(fd_);
        drmModePlaneRes* planes = drmModeGetPlaneResources(fd_);
        if (resources && planes && resources->count_connectors && resources->count_crtcs && planes->count_planes)
            objects_ = {resources->connectors[0], resources->crtcs[0], planes->planes[0]};
        drmModeFreePlaneResources(planes);
        drmModeFreeResources(resources);
    }
    ~Lessor() { close(fd_); }
    Result<HeldPanel> lease(const PanelWish& w) {
        const int fd = drmModeCreateLease(fd_, objects_.data(), static_cast<int>(objects_.size()), O_CLOEXEC, &id_);
        if (fd < 0) return failure("no lease");
        ENTOPTIC_TRY(card, card_of(fd, "a lease"));
        std::vector<Connector> connectors;
        (void)card->connectors(true, connectors);
        ENTOPTIC_TRY(choice, choose_panel(connectors, w));
        return HeldPanel{std::move(card), std::move(choice)};
    }
    void revoke() { drmModeRevokeLease(fd_, id_); }

private:
    int fd_;
    std::uint32_t id_ = 0;
    std::vector<std::uint32_t> objects_;
};

TEST(PanelOnTheKernel, ALeaseIsTakenBackInMidSessionAndGivenAgain) {
    Lessor server;
    bool gives = true;
    PanelOptions options;
    options.wish = wish();
    options.hold = [&](const PanelWish& w) -> Result<HeldPanel> {
        if (gives) return server.lease(w);
        return failure("not now");
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
