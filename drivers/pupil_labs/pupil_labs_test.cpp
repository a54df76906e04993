// labels: unit fault
// Two cameras behind the seam of system calls, showing traced eyes: samples, faults, unplugging, and what the user is told.
#include "drivers/eye_tracking/gaze_angles.h"
#include "drivers/pupil_labs/pupil_labs_device.h"
#include "drivers/pupil_labs/pupil_labs_tracker.h"
#include "drivers/pupil_labs/testing/eye_pictures.h"
#include "drivers/v4l2_camera/testing/fake_cameras.h"

#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <linux/v4l2-controls.h>
#include <mutex>

namespace entoptic::drivers {
namespace {

using testing::eye_at;
using testing::eye_pictures;
using testing::FakePicture;
using testing::FakeVideoSystem;
using testing::jpeg_of;
using testing::striped_picture;

CompressedFrame frame_of(const std::vector<std::uint8_t>& bytes, TimeNs time) { return {bytes, time, 0}; }

TEST(EyeProcessor, MeasuresGazeAndPupilOfAnEyeThatLooksAround) {
    EyeProcessor processor(0, pupil_labs_camera("Pupil Cam3 ID1", 192, 192));
    const double entrance = 2 * 2 * EyeDimensions{}.entrance_magnification();
    std::vector<RawEyeSample> late;
    for (int i = 0; i < 480; ++i) {
        const TimeNs time = TimeNs{i + 1} * 5'000'000;
        const auto sample = processor.process(frame_of(eye_pictures()[static_cast<std::size_t>(i % 24)], time), time + 8'000'000);
        ASSERT_TRUE(sample);
        EXPECT_GT(sample->confidence, 0.8f);
        EXPECT_FALSE(sample->pupil_diameter_mm == 0) << "no zero pupil";
        if (i >= 456) late.push_back(*sample);
    }
    for (std::size_t i = 0; i < late.size(); ++i) {
        EXPECT_NEAR(late[i].pupil_diameter_mm, entrance, 0.2);
        // From the camera's side left and right change places: the eye looks to the picture's right, which is the wearer's left.
        const Eigen::Vector3d axis = eye_at(static_cast<int>(i)).pose.optical_axis;
        const GazeAngles angles = angles_of(glm::dvec3(late[i].gaze_direction));
        EXPECT_NEAR(angles.x, std::atan2(-axis.x(), -axis.z()) * degrees_per_radian, 2.5);
        EXPECT_NEAR(angles.y, std::asin(-axis.y()) * degrees_per_radian, 2.5);
    }
}

TEST(EyeProcessor, TheUpsideDownEyeIsTurnedBack) {
    EyeProcessor processor(1, pupil_labs_camera("Pupil Cam3 ID0", 192, 192));
    std::optional<RawEyeSample> sample;
    double up_and_down = 0;
    for (int i = 0; i < 480; ++i) {
        testing::TracedEye eye = eye_at(i % 24);
        sample = processor.process(frame_of(eye_pictures()[static_cast<std::size_t>(i % 24)], TimeNs{i + 1} * 5'000'000),
                                   TimeNs{i + 2} * 5'000'000);
        // The picture's down (+y) is up for a camera that hangs upside down.
        if (i >= 456) up_and_down += sample->gaze_direction.y * static_cast<float>(eye.pose.optical_axis.y());
    }
    EXPECT_GT(up_and_down, 0.05);
}

TEST(EyeProcessor, DropsCorruptAndStripedPicturesAndCountsThem) {
    EyeProcessor processor(0, pupil_labs_camera("Pupil Cam3 ID1", 192, 192));
    const auto& good = eye_pictures()[0];
    EXPECT_FALSE(processor.process(frame_of({good.begin(), good.begin() + static_cast<long>(good.size() / 2)}, 1), 2));
    EXPECT_FALSE(processor.process(frame_of({}, 1), 2));
    EXPECT_FALSE(processor.process(frame_of(jpeg_of(striped_picture()), 1), 2));
    EXPECT_TRUE(processor.process(frame_of(good, 1), 2));
    EXPECT_EQ(processor.counts().corrupt, 2u);
    EXPECT_EQ(processor.counts().striped, 1u);
    for (const auto& picture : eye_pictures()) EXPECT_TRUE(processor.process(frame_of(picture, 3), 4)) << "an eye is not striped";
}

TEST(EyeProcessor, AClosedEyeHasNoDirectionAndNoZeroPupil) {
    EyeProcessor processor(0, pupil_labs_camera("Pupil Cam3 ID1", 192, 192));
    const auto sample = processor.process(frame_of(jpeg_of(Image8(192, 192, 1, std::uint8_t{140})), 1), 2);
    ASSERT_TRUE(sample);
    EXPECT_LT(sample->confidence, 0.5f);
    EXPECT_TRUE(std::isnan(sample->pupil_diameter_mm));
}

TEST(EyeProcessor, CamerasAreKnownByName) {
    EXPECT_DOUBLE_EQ(pupil_labs_camera("Pupil Cam3 ID0", 192, 192).focal_px, 140);
    EXPECT_DOUBLE_EQ(pupil_labs_camera("Pupil Cam3 ID0", 400, 400).focal_px, 278.5);
    EXPECT_DOUBLE_EQ(pupil_labs_camera("Pupil Cam2 ID1", 192, 192).focal_px, 283.3);
    EXPECT_DOUBLE_EQ(pupil_labs_camera("Pupil Cam1 ID0", 640, 480).centre_y, 240);
    EXPECT_EQ(eye_of("Pupil Cam3 ID0"), 1);
    EXPECT_EQ(eye_of("Pupil Cam2 ID1"), 0);
    EXPECT_FALSE(eye_of("Pupil Cam1 ID2"));  // the world camera
    EXPECT_FALSE(eye_of("Integrated Webcam ID0"));
}

TEST(EyeProcessor, ExposureGoesToTheMiddleAndStaysInsideThePicturesTime) {
    EXPECT_EQ(next_exposure(20, 120, 200), 20);
    EXPECT_LT(next_exposure(20, 220, 200), 20);
    EXPECT_EQ(next_exposure(50, 20, 200), 50);  // 10000 / 200
    EXPECT_EQ(next_exposure(1, 255, 200), 1);
    int exposure = 2;
    for (int i = 0; i < 60; ++i) exposure = next_exposure(exposure, std::min(255.0, 6.0 * exposure), 120);
    EXPECT_NEAR(6.0 * exposure, 120, 31);
}

TEST(PupilLabsDevice, WithoutCamerasItSaysWhatToDo) {
    if (!find_eye_cameras(linux_video_system()).empty()) return;  // on a developer's machine with the real ones
    MonotonicClock clock;
    for (const char* name : {"pupil-labs", "auto"}) {
        const auto eyes = open_eye_tracker(name, clock);
        ASSERT_FALSE(eyes);
        EXPECT_EQ(eyes.error().kind, ErrorKind::missing);
        EXPECT_NE(eyes.error().message.find("Plug them in"), std::string::npos) << eyes.error().message;
    }
    EXPECT_EQ(open_eye_tracker("tobii", clock).error().kind, ErrorKind::usage);
    DriverOptions options;
    options.name = "pupil-labs";
    EXPECT_EQ(open_headset(options).error().kind, ErrorKind::usage) << "it is no headset";
}

// The tracker with its threads.
struct Tracker : ::testing::Test {
    FakeVideoSystem system;
    MonotonicClock clock;
    std::array<std::atomic<std::uint32_t>, 2> sent{};

    void SetUp() override {
        (void)eye_pictures();
        for (int eye = 0; eye < 2; ++eye) {
            auto& camera = system.cameras[eye == 0 ? "/dev/video2" : "/dev/video0"];
            camera.name = eye == 0 ? "Pupil Cam3 ID1" : "Pupil Cam3 ID0";
            camera.picture = [this, eye] { return next_picture(eye); };
        }
    }
    std::optional<FakePicture> next_picture(int eye) {
        const std::uint32_t n = sent[static_cast<std::size_t>(eye)]++;
        FakePicture picture;
        picture.bytes = eye_pictures()[n % 24];
        picture.sequence = n;
        picture.time = clock.now() - 3'000'000;
        return picture;
    }
    PupilLabsOptions options() {
        PupilLabsOptions o;
        o.video = &system;
        o.retry = 5'000'000;
        return o;
    }
    template <class Condition> bool soon(Condition condition) {
        for (int i = 0; i < 1000; ++i) {
            if (condition()) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }
    testing::FakeCamera& camera(const char* path) { return system.cameras.at(path); }
};

TEST_F(Tracker, BothEyesAreMeasured) {
    PupilLabsTracker tracker(clock, options());
    ASSERT_TRUE(soon([&] {
        const Observer o = tracker.observer_at(clock.now());
        return o.eyes[0].pupil_provenance == Provenance::measured && o.eyes[1].pupil_provenance == Provenance::measured &&
               o.eyes[0].gaze_provenance == Provenance::measured;
    })) << tracker.description();
    const Observer observer = tracker.observer_at(clock.now());
    for (const EyeState& eye : observer.eyes) EXPECT_NEAR(eye.pupil_diameter_mm, 4 * EyeDimensions{}.entrance_magnification(), 0.4);
    EXPECT_TRUE(tracker.present());
    EXPECT_TRUE(tracker.raw_at(0, clock.now()));
    EXPECT_NE(tracker.camera_status(0).find("Pupil Cam3 ID1, 192 x 192 at 200 Hz"), std::string::npos) << tracker.camera_status(0);
    const std::lock_guard lock(system.mutex);
    EXPECT_EQ(camera("/dev/video0").controls[V4L2_CID_EXPOSURE_AUTO], V4L2_EXPOSURE_MANUAL);
    EXPECT_EQ(camera("/dev/video0").controls[V4L2_CID_EXPOSURE_AUTO_PRIORITY], 0);
}

TEST_F(Tracker, ATapHearsEveryPictureAsItCame) {
    std::mutex mutex;
    std::array<std::vector<std::vector<std::uint8_t>>, 2> heard;
    PupilLabsOptions o = options();
    o.tap = [&](int eye, const std::string& product, const CameraMode& mode, const CompressedFrame& frame, TimeNs arrival) {
        const std::lock_guard lock(mutex);
        heard[static_cast<std::size_t>(eye)].emplace_back(frame.bytes.begin(), frame.bytes.end());
        EXPECT_EQ(product, eye == 0 ? "Pupil Cam3 ID1" : "Pupil Cam3 ID0");
        EXPECT_EQ(mode.width, 192);
        EXPECT_LE(frame.time, arrival);
    };
    {
        PupilLabsTracker tracker(clock, o);
        EXPECT_TRUE(soon([&] { return tracker.counts(0).pictures.pictures >= 30 && tracker.counts(1).pictures.pictures >= 30; }));
    }
    for (const auto& pictures : heard) {
        ASSERT_GE(pictures.size(), 30u);
        for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(pictures[i], eye_pictures()[i % 24]) << i;
    }
}

TEST_F(Tracker, UnpluggedAndPluggedInAgainItGoesOn) {
    PupilLabsTracker tracker(clock, options());
    for (int round = 0; round < 5; ++round) {
        ASSERT_TRUE(soon([&] { return tracker.camera_status(0).find("pictures") != std::string::npos; })) << tracker.camera_status(0);
        {
            const std::lock_guard lock(system.mutex);
            camera("/dev/video2").plugged = false;
        }
        ASSERT_TRUE(soon([&] { return tracker.camera_status(0).find("plugged in") != std::string::npos; })) << tracker.camera_status(0);
        const Observer observer = tracker.observer_at(clock.now());
        EXPECT_GE(observer.eyes[0].pupil_diameter_mm, 1.5f);  // the frame goes on
        const std::lock_guard lock(system.mutex);
        EXPECT_EQ(camera("/dev/video2").opened, 0) << "a file left open";
        camera("/dev/video2").plugged = true;
    }
    EXPECT_TRUE(soon([&] { return tracker.camera_status(0).find("pictures") != std::string::npos; }));
}

TEST_F(Tracker, ASecondCameraWithoutRoomOnTheBusIsReachedAnotherWay) {
    camera("/dev/video0").failing[VIDIOC_STREAMON] = ENOSPC;
    // The other way: the same pictures through another system of calls.
    FakeVideoSystem other;
    other.cameras["/dev/video9"].name = "Pupil Cam3 ID0";
    other.cameras["/dev/video9"].picture = [this] { return next_picture(1); };
    std::atomic<int> asked = 0;
    PupilLabsOptions with = options();
    with.bypass = [&](const std::string& product, const CameraMode& mode) -> CameraResult<std::unique_ptr<FrameStream>> {
        ++asked;
        EXPECT_EQ(product, "Pupil Cam3 ID0");
        return V4l2Camera::open(other, find_cameras(other).at(0), mode);
    };
    PupilLabsTracker tracker(clock, with);
    ASSERT_TRUE(soon([&] { return tracker.observer_at(clock.now()).eyes[1].pupil_provenance == Provenance::measured; }))
        << tracker.description();
    EXPECT_EQ(asked, 1);
    EXPECT_NE(tracker.description().find("through libusb"), std::string::npos) << tracker.description();
}

TEST_F(Tracker, WithoutAWayRoundTheUserIsToldWhy) {
    camera("/dev/video0").failing[VIDIOC_STREAMON] = ENOSPC;
    PupilLabsTracker tracker(clock, options());
    ASSERT_TRUE(soon([&] { return tracker.camera_status(1).find("another port") != std::string::npos; })) << tracker.camera_status(1);
    EXPECT_TRUE(soon([&] { return tracker.observer_at(clock.now()).eyes[0].pupil_provenance == Provenance::measured; })) << "one eye works";
}

TEST_F(Tracker, StripesRestartTheStream) {
    const auto bytes = jpeg_of(striped_picture());
    camera("/dev/video2").picture = [&]() -> std::optional<FakePicture> {
        auto picture = next_picture(0);
        if (camera("/dev/video2").times_started == 1) picture->bytes = bytes;
        return picture;
    };
    PupilLabsTracker tracker(clock, options());
    EXPECT_TRUE(soon([&] { return tracker.observer_at(clock.now()).eyes[0].pupil_provenance == Provenance::measured; }))
        << tracker.description();
    const std::lock_guard lock(system.mutex);
    EXPECT_GE(camera("/dev/video2").times_started, 2);
}

TEST_F(Tracker, WithoutCamerasItIsAbsentAndStopsAtOnce) {
    system.cameras.clear();
    PupilLabsTracker tracker(clock, options());
    ASSERT_TRUE(soon([&] { return tracker.camera_status(1).find("ID0") != std::string::npos; }));
    EXPECT_FALSE(tracker.present());
    const Observer observer = tracker.observer_at(clock.now());
    EXPECT_EQ(observer.eyes[0].pupil_provenance, Provenance::absent);
    EXPECT_GE(observer.eyes[0].pupil_diameter_mm, 1.5f);
}

}  // namespace
}  // namespace entoptic::drivers
