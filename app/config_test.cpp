// labels: unit
#include "app/config.h"

#include "app/observer_file.h"
#include "app/parse.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

class Configuration : public ::testing::Test {
protected:
    void SetUp() override {
        fs::create_directories(folder_ / "entoptic/applications");
        setenv("XDG_CONFIG_HOME", folder_.c_str(), 1);
        unsetenv("ENTOPTIC_CONFIG");
    }
    void TearDown() override { fs::remove_all(folder_); }
    std::string write(const std::string& name, const std::string& text) const {
        const fs::path path = folder_ / "entoptic" / name;
        std::ofstream(path) << text;
        return path;
    }
    static Config loaded(const std::optional<ApplicationNames>& application = std::nullopt) {
        auto config = load_config(application);
        EXPECT_TRUE(config) << config.error().message;
        return config.value_or(Config());
    }
    // config.toml with this text is refused, and the message holds every one of `wanted`.
    void expect_error(const std::string& text, const std::vector<std::string>& wanted) const {
        const std::string path = write("config.toml", text);
        const auto config = load_config(std::nullopt);
        ASSERT_FALSE(config) << text;
        EXPECT_EQ(config.error().kind, ErrorKind::usage);
        for (const std::string& part : wanted) EXPECT_NE(config.error().message.find(part), std::string::npos) << config.error().message;
        EXPECT_NE(config.error().message.find(path), std::string::npos) << config.error().message;
    }

    const fs::path folder_ = fs::temp_directory_path() / ("entoptic_config_test_" + std::to_string(getpid()));
};

TEST_F(Configuration, WithoutFilesAllIsDefault) {
    const Config config = loaded();
    EXPECT_EQ(config.panel.value, std::pair(1440, 1600));
    EXPECT_EQ(config.preset.value, "combined");
    for (const ConfigLine& line : describe(config)) EXPECT_EQ(line.origin, "default") << line.key;
}

TEST_F(Configuration, EveryValueKnowsItsLine) {
    const std::string path =
        write("config.toml",
              "panel = \"320x360\"\nclock = \"lockstep\"\n\n[dump]\nevery = 5\n[settings]\nglare.k = 4\n[models]\nacuity = \"none\"\n");
    const Config config = loaded();
    EXPECT_EQ(config.panel.value, std::pair(320, 360));
    EXPECT_EQ(config.panel.origin, path + ":1");
    EXPECT_EQ(config.clock.value, "lockstep");
    EXPECT_EQ(config.dump_every.value, 5u);
    EXPECT_EQ(config.dump_every.origin, path + ":5");
    EXPECT_EQ(config.setting_texts(), std::vector<std::string>{"glare.k=4"});
    write("config.toml", "[settings]\nfoveation.inverse = \"exact\"\nfoveation.reduction = 2\n");
    EXPECT_EQ(loaded().setting_texts(), (std::vector<std::string>{"foveation.inverse=exact", "foveation.reduction=2"}));
    EXPECT_EQ(config.model_names(), std::vector<std::string>{"acuity=none"});
}

TEST_F(Configuration, ErrorsNameTheLineTheKeyAndWhatIsAllowed) {
    expect_error("panel = \"320x360\"\npannel = 3\n", {":2", "pannel", "panel", "preset"});
    expect_error("clock = \"sundial\"\n", {":1", "clock", "real", "lockstep"});
    expect_error("frames = \"ten\"\n", {":1", "frames", "whole number"});
    expect_error("frames = -1\n", {"frames", "whole number"});
    expect_error("frames = 1.5\n", {"frames"});
    expect_error("eye_scale = 9\n", {"eye_scale", "0.1", "2"});
    expect_error("eye_scale = nan\n", {"eye_scale"});
    expect_error("panel = \"8x8\"\n", {"panel", "16"});
    expect_error("panel = 1440\n", {"panel"});
    expect_error("luminance = 0\n", {"luminance", "1e-6"});
    expect_error("[dump]\nstages = [\"warp\", \"soup\"]\n", {":2", "dump.stages", "seen"});
    expect_error("[dump]\ndri = \"x\"\n", {":2", "dump.dri", "dump.dir"});
    expect_error("[settings]\nglare = 3\n", {"settings"});
    expect_error("[settings]\nglare.k = \"much\"\n", {"settings"});
    expect_error("models = 3\n", {"models"});
    expect_error("ideal_tracker = 1\n", {"true"});
    expect_error("panel = \"320x360\n", {":1"});
}

TEST_F(Configuration, AnotherFileCanBeNamed) {
    write("config.toml", "frames = 3\n");
    setenv("ENTOPTIC_CONFIG", write("other.toml", "frames = 4\n").c_str(), 1);
    EXPECT_EQ(loaded().frames.value, 4u);
    setenv("ENTOPTIC_CONFIG", "/nowhere/at/all.toml", 1);
    EXPECT_FALSE(load_config(std::nullopt));
}

TEST_F(Configuration, ProfilesMatchByName) {
    write("config.toml", "luminance = 100\n");
    write("applications/hello.toml", "luminance = 300\n[match]\napplication = \"hello*\"\n");
    write("applications/unity.toml", "eye_scale = 0.5\n[match]\nengine = \"Unity\"\n");
    EXPECT_EQ(loaded().luminance.value, 100);
    EXPECT_EQ(loaded(ApplicationNames{"other", "none"}).luminance.value, 100);
    const Config hello = loaded(ApplicationNames{"hello_xr", "Unity"});
    EXPECT_EQ(hello.luminance.value, 300);
    EXPECT_EQ(hello.eye_scale.value, 0.5);
    EXPECT_NE(hello.luminance.origin.find("hello.toml:1"), std::string::npos);
}

TEST_F(Configuration, QuirksComeWithTheProgramOrFromAProfile) {
    EXPECT_TRUE(loaded(ApplicationNames{"a", "b"}).quirks.value.empty());
    const Config gxr = loaded(ApplicationNames{"any", "gxr"});
    EXPECT_EQ(gxr.quirks.value, std::vector<std::string>{"untyped_arrays"});
    EXPECT_EQ(gxr.quirks.origin, "built-in profile gxr:2");
    write("applications/strict.toml", "quirks = []\n[match]\nengine = \"gxr\"\n");
    EXPECT_TRUE(loaded(ApplicationNames{"any", "gxr"}).quirks.value.empty());
    write("applications/strict.toml", "quirks = [\"no_such\"]\n[match]\nengine = \"gxr\"\n");
    const auto config = load_config(ApplicationNames{"any", "gxr"});
    ASSERT_FALSE(config);
    EXPECT_NE(config.error().message.find("untyped_arrays"), std::string::npos) << config.error().message;
}

TEST_F(Configuration, AProfileMaySetOnlyWhatBelongsToAnApplication) {
    write("applications/bad.toml", "hmd = \"virtual\"\n[match]\napplication = \"hello*\"\n");
    const auto config = load_config(ApplicationNames{"hello_xr", ""});
    ASSERT_FALSE(config);
    EXPECT_NE(config.error().message.find("in a profile"), std::string::npos) << config.error().message;
    write("applications/bad.toml", "luminance = 3\n");
    EXPECT_FALSE(load_config(ApplicationNames{"hello_xr", ""}));
}

TEST_F(Configuration, TheCommandLineWinsOverProfileAndFile) {
    const std::string base = write("config.toml", "luminance = 100\nframes = 7\n[models]\nacuity = \"none\"\n");
    write("applications/hello.toml", "luminance = 300\n[match]\napplication = \"hello_xr\"\n");
    const std::string overlay = (folder_ / "overlay.toml").string();
    ASSERT_TRUE(write_overlay(
        overlay, {base, "/run/x", {{"luminance", "500"}, {"models", "{ glare = \"none\" }"}, {"report", toml_string("/a \"b\"\\c\n")}}}));
    setenv("ENTOPTIC_CONFIG", overlay.c_str(), 1);
    const Config config = loaded(ApplicationNames{"hello_xr", ""});
    EXPECT_EQ(config.luminance.value, 500);
    EXPECT_EQ(config.luminance.origin, "command line");
    EXPECT_EQ(config.frames.value, 7u);
    EXPECT_EQ(config.launcher_directory.value, "/run/x");
    EXPECT_EQ(config.report.value, "/a \"b\"\\c\n");
    EXPECT_EQ(config.model_names(), (std::vector<std::string>{"acuity=none", "glare=none"}));
}

TEST_F(Configuration, AnotherPresetForgetsWhatWasChosenForTheFirst) {
    const std::string base = write("config.toml", "[models]\nacuity = \"none\"\n");
    const std::string overlay = (folder_ / "overlay.toml").string();
    ASSERT_TRUE(write_overlay(overlay, {base, "", {{"models", "{ tone = \"none\" }"}, {"preset", "\"off\""}}}));
    setenv("ENTOPTIC_CONFIG", overlay.c_str(), 1);
    EXPECT_EQ(loaded().model_names(), std::vector<std::string>{"tone=none"});
}

TEST(Parse, NumbersAreWholeTexts) {
    EXPECT_EQ(number_from("1e-3"), 1e-3);
    EXPECT_EQ(number_from("+2"), 2);
    for (const char* text : {"", "x", "1x", "1 ", "nan", "inf", "1,2", "0x10"}) EXPECT_FALSE(number_from(text)) << text;
    EXPECT_EQ(numbers_from("1,-2,3e4"), (std::vector<double>{1, -2, 3e4}));
    for (const char* text : {"", ",", "1,", ",1"}) EXPECT_FALSE(numbers_from(text)) << text;
    EXPECT_EQ(size_from("1440x1600"), std::pair(1440, 1600));
    for (const char* text : {"", "x", "1440", "1440x", "x1600", "0x3", "-1x3", "1440x1600x2"}) EXPECT_FALSE(size_from(text)) << text;
}

TEST(Parse, NamesWithNumbersAndTimes) {
    EXPECT_EQ(NumberedName::parse("a.png")->with(3, 4), "a.png");
    EXPECT_EQ(NumberedName::parse("a_%04d.png")->with(12, 0), "a_0012.png");
    EXPECT_EQ(NumberedName::parse("a_%d_%t.png")->with(12, 0.25), "a_12_0.25.png");
    for (const char* text : {"%s", "a%", "%04x", "%d%d", "%t%t", "%5t", "%0000d"}) EXPECT_FALSE(NumberedName::parse(text)) << text;
}

}  // namespace
}  // namespace entoptic::app
