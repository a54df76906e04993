// labels: gpu fault
// The panel's target on a card that misbehaves: what it shows, when it says so, and what it makes of faults.
#include "compositor/targets/kms/panel.h"

#include "compositor/targets/kms/testing/fake_card.h"
#include "compositor/testing/frame_harness.h"
#include "gpu/testing/validation_guard.h"

#include <gtest/gtest.h>

namespace entoptic::compositor::kms {
namespace {

using namespace testing;
using namespace compositor::testing;

const auto* const guard = ::testing::AddGlobalTestEnvironment(new gpu::testing::ValidationGuard(&test_device));

constexpr PictureSize eye_size{52, 40};  // rows of 104 pixels: the card's are longer

// A frame path with one frame composed: something different at each pixel.
struct Picture {
    Picture() {
        FramePathOptions options;
        options.panel = eye_size;
        options.eyes = flat_eyes();
        path = must(FramePath::create(test_device(), options));
        pool = std::make_unique<SwapchainPool>(test_device());
        const Texture texture = make_texture(test_device(), *pool, 64, 64, [](int x, int y) {
            return Codes{std::uint8_t(4 * x), std::uint8_t(4 * y), std::uint8_t(255 - 3 * x), 255};
        });
        frame = description({projection_layer(texture, options.eyes)}, options.eyes);
        WantedPictures wanted;
        wanted.panel = true;
        must(path->compose(frame, pool->use(frame.layers), wanted));
    }
    std::unique_ptr<FramePath> path;
    std::unique_ptr<SwapchainPool> pool;
    FrameDescription frame;
};
Picture& picture() {
    static Picture p;
    return p;
}

class PanelTest : public ::testing::Test {
protected:
    PanelTest() {
        Connector panel = headset();
        panel.modes.push_back(mode(2 * eye_size.width, eye_size.height, 90 * 120 * 44 / 1000, 120, 44));
        state.connectors = {monitor(), panel};
        options.wish = wish();
        options.wish.width = 2 * eye_size.width;
        options.wish.height = eye_size.height;
        options.hold = [this](const PanelWish& w) -> Result<HeldPanel> {
            ++asked;
            if (!refusal.empty()) return failure(refusal);
            auto card = std::make_unique<FakeCard>(state, clock);
            std::vector<Connector> connectors;
            (void)card->connectors(true, connectors);
            ENTOPTIC_TRY(choice, choose_panel(connectors, w));
            return HeldPanel{std::move(card), std::move(choice)};
        };
        clock.advance_to(2 * ns_per_s);
        state.period_ns = std::int64_t(1e9 * 120 * 44 / (1e3 * (90 * 120 * 44 / 1000)));
    }
    void open() { target = must(make_panel_target(test_device(), clock, options)); }
    // One frame as the service shows it.
    Result<PresentFeedback> show() {
        const PresentState present{&picture().frame, picture().path.get()};
        ENTOPTIC_CHECK(target->test(present));
        ENTOPTIC_CHECK(target->commit(present));
        return target->wait_shown();
    }
    // It is told once that the panel went, and later pictures are quietly not shown.
    void expect_away(const char* why) {
        const auto lost = show();
        ASSERT_FALSE(lost);
        EXPECT_NE(lost.error().message.find(why), std::string::npos) << lost.error().message;
        EXPECT_FALSE(target->lit());
        EXPECT_EQ(target->description().find("away: "), 0u) << target->description();
        EXPECT_EQ(state.held, 0);  // others may have the card
        const auto next = show();
        ASSERT_TRUE(next);
        EXPECT_FALSE(next->shown);
    }
    void expect_back() {
        clock.advance_to(clock.now() + ns_per_s);
        const int modes = state.modes_set;
        const auto feedback = show();
        ASSERT_TRUE(feedback) << feedback.error().message;
        EXPECT_TRUE(feedback->shown);
        EXPECT_TRUE(target->lit());
        EXPECT_EQ(state.modes_set, modes + 1);
        EXPECT_TRUE(show()->shown);
    }
    void expect_picture() {
        for (std::uint32_t eye = 0; eye < 2; ++eye) {
            const Image8 expected = picture().path->panel_picture(int(eye));
            for (std::uint32_t y = 0; y < eye_size.height; ++y)
                for (std::uint32_t x = 0; x < eye_size.width; ++x) {
                    const std::uint32_t word = state.picture[y * state.width + eye * eye_size.width + x];
                    const auto code = [&](int c) { return std::uint32_t(expected.at(int(x), int(y), c)); };
                    ASSERT_EQ(word & 0xffffffu, code(0) << 16 | code(1) << 8 | code(2)) << eye << ' ' << x << ' ' << y;
                }
        }
    }

    VirtualClock clock;
    CardState state;
    PanelOptions options;
    std::string refusal;
    int asked = 0;
    std::unique_ptr<DisplayTarget> target;
};

TEST_F(PanelTest, EveryCodeGetsToItsPixelInTheCardsOwnMemory) {
    open();
    EXPECT_NE(target->description().find("HTC Vive Pro on DP-2 of card7 (fake), 104x40 at 89.96 Hz"), std::string::npos)
        << target->description();
    EXPECT_NE(target->description().find("drawn into the card's memory"), std::string::npos) << target->description();
    ASSERT_TRUE(show());
    expect_picture();
    ASSERT_TRUE(show());
    expect_picture();
    EXPECT_EQ(state.connector, 20u);
    EXPECT_EQ(state.crtc, 2u);
    EXPECT_EQ(state.mode.hdisplay, 104);
}

TEST_F(PanelTest, AndThroughTheCpuWhereVulkanCannotDrawThere) {
    state.misaligned = true;
    open();
    EXPECT_NE(target->description().find("copied to the card by the CPU"), std::string::npos) << target->description();
    ASSERT_TRUE(show());
    ASSERT_TRUE(show());
    expect_picture();
}

TEST_F(PanelTest, TwoBuffersTakeTurnsAndEachPictureHasItsRefresh) {
    open();
    TimeNs last = 0;
    for (int i = 0; i < 50; ++i) {
        const auto feedback = show();
        ASSERT_TRUE(feedback);
        ASSERT_TRUE(feedback->shown);
        EXPECT_EQ((feedback->vblank_time - state.first_vblank) % state.period_ns, 0) << i;
        if (i > 0) { EXPECT_EQ(feedback->vblank_time - last, state.period_ns); }
        EXPECT_NEAR(static_cast<double>(feedback->period), static_cast<double>(state.period_ns), 1);
        last = feedback->vblank_time;
    }
    EXPECT_EQ(state.modes_set, 1);
    EXPECT_EQ(state.flips, 49);
    for (std::size_t i = 2; i < state.shown.size(); ++i) {
        EXPECT_NE(state.shown[i], state.shown[i - 1]);
        EXPECT_EQ(state.shown[i], state.shown[i - 2]);
    }
    target.reset();
    EXPECT_EQ(state.turned_off, 1);
    EXPECT_EQ(state.held, 0);
}

TEST_F(PanelTest, AStampThatGoesBackIsNotPassedOn) {
    open();
    for (int i = 0; i < 40; ++i) ASSERT_TRUE(show());
    state.stamp_errors = {-50'000'000};
    const TimeNs now = clock.now();
    const auto feedback = show();
    ASSERT_TRUE(feedback);
    EXPECT_GT(feedback->vblank_time, now);
    EXPECT_NEAR(static_cast<double>((feedback->vblank_time - state.first_vblank) % state.period_ns), 0, 100);
}

TEST_F(PanelTest, ADriverThatDoesNotCountRefreshesTellsNoTimes) {
    state.counts = false;
    open();
    for (int i = 0; i < 5; ++i) {
        const auto feedback = show();
        ASSERT_TRUE(feedback);
        EXPECT_TRUE(feedback->shown);
        if (i > 1) { EXPECT_EQ(feedback->vblank_time, 0); }
    }
}

TEST_F(PanelTest, ABusyDriverIsAskedAgain) {
    open();
    ASSERT_TRUE(show());
    state.flip_errors = {EBUSY, EBUSY, EBUSY};
    const auto feedback = show();
    ASSERT_TRUE(feedback) << feedback.error().message;
    EXPECT_TRUE(feedback->shown);
    EXPECT_EQ(state.flips, 1);
    state.flip_errors.assign(1000, EBUSY);
    expect_away("cannot be lit");
    state.flip_errors.clear();
    expect_back();
}

TEST_F(PanelTest, ALeaseThatIsTakenBackIsAskedForAgain) {
    open();
    ASSERT_TRUE(show());
    state.flip_errors = {ENOENT};
    expect_away("taken back by the display server");
    expect_back();
}

TEST_F(PanelTest, AnotherProgramTakesTheCardOver) {
    open();
    ASSERT_TRUE(show());
    state.flip_errors = {EACCES};
    expect_away("Another program took over");
    refusal = "still held";
    const int before = asked;
    clock.advance_to(clock.now() + ns_per_s);
    for (int i = 0; i < 5; ++i) EXPECT_FALSE(show()->shown);  // asked for once a second, not once a frame
    EXPECT_EQ(asked, before + 1);
    refusal.clear();
    expect_back();
}

TEST_F(PanelTest, AFlipThatNeverComesEndsInBoundedTime) {
    open();
    ASSERT_TRUE(show());
    state.wait_errors = {ETIMEDOUT};
    const TimeNs before = clock.now();
    expect_away("did not confirm a flip");
    EXPECT_LT(clock.now() - before, ns_per_s);
    expect_back();
}

TEST_F(PanelTest, ACardThatIsGone) {
    open();
    ASSERT_TRUE(show());
    state.wait_errors = {ENODEV};
    expect_away("is gone");
    state.connectors_error = 0;
    expect_back();
}

TEST_F(PanelTest, AModeThatCannotBeSet) {
    open();
    state.set_mode_errors = {EINVAL};
    expect_away("cannot be lit");
    expect_back();
}

TEST_F(PanelTest, UnpluggedAndBack) {
    open();
    ASSERT_TRUE(show());
    state.connectors[1].connected = false;
    state.hotplug = true;
    const int probes = state.probes;
    expect_away("unplugged from DP-2");
    EXPECT_GE(state.probes, probes + 1);
    clock.advance_to(clock.now() + 2 * ns_per_s);
    EXPECT_FALSE(show()->shown);
    state.connectors[1].connected = true;
    expect_back();
    EXPECT_EQ(state.turned_off, 1);
}

TEST_F(PanelTest, UnpluggedWhereTheKernelTellsNobody) {
    open();
    ASSERT_TRUE(show());
    state.connectors[1].connected = false;
    bool shown = true;
    const TimeNs before = clock.now();
    while (shown && clock.now() - before < 2 * ns_per_s) shown = bool(show());
    EXPECT_FALSE(shown);
    EXPECT_LT(clock.now() - before, ns_per_s);
}

TEST_F(PanelTest, AFailedLinkIsSetUpAnewWithoutLosingThePanel) {
    open();
    ASSERT_TRUE(show());
    state.connectors[1].link_bad = true;
    state.hotplug = true;
    EXPECT_TRUE(show()->shown);
    EXPECT_EQ(state.modes_set, 2);
    EXPECT_EQ(state.held, 1);
}

TEST_F(PanelTest, NoMemoryForPicturesIsAnErrorAtOnce) {
    state.framebuffer_errors = {ENOMEM};
    const auto made = make_panel_target(test_device(), clock, options);
    ASSERT_FALSE(made);
    EXPECT_NE(made.error().message.find("104x40"), std::string::npos) << made.error().message;
    EXPECT_EQ(state.held, 0);
}

TEST_F(PanelTest, APanelThatIsSwitchedOnLateIsWaitedFor) {
    Connector panel = state.connectors[1];
    state.connectors.pop_back();
    options.patience = 5 * ns_per_s;
    const auto hold = options.hold;
    const TimeNs start = clock.now();
    options.hold = [&](const PanelWish& w) {
        if (clock.now() - start > 3 * ns_per_s && state.connectors.size() == 1) state.connectors.push_back(panel);
        return hold(w);
    };
    open();
    EXPECT_TRUE(target->lit());
    target.reset();
    state.connectors.pop_back();
    options.hold = hold;
    const TimeNs before = clock.now();
    const auto made = make_panel_target(test_device(), clock, options);
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().kind, ErrorKind::missing);
    EXPECT_NEAR(seconds(clock.now() - before), 5, 0.2);
}

}  // namespace
}  // namespace entoptic::compositor::kms
