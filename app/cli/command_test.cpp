// labels: unit
// The command line itself: help, versions, exit codes, and documents that keep their promised form.
#include "app/testing/command_line.h"

#include <set>

namespace entoptic::app {
namespace {

using Json = nlohmann::ordered_json;

class Command : public testing::CommandLineTest {};

TEST_F(Command, HelpAndVersionGoToStandardOutput) {
    const auto help = entoptic({"--help"});
    EXPECT_EQ(help.status, 0);
    for (const char* name : {"run", "simulate", "effects", "curve", "set", "status", "bench", "config"})
        EXPECT_NE(help.out.find(name), std::string::npos) << name;
    const auto version = entoptic({"--version"});
    EXPECT_EQ(version.status, 0);
    EXPECT_EQ(version.out, "entoptic " ENTOPTIC_VERSION "\n");
    const auto run = entoptic({"run", "--help"});
    EXPECT_EQ(run.status, 0);
    for (const char* option : {"--hmd", "--panel", "--eye-scale", "--clock", "--script", "--frames", "--dump", "--dump-stages",
                               "--dump-every", "--preset", "--model", "--set", "--observer", "--luminance", "--report"})
        EXPECT_NE(run.out.find(option), std::string::npos) << option;
}

TEST_F(Command, WrongUsageIsTwo) {
    expect_error(2, "--help", {});
    expect_error(2, "--help", {"dance"});
    expect_error(2, "effects --help", {"effects", "--loud"});
    expect_error(2, "hello_xr", {"run"});
}

TEST_F(Command, EffectsKeepTheirSchema) {
    const auto outcome = entoptic({"effects", "--json"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    const Json document = outcome.json();
    std::set<std::string> slots;
    for (const Json& slot : document.at("slots")) {
        const std::string name = slot.at("slot");
        EXPECT_TRUE(slots.insert(name).second) << name;
        std::set<std::string> models;
        for (const Json& model : slot.at("models")) {
            models.insert(model.at("name").get<std::string>());
            for (const Json& p : model.at("parameters")) {
                EXPECT_TRUE(p.at("name").is_string() && p.at("unit").is_string() && p.at("source").is_string());
                EXPECT_LE(p.at("min").get<double>(), p.at("default").get<double>()) << name << '.' << p.at("name");
                EXPECT_GE(p.at("max").get<double>(), p.at("default").get<double>()) << name << '.' << p.at("name");
                EXPECT_FALSE(p.at("source").get<std::string>().empty());
            }
        }
        EXPECT_TRUE(models.count(slot.at("default"))) << name;
    }
    std::set<std::string> presets;
    for (const Json& preset : document.at("presets")) {
        presets.insert(preset.at("name").get<std::string>());
        for (const auto& [slot, model] : preset.at("models").items()) EXPECT_TRUE(slots.count(slot)) << slot;
    }
    EXPECT_TRUE(presets.count("off") && presets.count("luidolt2020") && presets.count("luidolt2020_as_printed"));
    EXPECT_NE(entoptic({"effects"}).out.find("luidolt2020"), std::string::npos);
}

TEST_F(Command, StatusSaysThatNothingRuns) {
    const auto outcome = entoptic({"status"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.out.find("No runtime is running"), std::string::npos) << outcome.out;
    EXPECT_EQ(entoptic({"status", "--json"}).json().at("runtimes"), Json::array());
}

TEST_F(Command, StatusListsTheLivingAndForgetsTheDead) {
    write("run/entoptic/" + std::to_string(getpid()) + ".json",
          R"({"version":"0.1.0","application":{"name":"demo"},"frames":{"displayed":3}})");
    write("run/entoptic/999999999.json", R"({"version":"0.1.0"})");
    write("run/entoptic/notes.txt", "mine");
    const Json document = entoptic({"status", "--json"}).json();
    ASSERT_EQ(document.at("runtimes").size(), 1u);
    EXPECT_EQ(document.at("runtimes")[0].at("pid"), getpid());
    EXPECT_EQ(document.at("runtimes")[0].at("frames").at("displayed"), 3);
    EXPECT_FALSE(testing::fs::exists(path("run/entoptic/999999999.json")));
    EXPECT_TRUE(testing::fs::exists(path("run/entoptic/notes.txt")));
    EXPECT_NE(entoptic({"status"}).out.find("demo"), std::string::npos);
}

TEST_F(Command, RunHandsThroughWhatTheApplicationDoes) {
    EXPECT_EQ(entoptic({"run", "--", "true"}).status, 0);
    EXPECT_EQ(entoptic({"run", "--", "sh", "-c", "exit 7"}).status, 7);
    EXPECT_EQ(entoptic({"run", "--", "sh", "-c", "kill -9 $$"}).status, 128 + 9);
    EXPECT_EQ(entoptic({"run", "--", "/nowhere/at/all"}).status, 127);
    EXPECT_EQ(entoptic({"run", "--", "sh", "-c", "echo \"$0 $1\"", "--frames", "--"}).out, "--frames --\n");
}

TEST_F(Command, RunSetsTheRuntimeAndLeavesNothingBehind) {
    const auto outcome = entoptic({"run", "--panel", "320x360", "--set", "tone.knee=0.7", "--set", "tone.knee=0.75", "--", "sh", "-c",
                                   "cat $XR_RUNTIME_JSON $ENTOPTIC_CONFIG"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("libopenxr_entoptic.so"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.out.find("panel = \"320x360\""), std::string::npos) << outcome.out;
    EXPECT_TRUE(testing::fs::is_empty(path("run")));
}

TEST_F(Command, RunsRuntimeFailureIs125) {
    const auto outcome = entoptic({"run", "--", "sh", "-c", "echo no device > $(dirname $ENTOPTIC_CONFIG)/failure; exit 3"});
    EXPECT_EQ(outcome.status, 125);
    EXPECT_NE(outcome.err.find("no device"), std::string::npos) << outcome.err;
}

TEST_F(Command, RunPassesSignalsOn) {
    const auto outcome = entoptic({"run", "--", "sh", "-c", "trap 'exit 9' TERM; kill -TERM $PPID; sleep 5; exit 1"});
    EXPECT_EQ(outcome.status, 9) << outcome.err;
}

TEST_F(Command, RunWithoutAReportStillPrintsADocument) {
    const auto outcome = entoptic({"run", "--json", "--", "echo", "hello"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.err.find("hello"), std::string::npos);
    EXPECT_EQ(outcome.json().at("errors").size(), 1u);
}

TEST_F(Command, RunChecksItsOptionsFirst) {
    const auto call = [](std::vector<std::string> options) {
        options.insert(options.begin(), "run");
        options.insert(options.end(), {"--", "touch", "/tmp/entoptic_must_not_exist"});
        return options;
    };
    expect_error(2, "--panel", call({"--panel", "big"}));
    expect_error(2, "--panel", call({"--panel", "8x8"}));
    expect_error(2, "eye-scale", call({"--eye-scale", "9"}));
    expect_error(2, "lockstep", call({"--clock", "sundial"}));
    expect_error(2, "luidolt2020", call({"--preset", "nonsense"}));
    write("config/entoptic/config.toml", "frames = 3\n[settings]\nglare.age = 840\n");
    expect_error(2, "config.toml:3: glare.age = 840 is out of range: 10 to 90 years.", call({}));
    write("config/entoptic/config.toml", "[settings]\nfoveation.inverse = \"sideways\"\n");
    expect_error(2, "off, exact or fitted", call({}));
    write("config/entoptic/config.toml", "");
    expect_error(2, "own lid", call({"--model", "eyelid=blink"}));
    expect_error(2, "SLOT=NAME", call({"--model", "glare"}));
    expect_error(2, "tone.knee", call({"--set", "tone.knee=lots"}));
    expect_error(2, "--dump", call({"--dump-every", "3"}));
    expect_error(2, "panel", call({"--dump", path("d"), "--dump-stages", "warp,soup"}));
    expect_error(2, "luminance", call({"--luminance", "1e9"}));
    expect_error(2, "no_such_script", call({"--script", "no_such_script"}));
    expect_error(3, "No Vive Pro", call({"--hmd", "vive-pro"}));
    expect_error(1, "no folder", call({"--report", path("nowhere/report.json")}));
    expect_error(2, "nobody", call({"--observer", "nobody"}));
    expect_error(2, "counts an effect twice", call({"--model", "acuity=krawczyk_larson"}));
    EXPECT_FALSE(testing::fs::exists("/tmp/entoptic_must_not_exist"));
}

}  // namespace
}  // namespace entoptic::app
