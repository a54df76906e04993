// labels: unit
#include "drivers/recording/recording.h"

#include "base/noise.h"
#include "drivers/recording/recorded_samples.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <unistd.h>

namespace entoptic::drivers {
namespace {

namespace fs = std::filesystem;

class RecordingTest : public ::testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    std::string bytes_of(const std::string& name) const {
        std::ifstream in(path(name), std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    void write(const std::string& name, const std::string& bytes) const { std::ofstream(path(name), std::ios::binary) << bytes; }
    fs::path folder_ = fs::temp_directory_path() / ("entoptic_recording_" + std::to_string(getpid()));
};

void write_records(const std::string& path, int count) {
    auto writer = RecordingWriter::create(path, "{\"version\": 1}", 5);
    ASSERT_TRUE(writer) << writer.error().message;
    for (int i = 0; i < count; ++i) (*writer)->add(Stream::event, 1000 + i, std::string(static_cast<std::size_t>(i), 'x'));
    ASSERT_TRUE((*writer)->close());
}

std::vector<Record> read_records(const std::string& path, std::uint64_t& lost) {
    std::vector<Record> out;
    auto reader = RecordingReader::open(path);
    EXPECT_TRUE(reader) << reader.error().message;
    if (!reader) return out;
    while (auto record = reader->next()) out.push_back(std::move(*record));
    lost = reader->lost_bytes();
    return out;
}

TEST_F(RecordingTest, EverythingComesBack) {
    write_records(path("a"), 50);
    std::uint64_t lost = 9;
    const auto records = read_records(path("a"), lost);
    ASSERT_EQ(records.size(), 50u);
    EXPECT_EQ(lost, 0u);
    for (std::size_t i = 0; i < records.size(); ++i) {
        EXPECT_EQ(records[i].time, 1000 + static_cast<TimeNs>(i));
        EXPECT_EQ(records[i].payload.size(), i);
    }
    EXPECT_EQ(RecordingReader::open(path("a"))->description(), "{\"version\": 1}");
    EXPECT_FALSE(RecordingWriter::create(path("a"), "{}", 0));  // never overwritten
}

TEST_F(RecordingTest, CutAnywhereItKeepsWhatCameBefore) {
    write_records(path("whole"), 12);
    const std::string bytes = bytes_of("whole");
    std::size_t most = 0;
    for (std::size_t length = 0; length < bytes.size(); ++length) {
        write("cut", bytes.substr(0, length));
        auto reader = RecordingReader::open(path("cut"));
        if (!reader) {
            EXPECT_LT(length, 8u + 16 + 14 + 4) << "the description was there";
            continue;
        }
        std::size_t count = 0;
        while (const auto record = reader->next()) EXPECT_EQ(record->payload.size(), count++);
        EXPECT_GE(count, most);
        most = count;
    }
    EXPECT_EQ(most, 11u);
}

TEST_F(RecordingTest, DamageEndsTheRecordingThereAndIsSaid) {
    write_records(path("whole"), 12);
    const std::string bytes = bytes_of("whole");
    for (std::uint64_t i = 0; i < 500; ++i) {
        std::string damaged = bytes;
        const std::size_t at = 42 + mix64(i) % (bytes.size() - 42);
        damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1 + mix64(~i) % 255));
        write("damaged", damaged);
        std::uint64_t lost = 0;
        const auto records = read_records(path("damaged"), lost);
        EXPECT_LT(records.size(), 12u) << at;
        EXPECT_GT(lost, 0u);
        for (std::size_t k = 0; k < records.size(); ++k) EXPECT_EQ(records[k].payload.size(), k);
    }
}

TEST_F(RecordingTest, OtherFilesAreRefused) {
    write("text", "This is a text of some length, and no recording.");
    write("newer", "ENTREC9\n");
    for (const char* name : {"text", "newer", "missing", ""}) EXPECT_FALSE(RecordingReader::open(path(name))) << name;
}

TEST_F(RecordingTest, IsInTheFileBeforeItIsClosed) {
    auto writer = RecordingWriter::create(path("a"), "{}", 0);
    ASSERT_TRUE(writer);
    for (TimeNs t = 0; t < ns_per_s; t += 1'000'000) (*writer)->add(Stream::event, t, "x");
    std::uint64_t lost = 0;
    EXPECT_GE(read_records(path("a"), lost).size(), 890u);  // as after a crash: at most a tenth of a second is missing
}

TEST(RecordedSamples, ComeBack) {
    PoseState pose;
    pose.pose.position = {1, -2, 3};
    pose.pose.orientation = glm::angleAxis(0.7f, glm::vec3(0, 0, 1));
    pose.linear_velocity = {4, 5, 6};
    pose.angular_velocity = {-7, 8, 9};
    pose.orientation_valid = pose.position_tracked = true;
    const auto back = decode_pose(encode_pose(-5, pose));
    ASSERT_TRUE(back);
    EXPECT_EQ(back->time, -5);
    EXPECT_EQ(back->state.pose.position, pose.pose.position);
    EXPECT_EQ(back->state.pose.orientation, pose.pose.orientation);
    EXPECT_EQ(back->state.angular_velocity, pose.angular_velocity);
    EXPECT_TRUE(back->state.orientation_valid && back->state.position_tracked);
    EXPECT_FALSE(back->state.position_valid || back->state.orientation_tracked || back->state.velocity_valid);

    const RawEyeSample sample{10, 20, {0.1f, 0.2f, -0.9f}, std::nanf(""), 0.5f};
    const auto eye = decode_eye(encode_eye(1, sample));
    ASSERT_TRUE(eye);
    EXPECT_EQ(eye->eye, 1);
    EXPECT_EQ(eye->sample.arrival, 20);
    EXPECT_TRUE(std::isnan(eye->sample.pupil_diameter_mm));
}

TEST(RecordedSamples, PicturesComeBackAsTheyWere) {
    const EyePicture picture{1, "Pupil Cam2 ID0", 192, 192, -7, 42, {0xff, 0xd8, 0, 1, 2}};
    const Payload payload = encode_eye_picture(picture);
    const auto back = decode_eye_picture(payload);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->eye, 1);
    EXPECT_EQ(back->product, picture.product);
    EXPECT_EQ(back->width, 192);
    EXPECT_EQ(back->time, -7);
    EXPECT_EQ(back->sequence, 42u);
    EXPECT_EQ(back->jpeg, picture.jpeg);
    for (std::size_t length = 0; length < payload.size() - picture.jpeg.size(); ++length)
        EXPECT_FALSE(decode_eye_picture(std::span(payload).first(length))) << "cut before the picture";
    EyePicture wrong = picture;
    wrong.eye = 2;
    EXPECT_FALSE(decode_eye_picture(encode_eye_picture(wrong)));
    wrong = picture;
    wrong.height = 0;
    EXPECT_FALSE(decode_eye_picture(encode_eye_picture(wrong)));
}

TEST(RecordedSamples, WrongPayloadsAreNone) {
    Payload pose = encode_pose(1, {}), eye = encode_eye(0, {});
    for (std::size_t length = 0; length < pose.size(); ++length) EXPECT_FALSE(decode_pose(std::span(pose).first(length)));
    for (std::size_t length = 0; length < eye.size(); ++length) EXPECT_FALSE(decode_eye(std::span(eye).first(length)));
    eye[0] = 2;
    EXPECT_FALSE(decode_eye(eye));
    for (std::size_t i = 20; i < 36; ++i) pose[i] = 0xff;  // a quaternion of NaN
    EXPECT_FALSE(decode_pose(pose));
}

}  // namespace
}  // namespace entoptic::drivers
