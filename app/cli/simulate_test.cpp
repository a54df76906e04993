// labels: gpu
// `entoptic simulate` as people call it: what comes out, and what is said when what goes in is bad.
#include <map>
#include "app/testing/command_line.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <set>

namespace entoptic::app {
namespace {

class Simulate : public testing::CommandLineTest {
protected:
    static ImageF even(int width, int height, float cd_m2) { return {width, height, 3, cd_m2}; }
    static ImageF lamp(int width, int height, float room, float cd_m2) {
        ImageF image(width, height, 3, room);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (std::hypot(x - width / 2, y - height / 2) < 0.03 * width)
                    for (int c = 0; c < 3; ++c) image.at(x, y, c) = cd_m2;
        return image;
    }
    ImageF result(const std::string& name) const {
        auto read = read_exr(path(name));
        if (!read) throw std::runtime_error(read.error().message);
        return read->rgb;
    }
    // Every pixel can be shown.
    static void expect_displayable(const ImageF& image) {
        for (const float v : image.data) ASSERT_TRUE(v >= 0.04f && v <= 130.0f) << v;
    }
    static float mean(const ImageF& image) {
        double sum = 0;
        for (const float v : image.data) sum += static_cast<double>(v);
        return static_cast<float>(sum / static_cast<double>(image.data.size()));
    }
};

TEST_F(Simulate, PresetOffClipsTheSceneToThePanel) {
    ImageF scene(4, 1, 3, 20.0f);
    scene.at(0, 0, 0) = 1e6f;
    scene.at(1, 0, 1) = 1e-5f;
    const auto outcome = entoptic({"simulate", picture("a.exr", scene), "-o", path("out.exr"), "--fov", "10", "--preset", "off"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, path("out.exr") + "\n");
    const ImageF out = result("out.exr");
    EXPECT_EQ(out.at(0, 0, 0), 130.0f);
    EXPECT_EQ(out.at(1, 0, 1), 0.04f);
    EXPECT_EQ(out.at(2, 0, 0), 20.0f);
    EXPECT_EQ(read_exr(path("out.exr"))->white_luminance, 1.0f);
}

TEST_F(Simulate, EyesFocusOnTheDistanceInChannelZ) {
    ImageF scene(96, 32, 3, 2.0f), depth(96, 32, 1, 0.3f);   // left half near, right half far; stripes of two pixels
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 96; ++x) {
            if (x >= 48) depth.at(x, y, 0) = 20;
            for (int c = 0; c < 3 && x % 4 < 2; ++c) scene.at(x, y, c) = 100;
        }
    const std::string in = picture("a.exr", scene, 1.0f, depth);
    const auto contrast = [&](const std::string& gaze, int from, const std::vector<std::string>& more) {
        std::vector<std::string> call{"simulate", in,      "-o",      path("out.exr"),     "--fov",  "7",  "--preset",
                                      "off",      "--model", "dof=dioptric_disc", "--gaze", gaze, "--pupil", "5"};
        call.insert(call.end(), more.begin(), more.end());
        const auto outcome = entoptic(call);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        const ImageF out = result("out.exr");
        float low = 1e9f, high = 0;
        for (int x = from; x < from + 12; ++x) low = std::min(low, out.at(x, 16, 1)), high = std::max(high, out.at(x, 16, 1));
        return (high - low) / (high + low);
    };
    for (const std::vector<std::string>& more : {std::vector<std::string>{}, std::vector<std::string>{"--reference"}}) {
        EXPECT_GT(contrast("-2,0", 18, more), 0.9f);
        EXPECT_LT(contrast("-2,0", 66, more), 0.3f);
        EXPECT_GT(contrast("2,0", 66, more), 0.9f);
        EXPECT_LT(contrast("2,0", 18, more), 0.3f);
    }
}

TEST_F(Simulate, PngIsWhatTheDisplayShows) {
    const auto outcome = entoptic({"simulate", picture("a.exr", even(3, 2, 130)), "-o", path("out.png"), "--fov", "10", "--preset", "off"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto png = read_png(path("out.png"));
    ASSERT_TRUE(png);
    for (const auto code : png->data) EXPECT_EQ(code, 255);
}

TEST_F(Simulate, LampStarlightAndNothingGiveFinitePictures) {
    picture("lamp.exr", lamp(96, 80, 1, 5e7f));
    picture("stars.exr", lamp(96, 80, 1e-6f, 1e-3f));
    picture("black.exr", even(96, 80, 0));
    picture("sun.exr", lamp(96, 80, 3e4f, 1e8f));
    for (const char* name : {"lamp", "stars", "black", "sun"}) {
        const auto outcome = entoptic({"simulate", path(std::string(name) + ".exr"), "-o", path("out.exr"), "--fov", "60", "--json"});
        ASSERT_EQ(outcome.status, 0) << name << ": " << outcome.err;
        expect_displayable(result("out.exr"));
        EXPECT_EQ(outcome.json()["pictures"][0]["scene"]["pixels_cleaned"], 0) << name;
    }
}

TEST_F(Simulate, ANightSceneIsDarkerThanADayScene) {
    picture("day.exr", lamp(64, 64, 1000, 3000));
    picture("night.exr", lamp(64, 64, 1e-3f, 3e-3f));
    for (const char* name : {"day", "night"})
        ASSERT_EQ(
            entoptic({"simulate", path(std::string(name) + ".exr"), "-o", path(std::string(name) + "_out.exr"), "--fov", "60"}).status, 0);
    EXPECT_LT(mean(result("night_out.exr")), 0.7f * mean(result("day_out.exr")));
}

TEST_F(Simulate, PixelsThatAreNoLightAreCleanedAndCounted) {
    ImageF scene = even(40, 40, 10);
    scene.at(1, 1, 0) = std::numeric_limits<float>::quiet_NaN();
    scene.at(2, 1, 1) = std::numeric_limits<float>::infinity();
    scene.at(3, 1, 2) = -1;
    const auto outcome = entoptic({"simulate", picture("a.exr", scene), "-o", path("out.exr"), "--fov", "60", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    expect_displayable(result("out.exr"));
    EXPECT_EQ(outcome.json()["pictures"][0]["scene"]["pixels_cleaned"], 3);
    EXPECT_NE(outcome.err.find("3 pixels"), std::string::npos) << outcome.err;
}

TEST_F(Simulate, AllNaNIsBlackNotACrash) {
    const auto outcome =
        entoptic({"simulate", picture("a.exr", even(8, 8, std::numeric_limits<float>::quiet_NaN())), "-o", path("out.exr"), "--fov", "60"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    expect_displayable(result("out.exr"));
}

TEST_F(Simulate, OnePixelAndAFullSphereWork) {
    EXPECT_EQ(entoptic({"simulate", picture("dot.exr", even(1, 1, 5)), "-o", path("dot_out.exr"), "--fov", "10"}).status, 0);
    const auto sphere =
        entoptic({"simulate", picture("sphere.exr", lamp(128, 64, 1, 1e4f)), "-o", path("out.exr"), "--json", "--gaze", "-120,30"});
    ASSERT_EQ(sphere.status, 0) << sphere.err;
    EXPECT_EQ(sphere.json()["projection"], "equirect");
    expect_displayable(result("out.exr"));
}

TEST_F(Simulate, TheScaleComesFromTheFileOrTheUserAndIsNamed) {
    picture("with.exr", even(4, 4, 1), 50.0f);
    picture("without.exr", even(4, 4, 1), std::nullopt);
    const std::vector<std::string> rest{"-o", path("out.exr"), "--fov", "10", "--preset", "off", "--json"};
    const auto run = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), "simulate");
        arguments.insert(arguments.end(), rest.begin(), rest.end());
        return entoptic(arguments);
    };
    const auto file = run({path("with.exr")});
    EXPECT_EQ(file.json()["photometry"]["scale"], 50.0);
    EXPECT_NE(file.json()["photometry"]["source"].get<std::string>().find("whiteLuminance"), std::string::npos);
    EXPECT_EQ(run({path("with.exr"), "--luminance-scale", "20"}).json()["photometry"]["scale"], 20.0);
    EXPECT_EQ(run({path("with.exr"), "--assume-white", "20"}).json()["photometry"]["scale"], 50.0);
    EXPECT_EQ(run({path("without.exr"), "--assume-white", "20"}).json()["photometry"]["scale"], 20.0);
    const auto none = run({path("without.exr")});
    EXPECT_EQ(none.status, 2);
    EXPECT_NE(none.err.find("--assume-white"), std::string::npos);
}

TEST_F(Simulate, AdaptationGoesFromWhereItWasToTheScene) {
    const std::string scene = picture("a.exr", even(48, 48, 100));
    const auto outcome =
        entoptic({"simulate", scene, "-o", path("out_%t.exr"), "--fov", "60", "--preset", "luidolt2020", "--adapted-to", "0.01", "--at", "0,0.1,2", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    const auto report = outcome.json();
    const auto pictures = report["pictures"];
    ASSERT_EQ(pictures.size(), 3u);
    EXPECT_NEAR(pictures[0]["adaptation_cd_m2"].get<double>(), 0.01, 1e-4);
    EXPECT_GT(pictures[1]["adaptation_cd_m2"].get<double>(), 1);
    EXPECT_NEAR(pictures[2]["adaptation_cd_m2"].get<double>(), 100, 1);
    EXPECT_EQ(report["frames"], 181);
    for (const char* name : {"out_0.exr", "out_0.1.exr", "out_2.exr"}) EXPECT_TRUE(testing::fs::exists(path(name))) << name;
    EXPECT_GT(mean(result("out_0.exr")), mean(result("out_2.exr")));
}

TEST_F(Simulate, ASequenceIsNumberedLikeItsInput) {
    for (const char* name : {"in_007.exr", "in_008.exr", "in_009.exr"}) picture(name, even(32, 32, 10));
    const auto outcome = entoptic({"simulate", path("in_%03d.exr"), "-o", path("out_%03d.png"), "--fov", "60", "--fps", "30", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.json()["pictures"].size(), 3u);
    for (const char* name : {"out_007.png", "out_008.png", "out_009.png"}) EXPECT_TRUE(testing::fs::exists(path(name))) << name;
    expect_error(2, "--fps", {"simulate", path("in_%03d.exr"), "-o", path("out_%03d.png"), "--fov", "60"});
    const std::string before = testing::text_of(path("in_008.exr"));
    expect_error(2, "is an input", {"simulate", path("in_%03d.exr"), "-o", path("in_%03d.exr"), "--fov", "60", "--fps", "30"});
    expect_error(2, "is an input",
                 {"simulate", path("in_008.exr"), "-o",
                  path("../" + testing::fs::path(path("x")).parent_path().filename().string() + "/in_008.exr"), "--fov", "60"});
    EXPECT_EQ(testing::text_of(path("in_008.exr")), before);
    testing::fs::remove(path("in_008.exr"));
    expect_error(1, "in_008.exr' is missing", {"simulate", path("in_%03d.exr"), "-o", path("out_%03d.png"), "--fov", "60", "--fps", "30"});
}

TEST_F(Simulate, ATraceMovesGazeAndPupil) {
    write("trace.csv", "# an eye\ntime_s,gaze_x_deg,gaze_y_deg,pupil_mm,blink\n0,0,0,3,0\n1,10,5,5,0\n2,10,5,5,1\n");
    const auto outcome = entoptic({"simulate", picture("a.exr", lamp(48, 48, 1, 1e4f)), "-o", path("out_%t.exr"), "--fov", "60", "--trace",
                                   path("trace.csv"), "--at", "0,0.5,1", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    // 2 mm/s through a low-pass of 0.1 s: 3 + 2 (t - 0.1 (1 - exp(-t/0.1))).
    EXPECT_NEAR(outcome.json()["pictures"][1]["pupil_mm"].get<double>(), 3.8013, 0.01);
    // A pupil between those of the tracker's white and black frame is one between 2 and 8 mm: (3 - 2.5)/(6 - 2.5) of the way.
    for (const char* way : {"--progress", "--reference"}) {
        const auto mapped = entoptic({"simulate", path("a.exr"), "-o", path("out.exr"), "--fov", "60", "--trace", path("trace.csv"), "--preset", "off",
                                      "--model", "pupil=luidolt_pupil", "--json", way});
        ASSERT_EQ(mapped.status, 0) << mapped.err;
        EXPECT_NEAR(mapped.json()["pictures"][0]["pupil_mm"].get<double>(), 2 + 6 * 0.5 / 3.5, 1e-5) << way;
    }
    write("config/entoptic/observers/measured.toml", "[pupil]\nnarrowest_mm = 3.0\nwidest_mm = 5.0\n");
    const auto own = entoptic({"simulate", path("a.exr"), "-o", path("out.exr"), "--fov", "60", "--pupil", "4", "--preset", "off",
                               "--model", "pupil=luidolt_pupil", "--observer", "measured", "--json"});
    EXPECT_NEAR(own.json()["pictures"][0]["pupil_mm"].get<double>(), 5, 1e-5) << own.err;
    write("bad.csv", "time_s,pupil_mm\n0,3\n1,wide\n");
    expect_error(1, "bad.csv:3", {"simulate", path("a.exr"), "-o", path("out.exr"), "--fov", "60", "--trace", path("bad.csv")});
    write("bad.csv", "time_s,pupil_mm\n0,3000\n1,3100\n");
    expect_error(1, "no row has a pupil_mm", {"simulate", path("a.exr"), "-o", path("out.exr"), "--fov", "60", "--trace", path("bad.csv")});
    expect_error(2, "--gaze",
                 {"simulate", path("a.exr"), "-o", path("out.exr"), "--fov", "60", "--trace", path("trace.csv"), "--gaze", "1,1"});
    expect_error(2, "--pupil",
                 {"simulate", path("a.exr"), "-o", path("out.exr"), "--fov", "60", "--trace", path("trace.csv"), "--pupil", "3"});
    expect_error(2, "--trace with pupil_mm",
                 {"simulate", path("a.exr"), "-o", path("out.exr"), "--fov", "60", "--model", "pupil=residual_pupil"});
    write("worse.csv", "time_s,colour\n");
    expect_error(1, "'colour' is no column",
                 {"simulate", path("a.exr"), "-o", path("out.exr"), "--fov", "60", "--trace", path("worse.csv")});
}

// A pupil that is not found for half a second is held, then relaxes towards that of the scene; one that jumps is no faster than an eye's.
TEST_F(Simulate, ATraceIsFilteredAsATrackersSamplesAre) {
    const std::string scene = picture("a.exr", even(16, 16, 1e4f));  // of 2.1 mm
    const auto pupils = [&](const std::string& trace, const std::string& times) {
        write("trace.csv", trace);
        const auto outcome =
            entoptic({"simulate", scene, "-o", path("out_%t.exr"), "--fov", "100", "--trace", path("trace.csv"), "--at", times, "--json"});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        std::vector<double> mm;
        const auto document = outcome.json();
        for (const auto& p : document["pictures"]) mm.push_back(p["pupil_mm"].get<double>());
        return std::pair{mm, outcome.err};
    };
    std::string lost = "\xEF\xBB\xBFtime_s,pupil_mm,gaze_x_deg\r\n", volatile_pupil = "time_s,pupil_mm\n";
    for (int i = 0; i < 100; ++i) lost += std::to_string(i * 0.02) + (i < 26 ? ",6,0\r\n" : i % 2 ? ",0,nan\r\n" : ",,n/a\r\n");
    for (int i = 0; i < 80; ++i) volatile_pupil += std::to_string(i * 0.025) + (i % 2 ? ",2\n" : ",8\n");
    const auto [held, said] = pupils(lost, "0.5,0.9,1.6,1.9");
    EXPECT_NEAR(held[0], 6, 1e-4);
    EXPECT_NEAR(held[1], 6, 1e-4);  // found last at 0.5 s
    EXPECT_LT(held[2], 5.5);
    EXPECT_LT(held[3], held[2]);
    EXPECT_GT(held[3], 2.1);
    EXPECT_NE(said.find("74 have no gaze and 74 no pupil"), std::string::npos) << said;
    const auto [steady, nothing] = pupils(volatile_pupil, "1.5,1.525,1.55,1.575,1.6");
    EXPECT_EQ(nothing, "");
    for (std::size_t i = 1; i < steady.size(); ++i) EXPECT_LT(std::abs(steady[i] - steady[i - 1]), 0.15) << i;
}

TEST_F(Simulate, AGazeOfThePanoramaGoesAllAround) {
    write("trace.csv", "time_s,gaze_x_deg,gaze_y_deg\n0,170,20\n");
    const std::string scene = picture("pano.exr", lamp(64, 32, 1, 1e5f));
    ASSERT_EQ(entoptic({"simulate", scene, "-o", path("trace.exr"), "--trace", path("trace.csv"), "--preset", "luidolt2020"}).status, 0);
    ASSERT_EQ(entoptic({"simulate", scene, "-o", path("gaze.exr"), "--gaze", "170,20", "--preset", "luidolt2020"}).status, 0);
    EXPECT_EQ(result("trace.exr").data, result("gaze.exr").data);
}

TEST_F(Simulate, ABlinkInTheTraceDarkensThePicture) {
    // Closed from 0.6 to 0.8, half way at 0.55, open again at 1.
    write("blink.csv", "time_s,blink\n0,0\n0.5,1\n0.8,0\n");
    const auto seen = [&](const std::vector<std::string>& more) {
        std::vector<std::string> words{"simulate", picture("a.exr", even(16, 16, 50)), "-o", path("out_%t.exr"), "--fov", "60", "--trace", path("blink.csv"),
                                       "--pupil", "4", "--at", "0.45,0.55,0.7,1.1", "--json"};
        words.insert(words.end(), more.begin(), more.end());
        const auto outcome = entoptic(words);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        std::vector<float> red;
        const auto document = outcome.json();
        for (const auto& p : document["pictures"]) red.push_back(read_exr(p["output"].get<std::string>())->rgb.at(8, 8, 0));
        return red;
    };
    for (const std::vector<std::string>& way : {std::vector<std::string>{}, {"--reference"}}) {
        const auto red = seen(way);
        EXPECT_NEAR(red[0], 50, 0.01);
        EXPECT_NEAR(red[1], 50 * (0.5 + 0.5 * 0.056), 0.05);
        EXPECT_NEAR(red[2], 50 * 0.056, 0.01);
        EXPECT_NEAR(red[3], 50, 0.01);
    }
    EXPECT_NEAR(seen({"--model", "eyelid=none"})[2], 50, 0.01);
    EXPECT_NEAR(seen({"--preset", "off"})[2], 50, 0.01);
}

TEST_F(Simulate, DitheredFramesHaveTheRightMean) {
    // 0.3 cd/m² lies between codes 6 and 7, light of code 100 on a code: the one flickers with the right mean of light, the other stands still.
    const auto light_of = [](int code) {
        const double c = code / 255.0;
        return 0.04 + 129.96 * (c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    };
    for (const auto& [light, flickers] : {std::pair{0.3, true}, std::pair{light_of(100), false}}) {
        for (int i = 0; i < 20; ++i) picture("d_" + std::to_string(i) + ".exr", even(32, 32, static_cast<float>(light)));
        const auto outcome = entoptic({"simulate", path("d_%d.exr"), "-o", path("e_%d.png"), "--fov", "60", "--fps", "30", "--preset", "off", "--dither"});
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        double sum = 0;
        std::set<int> codes;
        std::set<std::vector<std::uint8_t>> pictures;
        for (int i = 0; i < 20; ++i) {
            const auto png = read_png(path("e_" + std::to_string(i) + ".png"));
            ASSERT_TRUE(png) << png.error().message;
            for (const std::uint8_t code : png->data) sum += light_of(code), codes.insert(code);
            pictures.insert(png->data);
        }
        EXPECT_NEAR(sum / (20.0 * 32 * 32 * 3) / light, 1, flickers ? 2e-3 : 1e-6);
        EXPECT_EQ(codes.size(), flickers ? 2u : 1u);
        EXPECT_EQ(pictures.size(), flickers ? 20u : 1u);
    }
}

TEST_F(Simulate, ThePupilIsGivenOrModelled) {
    const std::string dark = picture("dark.exr", even(16, 16, 1e-3f)), bright = picture("bright.exr", even(16, 16, 1e4f));
    const auto pupil = [&](const std::string& scene, const std::string& option) {
        return entoptic({"simulate", scene, "-o", path("out.exr"), "--fov", "100", "--pupil", option, "--json"})
            .json()["pictures"][0]["pupil_mm"]
            .get<double>();
    };
    EXPECT_EQ(pupil(dark, "2.5"), 2.5);
    EXPECT_GT(pupil(dark, "model"), 6.5);
    EXPECT_LT(pupil(bright, "model"), 2.5);
}

// The path through the command, not the models' own accuracy: the picture is alike everywhere, so that what the models make of tiles and
// of neighbours (their own tests) does not matter.
TEST_F(Simulate, TheReferenceAgreesWithTheGpu) {
    ImageF scene = even(64, 48, 0.5f);
    for (int y = 0; y < scene.height; ++y)
        for (int x = 0; x < scene.width; ++x) scene.at(x, y, (x + y) % 3) = 2;
    picture("a.exr", scene);
    const std::vector<std::string> call{"simulate", path("a.exr"), "--fov", "50", "--model", "glare=none", "--model", "acuity=none"};
    const auto run = [&](std::vector<std::string> more) {
        more.insert(more.begin(), call.begin(), call.end());
        const auto outcome = entoptic(more);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
    };
    run({"-o", path("gpu.exr")});
    run({"-o", path("double.exr"), "--reference"});
    const ImageF gpu = result("gpu.exr"), reference = result("double.exr");
    for (std::size_t i = 0; i < gpu.data.size(); ++i) ASSERT_NEAR(gpu.data[i] / reference.data[i], 1, 2e-4) << i;
}

TEST_F(Simulate, TheReportHoldsAllThatARepetitionNeeds) {
    const auto outcome =
        entoptic({"simulate", picture("a.exr", even(16, 16, 10)), "-o", path("out.exr"), "--fov", "60", "--gaze", "5,-3", "--seed", "7",
                  "--observer", "70-years", "--set", "tone.smoothing_s=1", "--set", "glare.age=60", "--set", "glare.age=65", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("--set glare.age is given more than once"), std::string::npos);
    const auto report = outcome.json();
    EXPECT_EQ(report["seed"], 7);
    EXPECT_EQ(report["observer"], "70-years");
    EXPECT_EQ(report["settings"].size(), 3u);
    EXPECT_EQ(report["chosen"]["glare"]["parameters"]["age"], 65);
    EXPECT_EQ(report["chosen"]["glare"]["parameters"]["wearer_age"], 30);
    EXPECT_NEAR(report["pictures"][0]["gaze_deg"][0].get<double>(), 5, 1e-4);
    EXPECT_NEAR(report["pictures"][0]["gaze_deg"][1].get<double>(), -3, 1e-4);
}

TEST_F(Simulate, TheSameCallGivesTheSameBits) {
    const std::string scene = picture("a.exr", lamp(48, 48, 0.1f, 1e5f));
    for (const char* out : {"a_out.exr", "b_out.exr"}) ASSERT_EQ(entoptic({"simulate", scene, "-o", path(out), "--fov", "60"}).status, 0);
    EXPECT_EQ(result("a_out.exr").data, result("b_out.exr").data);
}

TEST_F(Simulate, BadPicturesAreNamedAndExplained) {
    const std::string good = picture("good.exr", lamp(64, 64, 1, 10));
    const std::string bytes = testing::text_of(good);
    write("cut.exr", bytes.substr(0, bytes.size() / 2));
    write("text.exr", "no picture at all");
    std::string huge = bytes;
    const std::int32_t far[2] = {2000000000, 2000000000};
    std::memcpy(&huge[huge.find("dataWindow") + 11 + 6 + 4 + 8], far, sizeof far);
    write("huge.exr", huge);
    const auto call = [&](const std::string& in) {
        return std::vector<std::string>{"simulate", path(in), "-o", path("out.exr"), "--fov", "60"};
    };
    expect_error(1, "cut short", call("cut.exr"));
    expect_error(1, "not an OpenEXR", call("text.exr"));
    expect_error(1, "million pixels", call("huge.exr"));
    expect_error(1, "absent.exr", call("absent.exr"));
    EXPECT_FALSE(testing::fs::exists(path("out.exr")));
}

TEST_F(Simulate, WrongOptionsAreUsageErrors) {
    const std::string scene = picture("a.exr", even(8, 4, 1)), square = picture("s.exr", even(8, 8, 1));
    const auto call = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"simulate", square, "-o", path("out.exr")});
        return more;
    };
    expect_error(2, "--fov", call({}));
    expect_error(2, "179", call({"--fov", "180"}));
    expect_error(2, "--gaze", call({"--fov", "60", "--gaze", "1"}));
    expect_error(2, "--pupil", call({"--fov", "60", "--pupil", "12"}));
    expect_error(2, "--adapted-to", call({"--fov", "60", "--adapted-to", "dark"}));
    expect_error(2, "%t", call({"--fov", "60", "--at", "0,1"}));
    expect_error(2, "luidolt2020", call({"--fov", "60", "--preset", "nonsense"}));
    expect_error(2, "glare", call({"--fov", "60", "--model", "glare=nonsense"}));
    expect_error(2, "nonsense", call({"--fov", "60", "--observer", "nonsense"}));
    expect_error(2, "There is no slot 'nosuch'", call({"--fov", "60", "--set", "nosuch.age=80"}));
    expect_error(2, "glare=fraunhofer_mask", call({"--fov", "60", "--set", "glare.mask=x.png"}));
    expect_error(2, "counts an effect twice", call({"--fov", "60", "--model", "mesopic=luidolt_tint"}));
    expect_error(2, "-180 to 180", call({"--fov", "60", "--gaze", "500,0"}));
    expect_error(2, ".png", {"simulate", square, "-o", path("out.jpg"), "--fov", "60"});
    expect_error(2, "--projection", call({"--projection", "fisheye"}));
    expect_error(2, "equirect", call({"--projection", "equirect", "--fov", "60"}));
    expect_error(2, "twice as wide", call({"--projection", "equirect"}));
    expect_error(2, "--luminance-scale", call({"--fov", "60", "--luminance-scale", "0"}));
    expect_error(2, "--dither", call({"--fov", "60", "--dither"}));
    expect_error(1, "no folder", {"simulate", square, "-o", path("nowhere/out.png"), "--fov", "60"});
    expect_error(2, "IN", {"simulate", "-o", path("out.png")});
}

TEST_F(Simulate, AnObserverChangesWhatIsChosenAndNoMore) {
    write("config/entoptic/observers/tester.toml", "description = \"brighter\"\n[settings]\ntone.key_scale = 2\nglare.age = 80\n");
    const std::string scene = picture("a.exr", even(16, 16, 10));
    ASSERT_EQ(entoptic({"simulate", scene, "-o", path("plain.exr"), "--fov", "60", "--preset", "luidolt2020"}).status, 0);
    const auto outcome = entoptic({"simulate", scene, "-o", path("observer.exr"), "--fov", "60", "--preset", "luidolt2020", "--observer", "tester"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_GT(mean(result("observer.exr")), 1.1f * mean(result("plain.exr")));
    for (const auto& [line, said] :
         std::map<std::string, std::string>{{"tone.key_scale = \"much\"", "must be a number: 0.05 to 20."},
                                            {"glare.age = \"70 years\"", "must be a number: 10 to 90 years."},
                                            {"glare.agee = 70", "has a parameter 'agee'"},
                                            {"glaree.age = 70", "no slot 'glaree'"},
                                            {"glare.age = 840", "glare.age = 840 is out of range: 10 to 90 years."}}) {
        write("config/entoptic/observers/broken.toml", "[settings]\n" + line + "\n");
        expect_error(2, "broken.toml:2: ",
                     {"simulate", scene, "-o", path("out.exr"), "--fov", "60", "--observer", "broken", "--preset", "luidolt2020"});
        expect_error(2, said, {"simulate", scene, "-o", path("out.exr"), "--fov", "60", "--observer", "broken", "--preset", "luidolt2020"});
    }
}

TEST_F(Simulate, ObserversThatComeWithTheProgramAreTheirAge) {
    ImageF lamp = even(64, 64, 0.5f);
    for (int y = 30; y < 34; ++y)
        for (int x = 30; x < 34; ++x)
            for (int c = 0; c < 3; ++c) lamp.at(x, y, c) = 1e5f;
    const std::string scene = picture("lamp.exr", lamp);
    std::map<std::string, float> veil;
    for (const std::string name : {"young", "70-years", "early-cataract", "night-driver"}) {
        const auto outcome = entoptic({"simulate", scene, "-o", path("veil.exr"), "--fov", "30", "--model", "tone=none", "--observer", name});
        ASSERT_EQ(outcome.status, 0) << name << outcome.err;
        veil[name] = result("veil.exr").at(5, 32, 1);
    }
    EXPECT_GT(veil["70-years"], 1.5f * veil["young"]);
    EXPECT_GT(veil["early-cataract"], veil["70-years"]);
    // A picture within the display's range is seen differently, too: who looks at it is the mean eye of 30 years. An eye like that one, or none
    // that the file tells of, leaves it as it is.
    ImageF page = even(64, 64, 100);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 32; ++x)
            for (int c = 0; c < 3; ++c) page.at(x, y, c) = 1;
    picture("page.exr", page);
    write("config/entoptic/observers/thirty.toml", "[settings]\nglare.age = 30\n");
    write("config/entoptic/observers/own.toml", "[settings]\nglare.age = 70\nglare.wearer_age = 0\n");
    const auto seen = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"simulate", path("page.exr"), "-o", path("page_seen.exr"), "--fov", "30"});
        EXPECT_EQ(entoptic(more).status, 0);
        return result("page_seen.exr");
    };
    const ImageF off = seen({"--preset", "off"});
    EXPECT_EQ(seen({}).data, off.data);
    EXPECT_EQ(seen({"--observer", "thirty"}).data, off.data);
    EXPECT_EQ(seen({"--observer", "own"}).data, off.data);
    for (const char* name : {"70-years", "early-cataract", "night-driver"}) {
        const ImageF older = seen({"--observer", name});
        for (int c = 0; c < 3; ++c) EXPECT_GT(older.at(20, 32, c), 1.02f * off.at(20, 32, c)) << name << c;
    }
    EXPECT_LE(seen({"--observer", "young"}).at(20, 32, 1), off.at(20, 32, 1));
    write("config/entoptic/observers/old.toml", "[settings]\nglare.age = 900\n");
    expect_error(2, "old.toml:2: glare.age = 900 is out of range: 10 to 90 years",
                 {"simulate", scene, "-o", path("out.exr"), "--fov", "30", "--observer", "old"});
}

}  // namespace
}  // namespace entoptic::app
