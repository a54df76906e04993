// labels: gpu
// `entoptic calibrate` on the virtual headset: its tracker's errors are known to be there, so they must go.
#include "app/observer_calibration.h"
#include "app/testing/command_line.h"

namespace entoptic::app {
namespace {

class Calibrate : public testing::CommandLineTest {};

TEST_F(Calibrate, GazeIsBetterAfterwardsAndStaysInTheFile) {
    write("config/entoptic/observers/tester.toml", "description = \"a tester\"\n[settings]\nglare.age = 60\n");
    const auto outcome = entoptic({"calibrate", "gaze", "--hmd", "virtual", "--observer", "tester", "--seed", "4", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto json = outcome.json();
    for (const char* side : {"left", "right"}) {
        const double before = json[side]["before_deg"], after = json[side]["after_deg"];
        EXPECT_LT(after, before) << side;
        // What is left: noise of 0.2 degrees an axis, and 0.2 of slow drift an axis both while learning and afterwards.
        EXPECT_LT(after, 0.9) << side;
    }
    const std::string file = testing::text_of(path("config/entoptic/observers/tester.toml"));
    EXPECT_NE(file.find("a tester"), std::string::npos) << file;
    EXPECT_NE(file.find("60"), std::string::npos) << file;
    EXPECT_NE(file.find("left"), std::string::npos) << file;
}

TEST_F(Calibrate, PupilRangeIsThatOfTheWearer) {
    const auto outcome = entoptic({"calibrate", "pupil", "--hmd", "virtual", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NEAR(outcome.json()["narrowest_mm"].get<double>(), 2.6, 0.05);
    EXPECT_NEAR(outcome.json()["widest_mm"].get<double>(), 6.4, 0.05);
    EXPECT_NE(testing::text_of(path("config/entoptic/observers/me.toml")).find("widest_mm"), std::string::npos);
}

TEST_F(Calibrate, WhatCannotBeIsSaid) {
    expect_error(2, "observer's name", {"calibrate", "pupil", "--hmd", "virtual", "--observer", "../x"});
    expect_error(2, "subcommand", {"calibrate"});
    expect_error(3, "Plug them in", {"calibrate", "pupil", "--eye-tracker", "pupil-labs"});
    write("config/entoptic/observers/broken.toml", "[gaze]\nleft = [[1, 2], [3]]\n");
    expect_error(2, "broken.toml:2", {"calibrate", "gaze", "--hmd", "virtual", "--observer", "broken"});
}

}  // namespace
}  // namespace entoptic::app
