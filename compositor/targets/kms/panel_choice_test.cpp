// labels: unit
#include "compositor/targets/kms/panel_choice.h"

#include "compositor/targets/kms/testing/fake_card.h"

#include <gtest/gtest.h>

namespace entoptic::compositor::kms {
namespace {

using namespace testing;

std::string problem(const std::vector<Connector>& connectors, ErrorKind kind, const PanelWish& w = wish()) {
    const auto choice = choose_panel(connectors, w);
    if (choice) return "it chose " + choice->connector.name;
    EXPECT_EQ(choice.error().kind, kind) << choice.error().message;
    return choice.error().message;
}

TEST(PanelChoice, TheVivePro) {
    const auto choice = choose_panel({monitor(), headset()}, wish());
    ASSERT_TRUE(choice) << choice.error().message;
    EXPECT_EQ(choice->connector.name, "DP-2");
    EXPECT_EQ(choice->headset, "HTC Vive Pro");
    EXPECT_EQ(choice->mode.hdisplay, 2880);
    EXPECT_NEAR(refresh_hz(choice->mode), 90.13, 0.01);  // not the 60 Hz one: 447000 kHz / (3054 * 1624)
    EXPECT_EQ(choice->crtc, 2u);                         // 1 lights the monitor
}

TEST(PanelChoice, AKnownHeadsetComesBeforeOneThatOnlyTheKernelKnows) {
    Connector other = headset();
    other.id = 15, other.name = "HDMI-A-1", other.edid = {9};
    for (const auto& list : {std::vector{other, headset()}, std::vector{headset(), other}})
        EXPECT_EQ(choose_panel(list, wish())->connector.id, 20u);
    const auto only = choose_panel({monitor(), other}, wish());
    ASSERT_TRUE(only);
    EXPECT_EQ(only->headset, "a headset");
}

TEST(PanelChoice, AHeadsetThatTheKernelTakesForAMonitor) {
    Connector c = headset();
    c.non_desktop = false;  // a kernel without the quirk
    EXPECT_EQ(choose_panel({monitor(), c}, wish())->connector.id, 20u);
}

TEST(PanelChoice, NothingThere) {
    Connector gone = headset();
    gone.connected = false;
    const std::string why = problem({monitor(), gone}, ErrorKind::missing);
    EXPECT_NE(why.find("DP-1: a display for desktops"), std::string::npos) << why;
    EXPECT_NE(why.find("DP-2: nothing"), std::string::npos) << why;
    problem({}, ErrorKind::missing);
}

TEST(PanelChoice, NoSuchMode) {
    Connector c = headset();
    c.modes.erase(c.modes.begin() + 1, c.modes.end());
    const std::string why = problem({c}, ErrorKind::failed);
    EXPECT_NE(why.find("2880x1600"), std::string::npos) << why;
    EXPECT_NE(why.find("it has 1440x900"), std::string::npos) << why;
    c.modes.clear();
    EXPECT_NE(problem({c}, ErrorKind::failed).find("it has none"), std::string::npos);
}

TEST(PanelChoice, NonsenseModesAreNotChosen) {
    Connector c = headset();
    c.modes = {mode(2880, 1600, 447'000, 0, 0), mode(2880, 1600, 447'000, 100, 1624), mode(2880, 1600, 0, 3054, 1624)};
    problem({c}, ErrorKind::failed);
}

TEST(PanelChoice, AMonitorIsNotDarkened) {
    Connector second = monitor();
    second.id = 11, second.name = "HDMI-A-1", second.crtc = 2;
    EXPECT_NE(problem({monitor(), second, headset()}, ErrorKind::failed).find("Switch a monitor off"), std::string::npos);
    Connector lit = headset();
    lit.crtc = 2;
    EXPECT_EQ(choose_panel({monitor(), lit}, wish())->crtc, 2u);
    second.connected = false;  // it drives nothing
    EXPECT_EQ(choose_panel({monitor(), second, headset()}, wish())->crtc, 2u);
}

TEST(PanelChoice, RefreshRates) {
    EXPECT_DOUBLE_EQ(refresh_hz(mode(1920, 1080, 148'500, 2200, 1125)), 60);  // CEA-861 format 16
    drmModeModeInfo interlaced = mode(1920, 1080, 74'250, 2200, 1125);        // CEA-861 format 5: 60 fields
    interlaced.flags = DRM_MODE_FLAG_INTERLACE;
    EXPECT_DOUBLE_EQ(refresh_hz(interlaced), 60);
    EXPECT_DOUBLE_EQ(refresh_hz(drmModeModeInfo{}), 0);
}

}  // namespace
}  // namespace entoptic::compositor::kms
