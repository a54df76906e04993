// labels: unit
// Record, replay and export as people run them; doctor and runtime.
#include "app/testing/command_line.h"
#include "drivers/recording/recorded_samples.h"
#include "drivers/recording/recording.h"

#include <algorithm>
#include <set>
#include <zlib.h>

namespace entoptic::app {
namespace {

class RecordTest : public testing::CommandLineTest {
protected:
    std::string recording(const std::string& seconds = "2") {
        const auto made = entoptic({"record", path("s.etp"), "--script", "saccades", "--clock", "lockstep", "--seconds", seconds});
        EXPECT_EQ(made.status, 0) << made.err;
        return path("s.etp");
    }
    static std::string gunzip(const std::string& file) {
        std::string out(1 << 20, '\0');
        gzFile in = gzopen(file.c_str(), "rb");
        if (!in) return "";
        const int got = gzread(in, out.data(), static_cast<unsigned>(out.size()));
        gzclose(in);
        out.resize(static_cast<std::size_t>(std::max(0, got)));
        return out;
    }
};

TEST_F(RecordTest, ReplayOfALockstepRecordingSaysWhatIsInItAndGivesTheSamePoses) {
    const std::string file = recording();
    const auto again = entoptic({"replay", file, "--json", "--csv", path("out.csv")});
    ASSERT_EQ(again.status, 0) << again.err;
    const auto json = again.json();
    EXPECT_EQ(json["hmd"], "virtual");
    EXPECT_NEAR(json["seconds"].get<double>(), 2, 0.01);
    EXPECT_EQ(json["poses"], 500);
    EXPECT_NEAR(json["eye_samples"].get<double>(), 2 * 2 * 200, 8);  // two eyes at 200 Hz, but for what is still under way at the end
    EXPECT_EQ(json["lost_bytes"], 0);
    EXPECT_EQ(json["malformed"], 0);
    EXPECT_LT(json["orientation_difference_deg"].get<double>(), 1e-3);
    EXPECT_NE(testing::text_of(path("out.csv")).find("pupil_left_mm"), std::string::npos);
}

TEST_F(RecordTest, TwoLockstepRecordingsAreTheSameAndNoneIsOverwritten) {
    const std::string first = testing::text_of(recording("1"));
    EXPECT_EQ(entoptic({"record", path("s.etp"), "--clock", "lockstep", "--seconds", "1"}).status, 1);
    testing::fs::remove(path("s.etp"));
    EXPECT_EQ(testing::text_of(recording("1")), first);
}

TEST_F(RecordTest, ARecordingThatWasCutIsReadToThere) {
    const std::string bytes = testing::text_of(recording());
    write("cut.etp", bytes.substr(0, bytes.size() / 2 + 3));
    const auto again = entoptic({"replay", path("cut.etp"), "--json"});
    ASSERT_EQ(again.status, 0) << again.err;
    EXPECT_GT(again.json()["lost_bytes"].get<int>(), 0);
    EXPECT_NEAR(again.json()["seconds"].get<double>(), 1, 0.1);
    write("no.etp", "hello");
    EXPECT_EQ(entoptic({"replay", path("no.etp")}).status, 1);
}

TEST_F(RecordTest, ExportsBidsWithUnits) {
    const auto made = entoptic({"export", recording(), "-o", path("sub-01_task-look")});
    ASSERT_EQ(made.status, 0) << made.err;
    for (const std::string eye : {"1", "2"}) {
        const auto sidecar = nlohmann::json::parse(testing::text_of(path("sub-01_task-look_recording-eye" + eye + "_physio.json")));
        EXPECT_EQ(sidecar["PhysioType"], "eyetrack");
        EXPECT_EQ(sidecar["RecordedEye"], eye == "1" ? "left" : "right");
        EXPECT_EQ(sidecar["x_coordinate"]["Units"], "degree");
        EXPECT_EQ(sidecar["pupil_size"]["Units"], "mm");
        EXPECT_GT(sidecar["SamplingFrequency"].get<double>(), 20);
        const std::string table = gunzip(path("sub-01_task-look_recording-eye" + eye + "_physio.tsv.gz"));
        const std::string first = table.substr(0, table.find('\n'));
        EXPECT_EQ(std::count(first.begin(), first.end(), '\t') + 1, static_cast<std::ptrdiff_t>(sidecar["Columns"].size())) << first;
        EXPECT_TRUE(std::isdigit(static_cast<unsigned char>(first[0])) || first[0] == '-')
            << "BIDS tables of this kind have no header: " << first;
    }
    const auto frames = nlohmann::json::parse(testing::text_of(path("sub-01_task-look_tracksys-head_channels.json")));
    EXPECT_EQ(frames["reference_frame"]["Levels"]["stage"]["SpatialAxes"], "RSP");
    const std::string channels = testing::text_of(path("sub-01_task-look_tracksys-head_channels.tsv"));
    EXPECT_NE(channels.find("head_pos_x\tx\tPOS\thead\tm"), std::string::npos);
    const std::string motion = testing::text_of(path("sub-01_task-look_tracksys-head_motion.tsv"));
    EXPECT_EQ(std::count(motion.begin(), motion.end(), '\n'), 500);
}

TEST_F(RecordTest, ExportsCsv) {
    ASSERT_EQ(entoptic({"export", recording("1"), "--format", "csv", "-o", path("t")}).status, 0);
    EXPECT_EQ(testing::text_of(path("t_eyes.csv")).rfind("time_s,eye,x_deg,y_deg,pupil_mm,confidence,arrival_s\n", 0), 0u);
    EXPECT_EQ(testing::text_of(path("t_head.csv")).rfind("x_m,y_m,z_m,qx,qy,qz,qw,time_s\n", 0), 0u);
}

TEST_F(RecordTest, ExportsTheEyeCamerasPicturesAsTheyCame) {
    // The virtual headset has no cameras.
    const auto none = entoptic({"export", recording("0.1"), "--format", "pictures", "-o", path("p")});
    EXPECT_NE(none.status, 0);
    EXPECT_NE(none.err.find("holds no pictures"), std::string::npos) << none.err;
    const std::string description = R"({"version":1,"hmd":"virtual","panel_width":720,"panel_height":800,"ipd_mm":63,"eye_tracker":true})";
    {
        auto writer = drivers::RecordingWriter::create(path("c.etp"), description, 1'000'000'000);
        ASSERT_TRUE(writer);
        for (int eye : {1, 0})
            (*writer)->add(
                drivers::Stream::eye_picture, 1'010'000'000,
                drivers::encode_eye_picture({eye, "Pupil \"Cam\"", 192, 192, 1'005'000'000, 7, {0xff, 0xd8, std::uint8_t(eye)}}));
    }
    ASSERT_EQ(entoptic({"export", path("c.etp"), "--format", "pictures", "-o", path("p")}).status, 0);
    EXPECT_EQ(testing::text_of(path("p_000000_right.jpg")), (std::string{char(0xff), char(0xd8), 1}));
    EXPECT_EQ(testing::text_of(path("p_000001_left.jpg")), (std::string{char(0xff), char(0xd8), 0}));
    const std::string list = testing::text_of(path("p_pictures.csv"));
    EXPECT_NE(list.find("\"p_000000_right.jpg\",right,-0.005000,0.000000,7,\"Pupil \"\"Cam\"\"\"\n"), std::string::npos) << list;
}

TEST_F(RecordTest, ARealHeadsetThatIsNotThereIsSaid) {
    const auto none = entoptic({"record", path("v.etp"), "--hmd", "vive-pro", "--seconds", "1"});
    EXPECT_EQ(none.status, 3);
    EXPECT_NE(none.err.find("No Vive Pro"), std::string::npos) << none.err;
    EXPECT_FALSE(testing::fs::exists(path("v.etp")));
    EXPECT_EQ(entoptic({"record", path("v.etp"), "--hmd", "vive-pro", "--clock", "lockstep"}).status, 2);
}

TEST_F(RecordTest, DoctorNamesEachFindingWithWhatMendsIt) {
    const auto examined = entoptic({"doctor", "--json"});
    ASSERT_TRUE(examined.status == 0 || examined.status == 3) << examined.err;
    const auto json = examined.json();
    std::set<std::string> checks;
    for (const auto& finding : json["findings"]) {
        checks.insert(finding["check"]);
        EXPECT_FALSE(finding["what"].get<std::string>().empty());
        if (finding["state"] == "problem") { EXPECT_FALSE(finding["mend"].get<std::string>().empty()) << finding.dump(); }
    }
    for (const char* check : {"vulkan", "runtime", "active runtime", "loader", "configuration", "permissions", "headset", "eye camera"})
        EXPECT_TRUE(checks.count(check)) << check;
}

TEST_F(RecordTest, RuntimeSetAndRestore) {
    EXPECT_EQ(entoptic({"runtime", "status", "--json"}).json()["active"], false);
    ASSERT_EQ(entoptic({"runtime", "set"}).status, 0);
    EXPECT_EQ(entoptic({"runtime", "status", "--json"}).json()["active"], true);
    ASSERT_EQ(entoptic({"runtime", "restore"}).status, 0);
    EXPECT_EQ(entoptic({"runtime", "status", "--json"}).json()["active"], false);
    EXPECT_EQ(entoptic({"runtime"}).status, 2);
}

}  // namespace
}  // namespace entoptic::app
