// labels: gpu
// `entoptic stimulus` as people call it, and what `entoptic simulate` makes of it.
#include "app/testing/command_line.h"

#include <algorithm>
#include <cstdio>

namespace entoptic::app {
namespace {

class Stimulus : public testing::CommandLineTest {
protected:
    static constexpr const char* names[] = {"flash",         "flash_series", "brightness", "hue",           "adaptation_grey",
                                            "adaptation_colour", "lamp_and_page", "mesopic",    "mesopic_levels"};
    ImageF frame(const std::string& stimulus, int number) const {
        char name[64];
        std::snprintf(name, sizeof name, "%s_%04d.exr", stimulus.c_str(), number);
        auto read = read_exr(path("s/" + std::string(name)));
        if (!read) throw std::runtime_error(read.error().message);
        EXPECT_EQ(read->white_luminance, 1.0f);
        return read->rgb;
    }
    testing::Outcome make(const std::string& name, std::vector<std::string> more = {}, const char* size = "16x12") const {
        more.insert(more.begin(), {"stimulus", name, "-o", path("s"), "--size", size});
        return entoptic(more);
    }
    static double most(const ImageF& image) { return static_cast<double>(*std::max_element(image.data.begin(), image.data.end())); }
    static double luminance(const ImageF& image, int x, int y) {
        return 0.2126 * static_cast<double>(image.at(x, y, 0)) + 0.7152 * static_cast<double>(image.at(x, y, 1)) +
               0.0722 * static_cast<double>(image.at(x, y, 2));
    }
};

TEST_F(Stimulus, AllOfThemAreListedAndWritten) {
    const auto list = entoptic({"stimulus", "list"});
    ASSERT_EQ(list.status, 0) << list.err;
    for (const char* name : names) {
        EXPECT_NE(list.out.find(std::string(name) + " "), std::string::npos) << name;
        const auto outcome = make(name, {"--fps", "4"});
        ASSERT_EQ(outcome.status, 0) << name << ": " << outcome.err;
        EXPECT_EQ(outcome.out, path("s/" + std::string(name) + "_%04d.exr") + "\n" + path("s/" + std::string(name) + "_trace.csv") + "\n");
        for (const float v : frame(name, 1).data) ASSERT_TRUE(v >= 0 && v <= 1e8f);
    }
}

TEST_F(Stimulus, FlashesHaveTheirTimeAndTheirLight) {
    ASSERT_EQ(make("brightness", {"--test", "49", "--luminance", "2.7e6"}, "48x36").status, 0);
    // 40 frames a second: 0.5 s of black, 50 ms of the standard, 2.5 s of black, 50 ms of the test, 2.5 s of black.
    EXPECT_EQ(most(frame("brightness", 19)), 0);
    EXPECT_FLOAT_EQ(static_cast<float>(most(frame("brightness", 20))), 2.7e6f);
    EXPECT_FLOAT_EQ(static_cast<float>(most(frame("brightness", 21))), 2.7e6f);
    EXPECT_EQ(most(frame("brightness", 22)), 0);
    EXPECT_EQ(most(frame("brightness", 121)), 0);
    EXPECT_FLOAT_EQ(static_cast<float>(most(frame("brightness", 122))), 4.9e6f);
    EXPECT_EQ(most(frame("brightness", 124)), 0);
    EXPECT_EQ(most(frame("brightness", 223)), 0);
    EXPECT_FALSE(testing::fs::exists(path("s/brightness_0224.exr")));
    // Through a filter, at a frame rate that does not divide 1/8 s: the energy stays.
    ASSERT_EQ(make("hue", {"--filter", "4", "--fps", "30", "--seconds", "1"}, "48x36").status, 0);
    double energy = 0;
    for (int i = 0; i < 30; ++i) energy += most(frame("hue", i)) / 30;
    EXPECT_NEAR(energy, 1e7 / 4 * 0.125, 10);
}

TEST_F(Stimulus, TheChartHasItsLuminances) {
    ASSERT_EQ(make("mesopic", {"--test", "0.041"}, "240x180").status, 0);
    double brightest[2] = {0, 0};
    for (int interval = 0; interval < 2; ++interval) {
        const ImageF chart = frame("mesopic", interval ? 110 : 30);
        for (int y = 0; y < 180; ++y)
            for (int x = 0; x < 240; ++x) brightest[interval] = std::max(brightest[interval], luminance(chart, x, y));
    }
    EXPECT_NEAR(brightest[0], 0.055, 1e-6);
    EXPECT_NEAR(brightest[1], 0.041, 1e-6);
    EXPECT_EQ(most(frame("mesopic", 80)), 0);
}

TEST_F(Stimulus, SimulateTakesPicturesAndTrace) {
    ASSERT_EQ(make("flash", {"--fps", "16", "--seconds", "1.5"}).status, 0);
    const auto outcome =
        entoptic({"simulate", path("s/flash_%04d.exr"), "--fps", "16", "--fov", "40", "--trace", path("s/flash_trace.csv"), "-o",
                  path("seen_%04d.exr"), "--preset", "off", "--model", "afterimage=jacobs", "--photographic", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    ASSERT_EQ(outcome.json()["pictures"].size(), 24u);
    const auto seen = [&](int i) {
        char name[32];
        std::snprintf(name, sizeof name, "seen_%04d.exr", i);
        return read_exr(path(name))->rgb;
    };
    // Dark, the flash, and its afterimage, cyan at first: green and blue without red.
    EXPECT_FLOAT_EQ(static_cast<float>(most(seen(7))), 0.04f);
    EXPECT_EQ(most(seen(9)), 130);
    const ImageF after = seen(10);
    EXPECT_GT(after.at(8, 6, 1), 2.0f);
    EXPECT_GT(after.at(8, 6, 2), 2 * after.at(8, 6, 0));
    EXPECT_FLOAT_EQ(after.at(0, 0, 1), 0.04f);
}

TEST_F(Stimulus, TheGazeMovesAndTheAfterimageWithIt) {
    ASSERT_EQ(make("lamp_and_page", {"--fps", "10"}, "64x48").status, 0);
    const std::string trace = testing::text_of(path("s/lamp_and_page_trace.csv"));
    EXPECT_NE(trace.find("\n0.5,-6,0,0\n"), std::string::npos);
    EXPECT_NE(trace.find("\n4.5,6,0,0\n"), std::string::npos);
    const auto outcome = entoptic({"simulate", path("s/lamp_and_page_%04d.exr"), "--fps", "10", "--fov", "40", "--trace",
                                   path("s/lamp_and_page_trace.csv"), "-o", path("seen_%04d.exr"), "--preset", "off", "--model",
                                   "afterimage=jacobs", "--photographic"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const ImageF page = read_exr(path("seen_0046.exr"))->rgb;
    const int gaze = 41, beside = 47, middle = 24;  // 6 and 9.6 degrees to the right
    EXPECT_LT(page.at(gaze, middle, 1), 0.9f * page.at(beside, middle, 1));  // the lamp's dark spot on the page
}

TEST_F(Stimulus, WrongUsageIsExplained) {
    expect_error(2, "there are flash,", {"stimulus", "sunset", "-o", path("s")});
    expect_error(2, "-o is missing", {"stimulus", "flash"});
    expect_error(2, "frame number", {"stimulus", "flash", "-o", path("s/%t.exr")});
    expect_error(2, "--size", {"stimulus", "flash", "-o", path("s"), "--size", "wide"});
    expect_error(2, "frames are asked for", {"stimulus", "flash", "-o", path("s"), "--seconds", "3600"});
    expect_error(1, "no folder", {"stimulus", "flash", "-o", path("nowhere/a_%04d.exr")});
}

}  // namespace
}  // namespace entoptic::app
