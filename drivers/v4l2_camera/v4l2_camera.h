// A camera of Linux's video interface (V4L2): finding it, agreeing on a format and rate, streaming its motion JPEG pictures with the kernel's
// time stamps, and its controls. Nothing the kernel or the camera says is trusted: sizes, indices and times are checked.
#pragma once

#include "drivers/v4l2_camera/frame_stream.h"
#include "drivers/v4l2_camera/video_system.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

struct v4l2_buffer;  // linux/videodev2.h

namespace entoptic::drivers {

struct CameraNode {
    std::string path;  // "/dev/video0": changes from plug to plug
    std::string name;  // the product's: "Pupil Cam3 ID0"
    std::string bus;   // where it is plugged in: "usb-0000:00:14.0-1.2", changes only when it is plugged in elsewhere
};

// Every camera that can stream pictures (other nodes, such as metadata, are left out), in the order of their paths.
std::vector<CameraNode> find_cameras(VideoSystem& system);

class V4l2Camera final : public FrameStream {
public:
    // Opens, agrees on the camera's size nearest to `wanted` (the same or an error) and its highest rate up to wanted.rate_hz, and starts
    // streaming. `system` must outlive the camera.
    static CameraResult<std::unique_ptr<V4l2Camera>> open(VideoSystem& system, const CameraNode& node, const CameraMode& wanted);
    ~V4l2Camera() override;
    V4l2Camera(const V4l2Camera&) = delete;
    V4l2Camera& operator=(const V4l2Camera&) = delete;

    CameraResult<std::optional<CompressedFrame>> next(int timeout_ms) override;
    const CameraMode& mode() const override { return mode_; }
    const CameraCounts& counts() const override { return counts_; }
    bool set_control(std::uint32_t id, std::int32_t value) override;
    CameraResult<void> restart() override;

private:
    struct Buffer {
        std::uint8_t* address = nullptr;
        std::size_t length = 0;
    };

    V4l2Camera(VideoSystem& system, CameraNode node, int fd) : system_(system), node_(std::move(node)), fd_(fd) {}
    CameraResult<void> choose_mode(const CameraMode& wanted);
    double highest_rate(int width, int height, double limit_hz);
    CameraResult<void> map_buffers();
    CameraResult<void> start();
    bool queue(std::uint32_t index);
    std::optional<CompressedFrame> accept(const ::v4l2_buffer& buffer);
    CameraError error(const char* what) const;

    VideoSystem& system_;
    CameraNode node_;
    int fd_;
    CameraMode mode_;
    CameraCounts counts_;
    std::vector<Buffer> buffers_;
    std::optional<std::uint32_t> held_;  // the buffer of the frame given out last
    std::optional<std::uint32_t> newest_sequence_;
    bool streaming_ = false;
};

}  // namespace entoptic::drivers
