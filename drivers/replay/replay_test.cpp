// labels: unit
#include "drivers/replay/replay_device.h"

#include "drivers/pupil_labs/testing/eye_pictures.h"
#include "drivers/virtual_hmd/virtual_hmd_device.h"
#include "drivers/vive_pro/testing/vive_model.h"

#include <cmath>
#include <cstring>
#include <filesystem>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace entoptic::drivers {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class ReplayTest : public ::testing::Test {
protected:
    void TearDown() override { fs::remove(path_); }
    std::string path_ = (fs::temp_directory_path() / ("entoptic_replay_" + std::to_string(getpid()) + ".etp")).string();
};

Json description(const char* hmd) {
    return {{"version", 1}, {"hmd", hmd}, {"panel_width", 720}, {"panel_height", 800}, {"ipd_mm", 64}, {"eye_tracker", true}};
}

TEST_F(ReplayTest, AVirtualSessionComesBackAsItWas) {
    DriverOptions options;
    options.script = "saccades";
    options.start_time = 50 * ns_per_s;
    const auto live = open_headset(options);
    ASSERT_TRUE(live);
    {
        auto writer = RecordingWriter::create(path_, description("virtual").dump(), options.start_time);
        ASSERT_TRUE(writer);
        std::array<TimeNs, 2> last{};
        for (TimeNs t = options.start_time; t < options.start_time + 3 * ns_per_s; t += 1'000'000) {
            (*writer)->add(Stream::pose, t, encode_pose(t, live->head->pose_at(t)));
            for (int eye = 0; eye < 2; ++eye) {
                const auto sample = live->eye_tracker->raw_at(eye, t);
                if (!sample || sample->time == last[static_cast<std::size_t>(eye)]) continue;
                last[static_cast<std::size_t>(eye)] = sample->time;
                (*writer)->add(Stream::eye, t, encode_eye(eye, *sample));
            }
        }
    }
    options.name = "replay";
    options.script = path_;
    options.start_time = 7 * ns_per_s;
    options.panel_width = 900;  // of this run
    const auto replay = open_headset(options);
    ASSERT_TRUE(replay) << replay.error().message;
    EXPECT_EQ(replay->display.panel_width, 900);
    EXPECT_NEAR(double(replay->eyes[1].head_from_eye.position.x), 0.032, 1e-6);
    EXPECT_TRUE(replay->eye_tracker->present());
    for (TimeNs t = 0; t < 2900; t += 7) {
        const PoseState a = live->head->pose_at(50 * ns_per_s + t * 1'000'000), b = replay->head->pose_at(7 * ns_per_s + t * 1'000'000);
        EXPECT_NEAR(std::abs(glm::dot(a.pose.orientation, b.pose.orientation)), 1, 1e-5) << t;
        EXPECT_LT(glm::length(a.pose.position - b.pose.position), 1e-4f) << t;
        const auto raw = replay->eye_tracker->raw_at(0, 7 * ns_per_s + t * 1'000'000),
                   was = live->eye_tracker->raw_at(0, 50 * ns_per_s + t * 1'000'000);
        ASSERT_EQ(raw.has_value(), was.has_value()) << t;
        if (raw) {
            EXPECT_EQ(raw->time - 7 * ns_per_s, was->time - 50 * ns_per_s);
            EXPECT_EQ(raw->gaze_direction, was->gaze_direction);
        }
        EXPECT_TRUE(std::isfinite(replay->eye_tracker->observer_at(7 * ns_per_s + t * 1'000'000).gaze_direction.x));
    }
    EXPECT_FALSE(replay->head->pose_at(20 * ns_per_s).orientation_tracked);  // past the end
}

TEST_F(ReplayTest, AVivesReportsGiveTheSamePosesToTheBit) {
    vive_pro::testing::ViveModel model;
    model.motion = {0.5, 0.3, 0.1};
    const TimeNs start = 30 * ns_per_s;
    vive_pro::Tracker live(model.calibration(), {});
    std::vector<PoseState> poses;
    {
        Json about = description("vive-pro");
        about["configuration"] = vive_pro::testing::example_configuration();
        about["ranges"] = {{"acceleration_m_s2", vive_pro::ImuRanges{}.acceleration},
                           {"angular_rate_rad_s", vive_pro::ImuRanges{}.angular_rate}};
        auto writer = RecordingWriter::create(path_, about.dump(), start);
        ASSERT_TRUE(writer);
        for (std::int64_t n = 0; n < 3000; ++n) {
            const TimeNs arrival = start + n * 1'000'000 + static_cast<TimeNs>(mix64(static_cast<std::uint64_t>(n)) % 900'000);
            Payload record{0};
            const auto report = model.imu_report(n);
            record.insert(record.end(), report.begin(), report.end());
            (*writer)->add(Stream::vive_report, arrival, record);
            live.imu_report(report, arrival);
            poses.push_back(live.pose_at(start + n * 1'000'000 + 950'000));
        }
    }
    auto session = load_session(path_);
    ASSERT_TRUE(session) << session.error().message;
    EXPECT_EQ(session->reports.size(), 3000u);
    const TimeNs shift = 4 * ns_per_s - session->start;
    const auto headset = replay_headset(std::make_shared<const RecordedSession>(*session), 4 * ns_per_s);
    ASSERT_TRUE(headset) << headset.error().message;
    EXPECT_EQ(headset->display.panel_width, 1440);
    for (std::size_t n = 0; n < poses.size(); ++n) {
        const PoseState again = headset->head->pose_at(start + static_cast<TimeNs>(n) * 1'000'000 + 950'000 + shift);
        ASSERT_EQ(again.pose.orientation, poses[n].pose.orientation) << n;
        ASSERT_EQ(again.pose.position, poses[n].pose.position) << n;
    }
}

TEST_F(ReplayTest, EyePicturesAreSeenAgainByTheSameDetector) {
    const char* product = "Pupil Cam3 ID1";
    EyeProcessor live(0, pupil_labs_camera(product, 192, 192));
    std::vector<std::optional<RawEyeSample>> seen;
    const TimeNs start = 9 * ns_per_s, period = 5'000'000;
    {
        auto writer = RecordingWriter::create(path_, description("virtual").dump(), start);
        ASSERT_TRUE(writer);
        for (std::uint32_t n = 0; n < 480; ++n) {
            std::vector<std::uint8_t> jpeg = testing::eye_pictures()[n % 24];
            if (n == 350) jpeg.resize(jpeg.size() / 2);  // one that was cut on its way
            const TimeNs arrival = start + n * period;
            (*writer)->add(Stream::eye_picture, arrival, encode_eye_picture({0, product, 192, 192, arrival - 3'000'000, n, jpeg}));
            seen.push_back(live.process({jpeg, arrival - 3'000'000, n}, arrival));
        }
    }
    ASSERT_TRUE(live.model().fitted());
    DriverOptions options;
    options.name = "replay";
    options.script = path_;
    options.start_time = 2 * ns_per_s;
    const auto replay = open_headset(options);
    ASSERT_TRUE(replay) << replay.error().message;
    std::size_t with_gaze = 0;
    for (std::size_t n = 0; n < seen.size(); ++n) {
        if (!seen[n]) continue;  // the cut one
        const auto raw = replay->eye_tracker->raw_at(0, options.start_time + static_cast<TimeNs>(n) * period);
        ASSERT_TRUE(raw) << n;
        EXPECT_EQ(std::memcmp(&raw->gaze_direction, &seen[n]->gaze_direction, sizeof raw->gaze_direction), 0) << n;
        EXPECT_EQ(std::memcmp(&raw->pupil_diameter_mm, &seen[n]->pupil_diameter_mm, sizeof(float)), 0) << n;
        EXPECT_EQ(raw->confidence, seen[n]->confidence) << n;
        EXPECT_EQ(raw->time - options.start_time, seen[n]->time - start) << n;
        with_gaze += std::isfinite(raw->gaze_direction.z);
    }
    EXPECT_GT(with_gaze, 100u);
    EXPECT_FALSE(seen[350]);
    EXPECT_NE(replay->eye_tracker->description().find("480 pictures"), std::string::npos) << replay->eye_tracker->description();
    // More pictures than there may be: the session is loaded without them, and says so.
    const auto without = load_session(path_, 10'000);
    ASSERT_TRUE(without) << without.error().message;
    EXPECT_TRUE(without->pictures_left_out && without->pictures.empty());
    EXPECT_FALSE(load_session(path_)->pictures_left_out);
}

TEST_F(ReplayTest, WrongDescriptionsAreErrors) {
    for (const Json& about : {Json::array(), Json{{"version", 2}},
                              [] {
                                  Json j = description("virtual");
                                  j["ipd_mm"] = 1e9;
                                  return j;
                              }(),
                              [] {
                                  Json j = description("vive-pro");
                                  j["configuration"] = "{}";
                                  return j;
                              }()}) {
        fs::remove(path_);
        ASSERT_TRUE(RecordingWriter::create(path_, about.dump(), 0));
        EXPECT_FALSE(load_session(path_)) << about.dump();
    }
    DriverOptions options;
    options.name = "replay";
    const auto none = open_headset(options);
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().kind, ErrorKind::usage);
}

}  // namespace
}  // namespace entoptic::drivers
