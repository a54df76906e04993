// labels: unit
#include "app/system/checks.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <numeric>
#include <unistd.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

class ChecksTest : public ::testing::Test {
protected:
    void TearDown() override { fs::remove_all(folder_); }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name, std::ios::binary) << text;
    }
    MachinePlaces places() const {
        return {(folder_ / "sys").string(), (folder_ / "dev").string(), {(folder_ / "rules").string()}, [this](const std::string& node) {
                    return fs::exists(node) && node != closed_;
                }};
    }
    std::string node(const std::string& name) const { return (folder_ / "dev" / name).string(); }
    std::string closed_;  // a node that this user may not open
    fs::path folder_ = fs::temp_directory_path() / ("entoptic_checks_" + std::to_string(getpid()));
};

std::string headset_edid() {
    std::string b(128, '\0');
    b.replace(0, 12, std::string("\0\xff\xff\xff\xff\xff\xff\0\x22\xd2\x02\xaa", 12));
    unsigned sum = 0;
    for (const char c : b) sum += static_cast<std::uint8_t>(c);
    b[127] = static_cast<char>(256 - sum % 256);
    return b;
}

TEST_F(ChecksTest, MissingRulesAreSaidWithTheCommandThatInstallsThem) {
    const auto before = check_udev_rules(places());
    ASSERT_EQ(before.size(), 1u);
    EXPECT_EQ(before[0].state, Finding::State::note);
    EXPECT_NE(before[0].mend.find("udevadm"), std::string::npos);
    write("rules/60-entoptic.rules", "");
    EXPECT_EQ(check_udev_rules(places())[0].state, Finding::State::good);
}

TEST_F(ChecksTest, TheHeadsetsPanelIsFoundAmongDisplays) {
    write("sys/class/drm/card0-DP-1/edid", "");
    write("sys/class/drm/card0-DP-2/edid", "nonsense");
    EXPECT_EQ(check_panel(places(), true).back().state, Finding::State::note);
    write("sys/class/drm/card0-DP-3/edid", headset_edid());
    const auto findings = check_panel(places(), true);
    const auto good = std::find_if(findings.begin(), findings.end(), [](const Finding& f) { return f.state == Finding::State::good; });
    ASSERT_NE(good, findings.end());
    EXPECT_NE(good->what.find("HTC Vive Pro on card0-DP-3"), std::string::npos) << good->what;
}

TEST_F(ChecksTest, EyeCamerasByTheirNames) {
    EXPECT_EQ(check_eye_cameras(places())[0].state, Finding::State::note);
    write("sys/class/video4linux/video990/name", "Pupil Cam3 ID0\n");
    write("sys/class/video4linux/video990/index", "0\n");
    write("sys/class/video4linux/video991/name", "Integrated Webcam\n");
    const auto findings = check_eye_cameras(places());
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].state, Finding::State::problem);  // there is no such node
    EXPECT_NE(findings[0].what.find("video990"), std::string::npos);
    write("dev/video990", "");
    EXPECT_EQ(check_eye_cameras(places())[0].state, Finding::State::good);
    closed_ = node("video990");
    EXPECT_EQ(check_eye_cameras(places())[0].state, Finding::State::problem);
    EXPECT_NE(check_eye_cameras(places())[0].mend.find("usermod -aG video"), std::string::npos);
}

TEST_F(ChecksTest, GraphicsNodesThatMayNotBeOpenedAreSaid) {
    ASSERT_EQ(check_graphics_nodes(places()).size(), 1u);
    EXPECT_EQ(check_graphics_nodes(places())[0].state, Finding::State::note);
    for (const char* name : {"dri/card0", "dri/renderD128", "dri/by-path"}) write(std::string("dev/") + name, "");
    auto findings = check_graphics_nodes(places());
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].state, Finding::State::good);
    EXPECT_EQ(findings[0].what, node("dri/card0") + ", " + node("dri/renderD128"));
    closed_ = node("dri/renderD128");  // no GPU: a problem
    findings = check_graphics_nodes(places());
    ASSERT_EQ(findings.size(), 2u);
    EXPECT_EQ(findings[0].state, Finding::State::problem);
    EXPECT_NE(findings[0].what.find("renderD128"), std::string::npos);
    EXPECT_NE(findings[0].mend.find("usermod -aG render"), std::string::npos);
    closed_ = node("dri/card0");  // no panel of one's own: a desktop may lease it
    findings = check_graphics_nodes(places());
    ASSERT_EQ(findings.size(), 2u);
    EXPECT_EQ(findings[0].state, Finding::State::note);
    EXPECT_NE(findings[0].mend.find("udevadm"), std::string::npos);
}

TEST_F(ChecksTest, WithoutAHeadsetNothingIsWrong) {
    for (const Finding& f : check_headset(places())) EXPECT_NE(f.state, Finding::State::problem) << f.what;
}

}  // namespace
}  // namespace entoptic::app
