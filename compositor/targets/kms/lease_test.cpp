// labels: unit fault
// Asking display servers for a panel that they do not have, or do not give. A lease that is given: tests/devices/device_panel_test.cpp.
#include "compositor/targets/kms/lease.h"

#include "base/testing/x_server.h"
#include "compositor/targets/kms/testing/fake_card.h"
#include "compositor/targets/kms/testing/wayland_lessor.h"

#include <fcntl.h>
#include <gtest/gtest.h>

namespace entoptic::compositor::kms {
namespace {

using namespace testing;

std::string refusal(const Result<HeldPanel>& held, ErrorKind kind) {
    if (held) return "it held a panel";
    EXPECT_EQ(held.error().kind, kind) << held.error().message;
    return held.error().message;
}

TEST(WaylandLease, NoCompositor) {
    setenv("WAYLAND_DISPLAY", "entoptic-nowhere", 1);
    EXPECT_NE(refusal(lease_from_wayland(wish()), ErrorKind::missing).find("cannot be reached"), std::string::npos);
    unsetenv("WAYLAND_DISPLAY");
}

TEST(WaylandLease, ACompositorThatLeasesNothing) {
    WaylandLessor::Behaviour behaviour;
    behaviour.has_protocol = false;
    const WaylandLessor lessor(behaviour);
    EXPECT_NE(refusal(lease_from_wayland(wish()), ErrorKind::missing).find("wp_drm_lease_device_v1"), std::string::npos);
}

TEST(WaylandLease, ACompositorWithoutAHeadset) {
    const WaylandLessor lessor({});
    EXPECT_NE(refusal(lease_from_wayland(wish()), ErrorKind::missing).find("no headset's panel"), std::string::npos);
}

TEST(WaylandLease, ADescriptorThatIsNoCard) {
    WaylandLessor::Behaviour behaviour;
    behaviour.reader = [] { return open("/dev/null", O_RDWR); };
    behaviour.connector = 7;
    const WaylandLessor lessor(behaviour);
    EXPECT_NE(refusal(lease_from_wayland(wish()), ErrorKind::failed).find("is no graphics card"), std::string::npos);
}

TEST(WaylandLease, EveryDescriptorIsGivenBack) {
    const auto open_files = [] { return std::distance(std::filesystem::directory_iterator("/proc/self/fd"), {}); };
    const auto before = open_files();
    {
        WaylandLessor::Behaviour behaviour;
        behaviour.reader = [] { return open("/dev/null", O_RDWR); };
        const WaylandLessor lessor(behaviour);
        for (int i = 0; i < 10; ++i) EXPECT_FALSE(lease_from_wayland(wish()));
    }
    EXPECT_EQ(open_files(), before);
}

TEST(X11Lease, NoServer) {
    const char* display = std::getenv("DISPLAY");
    const std::string kept = display ? display : "";
    setenv("DISPLAY", ":9", 1);
    EXPECT_NE(refusal(lease_from_x11(wish()), ErrorKind::missing).find("cannot be reached"), std::string::npos);
    kept.empty() ? unsetenv("DISPLAY") : setenv("DISPLAY", kept.c_str(), 1);
}

TEST(X11Lease, AServerWithoutAHeadset) {
    const entoptic::testing::VirtualServer server;
    ASSERT_FALSE(server.display().empty()) << "install the package xvfb";
    setenv("DISPLAY", server.display().c_str(), 1);
    EXPECT_NE(refusal(lease_from_x11(wish()), ErrorKind::missing).find("knows no headset's panel"), std::string::npos);
    PanelWish anything = wish();  // its one output has no EDID, so that it is nobody's headset
    anything.headset_of_edid = [](std::span<const std::uint8_t>) { return std::string("anything"); };
    refusal(lease_from_x11(anything), ErrorKind::missing);
    unsetenv("DISPLAY");
}

// What a machine without a headset says, whatever else it has.
TEST(HoldPanel, EveryWayThatWasTriedIsNamed) {
    setenv("WAYLAND_DISPLAY", "entoptic-nowhere", 1);
    setenv("DISPLAY", ":9", 1);
    const std::string why = refusal(hold_panel(wish()), ErrorKind::missing);
    unsetenv("WAYLAND_DISPLAY");
    unsetenv("DISPLAY");
    for (const char* part : {"No panel of a headset could be taken.", "Wayland: ", "X11: ", "graphics cards: "})
        EXPECT_NE(why.find(part), std::string::npos) << why;
}

TEST(CardOf, WhatIsNoCardIsRefusedAndClosed) {
    const int fd = open("/dev/null", O_RDWR);
    const auto card = card_of(fd, "/dev/null");
    ASSERT_FALSE(card);
    EXPECT_EQ(fcntl(fd, F_GETFD), -1);
}

}  // namespace
}  // namespace entoptic::compositor::kms
