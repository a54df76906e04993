// labels: device
// The driver of Pupil Labs' eye cameras against the kernel's own UVC driver, with emulated cameras. Runs on tests/devices/run_um.sh.
#include "base/noise.h"
#include "drivers/pupil_labs/pupil_labs_device.h"
#include "drivers/pupil_labs/pupil_labs_tracker.h"
#include "drivers/uvc_camera/uvc_camera.h"
#include "drivers/vive_pro/vive_pro_device.h"
#include "tests/devices/emulated_eyes.h"
#include "tests/devices/emulated_vive.h"
#include "tests/devices/test_process.h"

#include <cerrno>
#include <cstdlib>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

namespace entoptic::devices {
namespace {

using namespace entoptic::drivers;

MonotonicClock the_clock;

// A driver whose cameras are plugged in, once both eyes are measured.
struct Driven {
    explicit Driven(EmulatedEyes& cameras) {
        const auto plugged = cameras.plug();
        EXPECT_TRUE(plugged) << plugged.error().message;
        tracker = std::make_unique<PupilLabsTracker>(the_clock, PupilLabsOptions{});
        EXPECT_TRUE(within(20, [&] {
            const Observer observer = tracker->observer_at(the_clock.now());
            return observer.eyes[0].gaze_provenance == Provenance::measured && observer.eyes[1].gaze_provenance == Provenance::measured;
        })) << tracker->description();
    }
    std::unique_ptr<PupilLabsTracker> tracker;
    PupilLabsTracker* operator->() { return tracker.get(); }
};

// The exposure times of an eye's samples in `seconds`.
std::vector<TimeNs> sample_times(PupilLabsTracker& tracker, int eye, double seconds) {
    std::vector<TimeNs> times;
    for (const TimeNs end = the_clock.now() + nanoseconds(seconds); the_clock.now() < end; sleep_s(0.001)) {
        const auto raw = tracker.raw_at(eye, the_clock.now());
        if (raw && (times.empty() || raw->time != times.back())) times.push_back(raw->time);
    }
    return times;
}

// Stops the pictures and lets the driver finish those on the way.
EyeCameraCounts settled_counts(Driven& tracker, EmulatedEyes& cameras, int eye) {
    cameras.freeze(true);
    sleep_s(0.2);
    return tracker->counts(eye);
}

TEST(EyeCamerasOnTheKernel, BothEyesAtTwoHundredHertz) {
    EmulatedEyes cameras;
    Driven tracker(cameras);
    EXPECT_EQ(find_eye_cameras(linux_video_system()).size(), 2u);
    for (int eye = 0; eye < 2; ++eye) {
        const std::vector<TimeNs> times = sample_times(*tracker.tracker, eye, 3);
        ASSERT_NEAR(static_cast<double>(times.size()), 600, 2);
        // The kernel stamps a picture when the transfer that begins it has ended: 24 microframes, 3 ms.
        for (std::size_t i = 1; i < times.size(); ++i) EXPECT_NEAR(static_cast<double>(times[i] - times[i - 1]), 5e6, 3.1e6) << i;
        const double period = static_cast<double>(times.back() - times.front()) / static_cast<double>(times.size() - 1);
        EXPECT_NEAR(period, 5e6, 3e6 / 600);
        const EyeState state = tracker->observer_at(the_clock.now()).eyes[static_cast<std::size_t>(eye)];
        EXPECT_EQ(state.pupil_provenance, Provenance::measured);
        EXPECT_NEAR(state.pupil_diameter_mm, 4 * EyeDimensions{}.entrance_magnification(), 0.3);
    }
    for (int eye = 0; eye < 2; ++eye) {
        const EyeCameraCounts counts = settled_counts(tracker, cameras, eye);
        fmt::print("{} pictures sent to the {} eye's driver, {} came, {} lost, {} corrupt\n",
                   (eye ? cameras.right : cameras.left).frames.load(), eye ? "right" : "left", counts.camera.frames, counts.camera.lost,
                   counts.camera.corrupt + counts.pictures.corrupt);
        EXPECT_EQ(static_cast<std::int64_t>(counts.camera.frames), (eye ? cameras.right : cameras.left).frames);
        EXPECT_EQ(counts.camera.lost + counts.camera.corrupt + counts.pictures.corrupt + counts.pictures.striped, 0u);
    }
}

TEST(EyeCamerasOnTheKernel, TruncatedPicturesAreCountedToTheOne) {
    std::atomic<std::uint64_t> cut[2] = {0, 0};
    const auto faulty = [&](std::size_t camera) {
        return [&cut, camera](const CameraOffer& offer, std::int64_t n) {
            Bytes bytes = eye_picture(offer, n);
            if (n % 10 != 3) return bytes;
            ++cut[camera];
            bytes.resize(bytes.size() * static_cast<std::size_t>(n % 70 + 10) / 100);
            return bytes;
        };
    };
    EmulatedEyes cameras;
    cameras.left.set_picture(faulty(0));
    cameras.right.set_picture(faulty(1));
    Driven tracker(cameras);
    for (int i = 0; i < 200; ++i) {
        sleep_s(0.011);
        for (const EyeState& eye : tracker->observer_at(the_clock.now()).eyes) EXPECT_GE(eye.pupil_diameter_mm, 1.5f);
    }
    for (int eye = 0; eye < 2; ++eye) {
        const EyeCameraCounts counts = settled_counts(tracker, cameras, eye);
        EXPECT_EQ(counts.pictures.corrupt, cut[eye]);
        EXPECT_GT(cut[eye], 40u);
        EXPECT_EQ(counts.camera.lost, 0u);
    }
}

TEST(EyeCamerasOnTheKernel, ChangedBytesNeverGiveAPupilOfZero) {
    EmulatedEyes cameras([](const CameraOffer& offer, std::int64_t n) {
        Bytes bytes = eye_picture(offer, n);
        if (n % 5 != 2) return bytes;
        for (std::size_t i = 0; i < 20; ++i)
            bytes[mix64(static_cast<std::uint64_t>(n) * 20 + i) % bytes.size()] = static_cast<std::uint8_t>(mix64(i + 77) >> 7);
        return bytes;
    });
    Driven tracker(cameras);
    for (int i = 0; i < 600; ++i) {
        sleep_s(0.005);
        for (const EyeState& eye : tracker->observer_at(the_clock.now()).eyes) EXPECT_GE(eye.pupil_diameter_mm, 1.5f);
        for (int eye = 0; eye < 2; ++eye) {
            const auto raw = tracker->raw_at(eye, the_clock.now());
            EXPECT_FALSE(raw && raw->pupil_diameter_mm < 1);
        }
    }
    for (int eye = 0; eye < 2; ++eye) {
        const EyeCameraCounts counts = settled_counts(tracker, cameras, eye);
        EXPECT_GT(counts.pictures.corrupt, 20u) << "most of the changed ones";
        EXPECT_GT(counts.pictures.with_pupil, 4 * counts.pictures.corrupt / 2) << "and the others are not the worse for it";
    }
}

TEST(EyeCamerasOnTheKernel, StripesAreCountedAndRestartTheStream) {
    std::atomic<bool> striped = false;
    const Bytes stripes = drivers::testing::jpeg_of(drivers::testing::striped_picture());
    EmulatedEyes cameras;
    cameras.right.set_picture([&](const CameraOffer& offer, std::int64_t n) {
        if (cameras.right.starts > 1) striped = false;  // a restart mends it, as it does the real one's
        return striped ? stripes : eye_picture(offer, n);
    });
    Driven tracker(cameras);
    EXPECT_EQ(cameras.right.starts, 1);
    striped = true;
    EXPECT_TRUE(within(2, [&] { return cameras.right.starts == 2; }));
    EXPECT_GT(sample_times(*tracker.tracker, 1, 0.5).size(), 95u);
    EXPECT_EQ(cameras.left.starts, 1);
    const EyeCameraCounts counts = settled_counts(tracker, cameras, 1);
    EXPECT_GE(counts.pictures.striped, 10u);
    EXPECT_LE(counts.pictures.striped, 15u);
}

TEST(EyeCamerasOnTheKernel, PicturesWhosePacketsAreLostAreCountedToTheOne) {
    EmulatedEyes cameras;
    Driven tracker(cameras);
    constexpr int losses = 25;
    for (int i = 0; i < losses; ++i) {
        cameras.left.lost_packets = 1;
        sleep_s(0.05);
    }
    const EyeCameraCounts counts = settled_counts(tracker, cameras, 0);
    EXPECT_EQ(counts.camera.lost + counts.camera.corrupt, static_cast<std::uint64_t>(losses));
    EXPECT_EQ(counts.pictures.corrupt, 0u) << "the kernel does not give out a picture with a hole";
    EXPECT_EQ(tracker->counts(1).camera.lost, 0u);
}

TEST(EyeCamerasOnTheKernel, AStalledStartIsTriedAgain) {
    EmulatedEyes cameras;
    cameras.right.stalled_starts = 3;
    ASSERT_TRUE(cameras.plug());
    PupilLabsTracker tracker(the_clock, {});
    ASSERT_TRUE(within(10, [&] { return cameras.right.stalled_starts == 2; }));
    EXPECT_TRUE(within(1, [&] { return tracker.camera_status(1).find("failed") != std::string::npos; })) << tracker.camera_status(1);
    EXPECT_TRUE(within(20, [&] { return tracker.counts(1).pictures.with_pupil > 100; })) << tracker.camera_status(1);
    EXPECT_EQ(cameras.right.stalled_starts, 0);
}

TEST(EyeCamerasOnTheKernel, ASilentCameraIsOpenedAnew) {
    EmulatedEyes cameras;
    Driven tracker(cameras);
    cameras.left.frozen = true;
    EXPECT_TRUE(within(10, [&] { return cameras.left.starts >= 2; })) << tracker->camera_status(0);
    EXPECT_EQ(tracker->observer_at(the_clock.now()).eyes[0].pupil_provenance, Provenance::absent);
    cameras.left.frozen = false;
    EXPECT_TRUE(within(10, [&] { return tracker->counts(0).pictures.with_pupil > 100; })) << tracker->camera_status(0);
    EXPECT_EQ(tracker->counts(1).camera.lost, 0u);
}

TEST(EyeCamerasOnTheKernel, UnpluggedAndPluggedInAgain) {
    EmulatedEyes cameras;
    Driven tracker(cameras);
    const std::size_t files = open_files(), tasks = threads();
    for (int i = 0; i < 5; ++i) {
        cameras.right.unplug();
        ASSERT_TRUE(within(5, [&] { return tracker->camera_status(1).find("plug") != std::string::npos; })) << tracker->camera_status(1);
        EXPECT_NEAR(static_cast<double>(sample_times(*tracker.tracker, 0, 0.5).size()), 100, 2) << "the other eye goes on";
        ASSERT_TRUE(cameras.right.plug(EmulatedEyes::right_port));
        ASSERT_TRUE(within(20, [&] { return sample_times(*tracker.tracker, 1, 0.2).size() > 30; }))
            << i << " " << tracker->camera_status(1);
    }
    EXPECT_TRUE(within(5, [&] { return open_files() == files && threads() == tasks; }))
        << open_files() << " files, " << threads() << " threads";
    EXPECT_EQ(tracker->counts(0).camera.lost, 0u);
}

// The kernel's calls, but that its driver finds no room on the bus for a second camera: the virtual bus counts none.
class FullBus final : public VideoSystem {
public:
    std::vector<std::string> nodes() override { return linux_.nodes(); }
    int open(const char* path) override { return linux_.open(path); }
    int close(int fd) override {
        std::erase(streaming_, fd);
        return linux_.close(fd);
    }
    int ioctl(int fd, unsigned long request, void* argument) override {
        if (request == VIDIOC_STREAMON) {
            if (!streaming_.empty()) return errno = ENOSPC, -1;
            streaming_.push_back(fd);
        }
        return linux_.ioctl(fd, request, argument);
    }
    void* map(int fd, std::size_t length, std::size_t offset) override { return linux_.map(fd, length, offset); }
    int unmap(void* address, std::size_t length) override { return linux_.unmap(address, length); }
    int wait(int fd, int timeout_ms) override { return linux_.wait(fd, timeout_ms); }

private:
    VideoSystem& linux_ = linux_video_system();
    std::vector<int> streaming_;  // cameras are opened and closed one at a time
};

TEST(EyeCamerasOnTheKernel, OnAFullBusTheSecondIsReachedThroughLibusbAtTheSettingThatItNeeds) {
    EmulatedEyes cameras;
    ASSERT_TRUE(cameras.plug());
    ASSERT_TRUE(within(10, [] { return find_eye_cameras(linux_video_system()).size() == 2; }));
    FullBus bus;
    PupilLabsOptions options;
    options.video = &bus;
    options.bypass = [](const std::string& product, const CameraMode& mode) { return open_uvc_camera(product, mode, the_clock); };
    PupilLabsTracker tracker(the_clock, options);
    ASSERT_TRUE(within(10, [&] { return tracker.counts(0).pictures.with_pupil > 50 && tracker.counts(1).pictures.with_pupil > 50; }))
        << tracker.description();
    const bool right_by_kernel = cameras.right.alternate == 6;
    EXPECT_EQ(cameras.right.alternate + cameras.left.alternate, 6 + 2) << "3072 bytes a microframe by the kernel, 256 by libusb";
    EXPECT_NE(tracker.camera_status(right_by_kernel ? 0 : 1).find("through libusb"), std::string::npos) << tracker.description();
    for (int eye = 0; eye < 2; ++eye) {
        const std::vector<TimeNs> times = sample_times(tracker, eye, 2);
        ASSERT_NEAR(static_cast<double>(times.size()), 400, 3);
        EXPECT_NEAR(static_cast<double>(times.back() - times.front()) / static_cast<double>(times.size() - 1), 5e6, 3e6 / 400);
        const EyeCameraCounts counts = tracker.counts(eye);
        EXPECT_EQ(counts.camera.lost + counts.camera.corrupt + counts.pictures.corrupt, 0u);
    }
}

TEST(EyeCamerasOnTheKernel, WithAViveProWithoutALostSampleOrALeak) {
    const std::size_t files = open_files(), tasks = threads();
    {
        EmulatedVive vive;
        vive.model.motion = {0.5, 0.3, 0.1};
        EmulatedEyes cameras;
        ASSERT_TRUE(vive.plug());
        ASSERT_TRUE(within(10, [&] {
            const auto found = vive_pro::find_headsets(system_hid_bus());
            return found.size() == 1 && !found[0].light.path.empty() && !found[0].mainboard.path.empty();
        }));
        auto device = vive_pro::open_device(system_hid_bus(), the_clock);
        ASSERT_TRUE(device) << device.error().message;
        Driven tracker(cameras);
        const char* minutes = std::getenv("ENTOPTIC_DEVICE_MINUTES");
        const double length = minutes ? std::atof(minutes) * 60 : 5;
        sleep_s(std::min(length / 2, 30.0));  // histories are full
        const std::size_t heap = heap_in_use();
        const auto motion = (*device)->tracker().statistics();
        const EyeCameraCounts pictures[2] = {tracker->counts(0), tracker->counts(1)};
        sleep_s(length);
        const auto now = (*device)->tracker().statistics();
        const std::size_t heap_now = heap_in_use();
        EXPECT_NEAR(static_cast<double>(now.samples - motion.samples), length * 1000, 4);
        EXPECT_EQ(now.lost_samples + now.malformed + now.clock_jumps, 0u);
        for (int eye = 0; eye < 2; ++eye) {
            const EyeCameraCounts counts = tracker->counts(eye);
            const double came = static_cast<double>(counts.camera.frames - pictures[eye].camera.frames);
            fmt::print("{:.0f} pictures of the {} eye in {:.0f} s, {} lost, {} corrupt, {} out of order\n", came, eye ? "right" : "left",
                       length, counts.camera.lost, counts.camera.corrupt + counts.pictures.corrupt, counts.camera.out_of_order);
            EXPECT_NEAR(came, length * 200, 2);
            EXPECT_EQ(counts.camera.lost + counts.camera.corrupt + counts.camera.out_of_order + counts.pictures.corrupt, 0u);
        }
        fmt::print("{} samples of motion, {} lost; heap {} kB, then {} kB\n", now.samples - motion.samples, now.lost_samples, heap / 1024,
                   heap_now / 1024);
        EXPECT_LT(heap_now, heap + (64u << 10)) << "it grows";
    }
    EXPECT_EQ(open_files(), files);
    EXPECT_EQ(threads(), tasks);
}

}  // namespace
}  // namespace entoptic::devices
