// labels: unit fault
// A camera behind the seam of system calls: agreement, streaming, and what goes wrong with real ones.
#include "drivers/v4l2_camera/testing/fake_cameras.h"
#include "drivers/v4l2_camera/v4l2_camera.h"

#include <gtest/gtest.h>

namespace entoptic::drivers {
namespace {

using testing::FakeCamera;
using testing::FakePicture;
using testing::FakeVideoSystem;

const std::string path = "/dev/video0";

struct V4l2 : ::testing::Test {
    FakeVideoSystem system;
    FakeCamera& camera = system.cameras[path];
    std::uint32_t sent = 0;

    void SetUp() override {
        camera.picture = [this] { return std::optional(picture(sent++)); };
    }
    static FakePicture picture(std::uint32_t sequence) {
        FakePicture p;
        p.bytes.assign(1000, static_cast<std::uint8_t>(sequence));
        p.sequence = sequence;
        p.time = 5 * ns_per_s + sequence * 5'000'000;
        return p;
    }
    CameraResult<std::unique_ptr<V4l2Camera>> open(CameraMode mode = {}) {
        return V4l2Camera::open(system, find_cameras(system).at(0), mode);
    }
    CameraFault fault() {
        const auto opened = open();
        EXPECT_EQ(camera.opened, opened ? 1 : 0) << "a file left open";
        return opened ? CameraFault::none : opened.error().fault;
    }
};

TEST_F(V4l2, CamerasAreFoundByTheirNames) {
    system.cameras["/dev/video2"].name = std::string(40, 'x');  // longer than the kernel's field
    system.cameras["/dev/video3"].failing[VIDIOC_QUERYCAP] = ENOTTY;
    const auto found = find_cameras(system);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].name, "Pupil Cam3 ID0");
    EXPECT_EQ(found[0].bus, "usb-fake-1");
    EXPECT_EQ(found[1].name.size(), 31u);
    EXPECT_EQ(camera.opened, 0);
}

TEST_F(V4l2, AgreesOnTheHighestRateUpToTheOneAskedFor) {
    EXPECT_DOUBLE_EQ((*open({192, 192, 200}))->mode().rate_hz, 200);
    EXPECT_DOUBLE_EQ((*open({192, 192, 150}))->mode().rate_hz, 120);
    EXPECT_DOUBLE_EQ((*open({400, 400, 120}))->mode().rate_hz, 120);
}

TEST_F(V4l2, PicturesComeWithTheKernelsTimesInOrder) {
    auto opened = open();
    ASSERT_TRUE(opened) << opened.error().message;
    for (std::uint32_t i = 0; i < 50; ++i) {
        const auto frame = (*opened)->next(10);
        ASSERT_TRUE(frame && *frame);
        EXPECT_EQ((*frame)->sequence, i);
        EXPECT_EQ((*frame)->time, 5 * ns_per_s + i * 5'000'000);
        EXPECT_EQ((*frame)->bytes.size(), 1000u);
        EXPECT_EQ((*frame)->bytes[0], i);
    }
    EXPECT_EQ((*opened)->counts().frames, 50u);
    EXPECT_EQ((*opened)->counts().lost, 0u);
}

TEST_F(V4l2, GapsDoublesAndCorruptPicturesAreCountedAndNotGivenOut) {
    std::deque<FakePicture> script;
    for (const std::uint32_t sequence : {0u, 1u, 4u, 3u, 5u}) script.push_back(picture(sequence));  // 2 is lost, 3 comes late
    script.push_back(picture(6));
    script.back().flags = V4L2_BUF_FLAG_ERROR;
    script.push_back(picture(7));
    script.back().bytes.clear();
    script.push_back(picture(8));
    script.back().claimed_bytes = 1 << 30;  // beyond the buffer
    script.push_back(picture(9));
    camera.picture = [&]() -> std::optional<FakePicture> {
        if (script.empty()) return std::nullopt;
        FakePicture p = script.front();
        script.pop_front();
        return p;
    };
    auto opened = open();
    std::vector<std::uint32_t> got;
    for (int i = 0; i < 12; ++i)
        if (const auto frame = (*opened)->next(1); frame && *frame) got.push_back((*frame)->sequence);
    EXPECT_EQ(got, (std::vector<std::uint32_t>{0, 1, 4, 5, 9}));
    EXPECT_EQ((*opened)->counts().lost, 2u);
    EXPECT_EQ((*opened)->counts().out_of_order, 1u);
    EXPECT_EQ((*opened)->counts().corrupt, 3u);
}

TEST_F(V4l2, ABufferThatIsNotThereEndsTheStream) {
    camera.picture = [this] {
        FakePicture p = picture(sent++);
        p.claimed_index = 77;
        return std::optional(p);
    };
    auto opened = open();
    const auto frame = (*opened)->next(1);
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().fault, CameraFault::broken);
}

TEST_F(V4l2, EachReasonNotToOpenIsToldApart) {
    camera.failing[VIDIOC_STREAMON] = ENOSPC;  // the second camera on a bus
    const auto opened = open();
    ASSERT_FALSE(opened);
    EXPECT_EQ(opened.error().fault, CameraFault::no_bandwidth);
    EXPECT_NE(opened.error().message.find("another port"), std::string::npos) << opened.error().message;
    EXPECT_NE(opened.error().message.find("Pupil Cam3 ID0"), std::string::npos);
    camera.failing = {{VIDIOC_STREAMON, EBUSY}};
    EXPECT_EQ(fault(), CameraFault::busy);
    camera.failing = {{VIDIOC_REQBUFS, EBUSY}};
    EXPECT_EQ(fault(), CameraFault::busy);
    camera.failing = {{VIDIOC_S_FMT, EIO}};
    EXPECT_EQ(fault(), CameraFault::broken);
    camera.failing.clear();
    camera.pixel_format = V4L2_PIX_FMT_YUYV;
    EXPECT_EQ(fault(), CameraFault::unsuitable);
    camera.pixel_format = V4L2_PIX_FMT_MJPEG;
    camera.sizes = {{640, 480}};
    EXPECT_EQ(fault(), CameraFault::unsuitable);
    camera.sizes = {{192, 192}};
    camera.buffer_count = 0;
    EXPECT_EQ(fault(), CameraFault::broken);
    camera.buffer_count = 4;
    camera.buffer_length = 0;
    EXPECT_EQ(fault(), CameraFault::broken);
    camera.buffer_length = 4000;
    EXPECT_EQ(fault(), CameraFault::none);
    const auto nodes = find_cameras(system);
    camera.failing[0] = EACCES;
    const auto forbidden = V4l2Camera::open(system, nodes.at(0), {});
    ASSERT_FALSE(forbidden);
    EXPECT_EQ(forbidden.error().fault, CameraFault::forbidden);
}

TEST_F(V4l2, UnpluggedInMidStreamItSaysSo) {
    auto opened = open();
    ASSERT_TRUE(*(*opened)->next(1));
    camera.plugged = false;
    const auto frame = (*opened)->next(1);
    ASSERT_FALSE(frame);
    EXPECT_EQ(frame.error().fault, CameraFault::gone);
    opened->reset();
    EXPECT_EQ(camera.opened, 0);
}

TEST_F(V4l2, NothingWithinTheTimeIsNotAnError) {
    camera.picture = nullptr;
    auto opened = open();
    const auto frame = (*opened)->next(1);
    ASSERT_TRUE(frame);
    EXPECT_FALSE(*frame);
}

TEST_F(V4l2, ControlsAreClampedAndAbsentOnesRefused) {
    auto opened = open();
    EXPECT_TRUE((*opened)->set_control(V4L2_CID_GAMMA, 1000));
    EXPECT_EQ(camera.controls[V4L2_CID_GAMMA], 255);
    camera.failing[VIDIOC_QUERYCTRL] = EINVAL;
    EXPECT_FALSE((*opened)->set_control(V4L2_CID_SATURATION, 0));
}

TEST_F(V4l2, ARestartedStreamGoesOn) {
    auto opened = open();
    ASSERT_TRUE(*(*opened)->next(1));
    ASSERT_TRUE((*opened)->restart());
    EXPECT_EQ(camera.times_started, 2);
    EXPECT_TRUE(*(*opened)->next(1));
    EXPECT_EQ((*opened)->counts().lost, 0u) << "the numbering may begin anew";
}

}  // namespace
}  // namespace entoptic::drivers
