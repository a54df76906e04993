// labels: gpu
// The services behind an instance, without OpenXR: what the configuration asks for happens, and is told.
#include "app/host/host.h"
#include "app/host/resolution.h"

#include "app/calibration_target.h"
#include "app/launch.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <thread>
#include <unistd.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

class HostTest : public ::testing::Test {
protected:
    void SetUp() override {
        fs::create_directories(folder_ / "launcher");
        setenv("XDG_CONFIG_HOME", folder_.c_str(), 1);
        setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
    }
    void TearDown() override { fs::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    void configure(std::vector<std::pair<std::string, std::string>> values) const {
        for (const auto& [key, value] : {std::pair{"panel", "\"64x72\""}, {"clock", "\"lockstep\""}, {"preset", "\"off\""}})
            if (std::none_of(values.begin(), values.end(), [&](const auto& wanted) { return wanted.first == key; }))
                values.emplace_back(key, value);
        ASSERT_TRUE(write_overlay(path("overlay.toml"), {"", path("launcher"), values}));
        setenv("ENTOPTIC_CONFIG", path("overlay.toml").c_str(), 1);
    }
    static Result<std::unique_ptr<RuntimeHost>> open() {
        ApplicationIdentity application;
        application.name = "host_test";
        application.engine = "none";
        application.extensions = {"XR_KHR_vulkan_enable"};
        return make_host(application);
    }
    static void show(RuntimeHost& host, int frames) {
        host.frames().begin_session();
        for (int i = 0; i < frames; ++i) {
            const FrameTiming timing = host.frames().wait_frame();
            host.frames().begin_frame(timing.frame_id);
            host.frames().submit_frame({timing.frame_id, timing.predicted_display_time, {}});
        }
        host.frames().end_session();
    }
    Json json_of(const std::string& name) const {
        std::ifstream in(path(name));
        return Json::parse(in, nullptr, false);
    }
    std::string failure_text() const {
        std::ifstream in(path("launcher/failure"));
        return {std::istreambuf_iterator<char>(in), {}};
    }
    std::string status_path() const { return path("entoptic/" + std::to_string(getpid()) + ".json"); }

private:
    const fs::path folder_ = fs::temp_directory_path() / ("entoptic_host_test_" + std::to_string(getpid()));
};

TEST_F(HostTest, ShowsFramesAndReportsThem) {
    configure({{"report", toml_string(path("report.json"))}, {"frames", "3"}, {"luminance", "250"}});
    auto host = open();
    ASSERT_TRUE(host) << host.error().message;
    EXPECT_TRUE((*host)->lockstep());
    EXPECT_EQ((*host)->default_luminance().cd_per_unit, 250);
    EXPECT_EQ((*host)->default_luminance().source, LuminanceSource::command_line);
    EXPECT_TRUE(fs::exists(status_path()));
    show(**host, 3);
    EXPECT_TRUE((*host)->frames().exit_wanted());
    (*host)->report_error("a remark");
    (*host)->report_error("a remark");
    host->reset();
    EXPECT_FALSE(fs::exists(status_path()));
    const Json report = json_of("report.json");
    for (const char* key : {"version", "device", "hmd", "clock", "application", "frames", "timing_ms", "latency_ms", "effects",
                            "photometry", "state", "errors"})
        EXPECT_TRUE(report.contains(key)) << key;
    EXPECT_EQ(report["clock"], "lockstep");
    EXPECT_EQ(report["application"]["name"], "host_test");
    EXPECT_EQ(report["application"]["extensions"], Json({"XR_KHR_vulkan_enable"}));
    EXPECT_EQ(report["frames"]["submitted"], 3);
    EXPECT_EQ(report["frames"]["displayed"], 3);
    EXPECT_EQ(report["frames"]["missed"], 0);
    EXPECT_EQ(report["photometry"]["scale"], 250.0);
    EXPECT_EQ(report["photometry"]["source"], "command line");
    EXPECT_EQ(report["errors"], Json({"a remark"}));
    EXPECT_FALSE(report["timing_ms"].empty());
    EXPECT_GT(report["process"]["first_frame_s"].get<double>(), 0);
    EXPECT_GT(report["process"]["frames_per_s"].get<double>(), 0);
    EXPECT_GT(report["process"]["peak_memory_mib"].get<double>(), 10);
    EXPECT_EQ(failure_text(), "");
}

TEST_F(HostTest, TellsItsStatusWhileItLives) {
    configure({});
    auto host = open();
    ASSERT_TRUE(host) << host.error().message;
    const auto running = running_runtimes();
    ASSERT_EQ(running.size(), 1u);
    EXPECT_EQ(running[0].pid, getpid());
    const Json& status = running[0].status;
    EXPECT_EQ(status["application"]["name"], "host_test");
    EXPECT_TRUE(status["eye_tracker"]["present"]);
    EXPECT_FALSE(status["effects"].empty());
    EXPECT_NE(status["photometry"]["source"].get<std::string>().find("panel's white"), std::string::npos);
    EXPECT_EQ(json_of("launcher/progress.json")["frames"]["displayed"], 0);
}

// What this process's runtime says to a request.
SettingsAnswer answer_to(const std::string& id) {
    for (int i = 0; i < 500; ++i) {
        for (const RunningRuntime& runtime : running_runtimes())
            if (const auto answer = answer_of(runtime.status); answer && answer->id == id) return *answer;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    ADD_FAILURE() << "no answer";
    return {};
}

TEST_F(HostTest, TakesSettingsWhileItRuns) {
    configure({{"preset", "\"combined\""}});
    auto host = open();
    ASSERT_TRUE(host) << host.error().message;
    const auto choose = [](LiveChoice choice, bool reset = false) {
        static int number = 0;
        const std::string id = std::to_string(++number);
        EXPECT_TRUE(leave_request(getpid(), {id, std::move(choice), reset}));
        return answer_to(id);
    };
    const auto set = [&](std::vector<std::string> settings, bool reset = false) { return choose({"", {}, std::move(settings)}, reset); };
    using List = std::vector<std::string>;
    EXPECT_EQ(set({"glare.age=70", "glare.pigment=1"}).choice.settings, (List{"glare.age=70", "glare.pigment=1"}));
    EXPECT_EQ(set({"glare.age=60"}).choice.settings, (List{"glare.pigment=1", "glare.age=60"}));
    // All or nothing, and the reason with the range.
    const SettingsAnswer wrong = set({"glare.pigment=0", "glare.age=900"});
    EXPECT_NE(wrong.error.find("glare.age = 900 is out of range: 10 to 90"), std::string::npos) << wrong.error;
    EXPECT_EQ(wrong.choice.settings, (List{"glare.pigment=1", "glare.age=60"}));
    EXPECT_NE(set({"glare.photographic=1"}).error.find("counts an effect twice"), std::string::npos);
    EXPECT_NE(set({"nonsense"}).error.find("SLOT.PARAMETER=VALUE"), std::string::npos);
    show(**host, 2);
    EXPECT_EQ(set({}, true).choice.settings, List{});
    // Another model ends the settings of its slot, another preset all that came before; the states of the rest go on.
    EXPECT_EQ(set({"glare.age=70", "tone.knee=0.7"}).error, "");
    const SettingsAnswer other = choose({"", {"glare=cie135"}, {}});
    EXPECT_EQ(other.error, "");
    EXPECT_EQ(other.choice.models, List{"glare=cie135"});
    EXPECT_EQ(other.choice.settings, List{"tone.knee=0.7"});
    show(**host, 2);
    EXPECT_NE(choose({"", {"glare=sparkle"}, {}}).error.find("sparkle"), std::string::npos);
    const SettingsAnswer paper = choose({"luidolt2020", {}, {"tone.key_scale=0.5"}});
    EXPECT_EQ(paper.choice.preset, "luidolt2020") << paper.error;
    EXPECT_EQ(paper.choice.models, List{});
    show(**host, 2);
    EXPECT_EQ(choose({"off", {}, {}}).error, "");
    show(**host, 2);
    EXPECT_EQ(text_of(choose({}, true).choice), "");
    show(**host, 2);
    EXPECT_FALSE(fs::exists(path("entoptic/" + std::to_string(getpid()) + ".set")));
}

TEST_F(HostTest, RecentresTheGazeOnWhatTheWearerLooksAt) {
    // A wearer who looks at a point two metres ahead, and a tracker that takes it for one 6 degrees right and 3 down.
    std::ofstream(path("slipped.toml"))
        << "version = 1\nname = \"slipped\"\nduration_s = 1\nloop = true\n[gaze]\ndirection_deg = [6, -3]\n";
    configure({{"script", toml_string(path("slipped.toml"))}, {"ideal_tracker", "true"}, {"observer", "\"70-years\""}});
    auto host = open();
    ASSERT_TRUE(host) << host.error().message;
    show(**host, 60);
    const auto centre_error = [&] {
        const Observer observer = (*host)->headset().eye_tracker->observer_at((*host)->clock().now());
        double worst = 0;
        for (std::size_t eye = 0; eye < 2; ++eye) {
            EXPECT_EQ(observer.eyes[eye].gaze_provenance, Provenance::measured);
            worst = std::max(worst, glm::length(drivers::angles_of(glm::dvec3(observer.eyes[eye].gaze_direction)) -
                                                target_of_eye((*host)->headset(), eye, drivers::GazeAngles(0))));
        }
        return worst;
    };
    const auto request = [&](bool save) {
        static int number = 0;
        const std::string id = "recentre " + std::to_string(++number);
        SettingsRequest wish;
        wish.id = id;
        wish.recentre_gaze = true;
        wish.save_gaze = save;
        EXPECT_TRUE(leave_request(getpid(), wish));
        return answer_to(id);
    };
    EXPECT_GT(centre_error(), 6);
    const SettingsAnswer answer = request(false);
    EXPECT_EQ(answer.error, "");
    EXPECT_NE(answer.gaze.find("Gaze re-centred"), std::string::npos) << answer.gaze;
    EXPECT_LT(centre_error(), 0.05);
    const std::string file = path("entoptic/observers/70-years.toml");
    EXPECT_FALSE(fs::exists(file));
    // Kept: it holds for the next session, too.
    EXPECT_NE(request(true).gaze.find("70-years.toml"), std::string::npos);
    std::ifstream kept(file);
    const std::string text{std::istreambuf_iterator<char>(kept), {}};
    EXPECT_NE(text.find("age = 70"), std::string::npos) << "it takes the place of the one that comes with the program\n" << text;
    host->reset();
    host = open();
    ASSERT_TRUE(host) << host.error().message;
    show(**host, 60);
    EXPECT_LT(centre_error(), 0.05);
}

TEST_F(HostTest, RecentringWithoutAnEyeTrackerOrAFileIsAnError) {
    std::ofstream(path("lost.toml")) << "version = 1\nname = \"lost\"\nduration_s = 60\n[lost]\neyes = [[0, 60]]\n";
    configure({{"script", toml_string(path("lost.toml"))}});
    auto host = open();
    ASSERT_TRUE(host) << host.error().message;
    show(**host, 60);
    for (const bool save : {false, true}) {
        SettingsRequest wish;
        wish.id = save ? "save" : "recentre";
        wish.recentre_gaze = true;
        wish.save_gaze = save;
        EXPECT_TRUE(leave_request(getpid(), wish));
        std::string error;
        for (int i = 0; i < 500 && error.empty(); ++i) {
            for (const RunningRuntime& runtime : running_runtimes())
                if (const auto answer = answer_of(runtime.status); answer && answer->id == wish.id) error = answer->error;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        EXPECT_NE(error.find(save ? "--observer NAME" : "Neither eye"), std::string::npos) << error;
    }
}

TEST(Resolution, IsThatOfShlaersObservers) {
    const auto arcmin = [](double cd_m2) { return resolved_angle_rad(cd_m2) * 180 / M_PI * 60; };
    // Shlaer 1937 as Larson 1997 fits it: 49 cycles a degree by day, 12 at 0.1 cd/m2, 2 near the absolute threshold.
    EXPECT_NEAR(arcmin(1000), 30 / 49.1, 0.01);
    EXPECT_NEAR(arcmin(0.1), 30 / 11.75, 0.02);
    EXPECT_GT(arcmin(1e-4), 15);
    EXPECT_LT(arcmin(0), 301) << "total darkness is finite";
}

// A scene's eye sees less in the dark only if it is simulated: else the wearer's own looks at what the panel shows.
TEST_F(HostTest, DetailIsTheSceneEyesWhereItsAcuityIsSimulated) {
    for (const bool simulated : {false, true}) {
        configure({{"preset", "\"luidolt2020\""}, {"luminance", "0.001"}, {"models", simulated ? "{}" : "{acuity = \"none\"}"}});
        auto host = open();
        ASSERT_TRUE(host) << host.error().message;
        show(**host, 3);
        const auto adaptation = (*host)->frames().adaptation_cd_m2();
        ASSERT_TRUE(adaptation);
        const double cd_m2 = simulated ? static_cast<double>((*adaptation)[0]) : 130;
        EXPECT_NEAR((*host)->resolved_angles_rad()[0] / resolved_angle_rad(cd_m2), 1, 1e-6) << simulated;
    }
}

TEST_F(HostTest, RequestsThatAreNoneAreRefused) {
    configure({});
    auto host = open();
    ASSERT_TRUE(host) << host.error().message;
    const std::string request = path("entoptic/" + std::to_string(getpid()) + ".set");
    for (const std::string& text :
         {std::string("nonsense"), std::string("[]"), std::string(R"({"id":7})"), std::string(R"({"id":"a","settings":[1]})"),
          std::string(R"({"id":"a","settings":{"b":"c"}})"), std::string(100000, 'x')}) {
        std::ofstream(request) << text;
        for (int i = 0; i < 500 && fs::exists(request); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
        EXPECT_FALSE(fs::exists(request)) << text.substr(0, 40);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(700));
    const auto running = running_runtimes();
    ASSERT_EQ(running.size(), 1u);
    EXPECT_NE(running[0].status["errors"].dump().find("was no request"), std::string::npos) << running[0].status["errors"];
}

TEST_F(HostTest, TheSdrDefaultMapsCodesToThePanelsOwnLight) {
    configure({});
    auto host = open();
    ASSERT_TRUE(host) << host.error().message;
    const LayerLuminance luminance = (*host)->default_luminance();
    const Photometry panel = (*host)->headset().display.photometry;
    EXPECT_EQ(luminance.source, LuminanceSource::default_sdr);
    EXPECT_EQ(luminance.cd_per_unit + luminance.offset_cd, panel.white_cd_m2);
    EXPECT_EQ(luminance.offset_cd, panel.black_cd_m2);
    std::uint32_t width = 0, height = 0;
    (*host)->recommended_eye_size(width, height);
    EXPECT_NEAR(width, 1.6 * 64, 2);
}

TEST_F(HostTest, WhyItCannotStartIsToldToTheLauncher) {
    configure({{"script", "\"no_such_script\""}});
    const auto host = open();
    ASSERT_FALSE(host);
    EXPECT_NE(host.error().message.find("no_such_script"), std::string::npos) << host.error().message;
    EXPECT_NE(failure_text().find("no_such_script"), std::string::npos);
    configure({{"hmd", "\"vive-pro\""}});
    const auto real = open();
    ASSERT_FALSE(real);
    EXPECT_EQ(real.error().kind, ErrorKind::missing);
}

TEST_F(HostTest, AReportThatCannotBeWrittenIsAFailure) {
    configure({{"report", toml_string(path("nowhere/report.json"))}});
    auto host = open();
    ASSERT_TRUE(host) << host.error().message;
    host->reset();
    EXPECT_NE(failure_text().find("nowhere"), std::string::npos);
}

TEST_F(HostTest, DumpsAreWritten) {
    configure({{"dump.dir", toml_string(path("dump"))}, {"dump.stages", "[\"panel\", \"warp\"]"}, {"dump.every", "2"}});
    auto host = open();
    ASSERT_TRUE(host) << host.error().message;
    show(**host, 3);
    host->reset();
    for (const char* name : {"000000_left_panel.png", "000000_right_warp.exr", "000002_left_panel.png"})
        EXPECT_TRUE(fs::exists(path("dump/") + name)) << name;
    EXPECT_FALSE(fs::exists(path("dump/000001_left_panel.png")));
    EXPECT_EQ(failure_text(), "");
}

}  // namespace
}  // namespace entoptic::app
