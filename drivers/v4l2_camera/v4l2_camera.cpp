#include "drivers/v4l2_camera/v4l2_camera.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/mman.h>

namespace entoptic::drivers {

namespace {

constexpr std::uint32_t wanted_buffers = 4;        // 20 ms at 200 Hz
constexpr std::size_t largest_buffer = 64u << 20;  // bytes
constexpr std::uint32_t most_entries = 256;        // of an enumeration that never ends
constexpr std::uint32_t largest_gap = 100'000;     // of sequence numbers: beyond, the numbering began anew

// A kernel string that may lack its end.
template <std::size_t size> std::string text_of(const unsigned char (&text)[size]) {
    const auto* begin = reinterpret_cast<const char*>(text);
    return {begin, strnlen(begin, size)};
}

CameraFault fault_of(int number) {
    switch (number) {
        case ENODEV:
        case ENXIO:
        case ENOENT:
            return CameraFault::gone;
        case EACCES:
        case EPERM:
            return CameraFault::forbidden;
        case EBUSY:
            return CameraFault::busy;
        case ENOSPC:
            return CameraFault::no_bandwidth;
        default:
            return CameraFault::broken;
    }
}

const char* advice_for(CameraFault fault) {
    switch (fault) {
        case CameraFault::gone:
            return "Plug it in again.";
        case CameraFault::forbidden:
            return "Install Entoptic's udev rules (`entoptic doctor` says how), or add yourself to the group 'video' and log in again.";
        case CameraFault::busy:
            return "Close the other program that uses it.";
        case CameraFault::no_bandwidth:
            return "The USB bus has no room for a second camera through the kernel's driver: plug one camera into another port, or let "
                   "Entoptic "
                   "reach it through libusb.";
        default:
            return "Plug it in again; if that does not help, see the kernel's log.";
    }
}

}  // namespace

CameraError V4l2Camera::error(const char* what) const {
    const int number = errno;
    const CameraFault fault = fault_of(number);
    return {fault, fmt::format("{} ({}): {} failed: {}. {}", node_.name, node_.path, what, std::strerror(number), advice_for(fault))};
}

std::vector<CameraNode> find_cameras(VideoSystem& system) {
    std::vector<CameraNode> found;
    for (const std::string& path : system.nodes()) {
        const int fd = system.open(path.c_str());
        if (fd < 0) continue;
        v4l2_capability capability{};
        if (system.ioctl(fd, VIDIOC_QUERYCAP, &capability) == 0) {
            const std::uint32_t can = capability.capabilities & V4L2_CAP_DEVICE_CAPS ? capability.device_caps : capability.capabilities;
            if ((can & V4L2_CAP_VIDEO_CAPTURE) && (can & V4L2_CAP_STREAMING))
                found.push_back({path, text_of(capability.card), text_of(capability.bus_info)});
        }
        system.close(fd);
    }
    return found;
}

CameraResult<std::unique_ptr<V4l2Camera>> V4l2Camera::open(VideoSystem& system, const CameraNode& node, const CameraMode& wanted) {
    const int fd = system.open(node.path.c_str());
    std::unique_ptr<V4l2Camera> camera(new V4l2Camera(system, node, fd));
    if (fd < 0) return tl::make_unexpected(camera->error("opening it"));
    if (auto done = camera->choose_mode(wanted); !done) return tl::make_unexpected(done.error());
    if (auto done = camera->map_buffers(); !done) return tl::make_unexpected(done.error());
    if (auto done = camera->start(); !done) return tl::make_unexpected(done.error());
    return camera;
}

V4l2Camera::~V4l2Camera() {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (streaming_) system_.ioctl(fd_, VIDIOC_STREAMOFF, &type);
    for (const Buffer& buffer : buffers_) system_.unmap(buffer.address, buffer.length);
    if (fd_ >= 0) system_.close(fd_);
}

double V4l2Camera::highest_rate(int width, int height, double limit_hz) {
    double best = 0;
    for (std::uint32_t i = 0; i < most_entries; ++i) {
        v4l2_frmivalenum interval{};
        interval.index = i;
        interval.pixel_format = V4L2_PIX_FMT_MJPEG;
        interval.width = static_cast<std::uint32_t>(width);
        interval.height = static_cast<std::uint32_t>(height);
        if (system_.ioctl(fd_, VIDIOC_ENUM_FRAMEINTERVALS, &interval) != 0) break;
        // Stepwise and continuous ranges: the shortest interval.
        const v4l2_fract time = interval.type == V4L2_FRMIVAL_TYPE_DISCRETE ? interval.discrete : interval.stepwise.min;
        if (time.numerator == 0) continue;
        const double rate = static_cast<double>(time.denominator) / time.numerator;
        if (interval.type != V4L2_FRMIVAL_TYPE_DISCRETE) return std::min(rate, limit_hz);
        if (rate <= limit_hz * 1.01) best = std::max(best, rate);
    }
    return best > 0 ? best : limit_hz;
}

CameraResult<void> V4l2Camera::choose_mode(const CameraMode& wanted) {
    const auto unsuitable = [&](const std::string& why) {
        return tl::make_unexpected(CameraError{CameraFault::unsuitable, fmt::format("{} ({}): {}", node_.name, node_.path, why)});
    };
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = static_cast<std::uint32_t>(wanted.width);
    format.fmt.pix.height = static_cast<std::uint32_t>(wanted.height);
    format.fmt.pix.pixelformat = V4L2_PIX_FMT_MJPEG;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    if (system_.ioctl(fd_, VIDIOC_S_FMT, &format) != 0) return tl::make_unexpected(error("setting the format"));
    if (format.fmt.pix.pixelformat != V4L2_PIX_FMT_MJPEG)
        return unsuitable("it sends no motion JPEG. It is not an eye camera that is known.");
    if (format.fmt.pix.width != static_cast<std::uint32_t>(wanted.width) ||
        format.fmt.pix.height != static_cast<std::uint32_t>(wanted.height))
        return unsuitable(
            fmt::format("it offers {} x {} instead of {} x {} pixels. Ask for a size that it has (v4l2-ctl --list-formats-ext).",
                        format.fmt.pix.width, format.fmt.pix.height, wanted.width, wanted.height));
    mode_ = {wanted.width, wanted.height, highest_rate(wanted.width, wanted.height, wanted.rate_hz)};
    v4l2_streamparm parameters{};
    parameters.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    parameters.parm.capture.timeperframe = {1000, static_cast<std::uint32_t>(std::lround(1000 * mode_.rate_hz))};
    if (system_.ioctl(fd_, VIDIOC_S_PARM, &parameters) == 0) {
        const v4l2_fract agreed = parameters.parm.capture.timeperframe;
        if (agreed.numerator > 0 && agreed.denominator > 0) mode_.rate_hz = static_cast<double>(agreed.denominator) / agreed.numerator;
    }
    return {};
}

CameraResult<void> V4l2Camera::map_buffers() {
    v4l2_requestbuffers request{};
    request.count = wanted_buffers;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (system_.ioctl(fd_, VIDIOC_REQBUFS, &request) != 0) return tl::make_unexpected(error("asking for buffers"));
    if (request.count < 2 || request.count > 64)
        return tl::make_unexpected(
            CameraError{CameraFault::broken, fmt::format("{}: the kernel gives {} buffers.", node_.name, request.count)});
    for (std::uint32_t i = 0; i < request.count; ++i) {
        v4l2_buffer buffer{};
        buffer.index = i;
        buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        buffer.memory = V4L2_MEMORY_MMAP;
        if (system_.ioctl(fd_, VIDIOC_QUERYBUF, &buffer) != 0) return tl::make_unexpected(error("asking for a buffer"));
        if (buffer.length == 0 || buffer.length > largest_buffer)
            return tl::make_unexpected(
                CameraError{CameraFault::broken, fmt::format("{}: a buffer of {} bytes.", node_.name, buffer.length)});
        void* address = system_.map(fd_, buffer.length, buffer.m.offset);
        if (address == MAP_FAILED) return tl::make_unexpected(error("mapping a buffer"));
        buffers_.push_back({static_cast<std::uint8_t*>(address), buffer.length});
    }
    return {};
}

bool V4l2Camera::queue(std::uint32_t index) {
    v4l2_buffer buffer{};
    buffer.index = index;
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    return system_.ioctl(fd_, VIDIOC_QBUF, &buffer) == 0;
}

CameraResult<void> V4l2Camera::start() {
    for (std::uint32_t i = 0; i < buffers_.size(); ++i)
        if (!queue(i)) return tl::make_unexpected(error("handing over a buffer"));
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (system_.ioctl(fd_, VIDIOC_STREAMON, &type) != 0) return tl::make_unexpected(error("starting the stream"));
    streaming_ = true;
    newest_sequence_.reset();
    held_.reset();
    return {};
}

CameraResult<void> V4l2Camera::restart() {
    int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    streaming_ = false;
    if (system_.ioctl(fd_, VIDIOC_STREAMOFF, &type) != 0) return tl::make_unexpected(error("stopping the stream"));
    return start();
}

// Checks what the kernel says of a filled buffer.
std::optional<CompressedFrame> V4l2Camera::accept(const v4l2_buffer& buffer) {
    if (newest_sequence_ && buffer.sequence <= *newest_sequence_ && *newest_sequence_ - buffer.sequence < largest_gap) {
        ++counts_.out_of_order;  // uvcvideo under load (facts/kernel_devices.md 3); an older picture is of no use
        return std::nullopt;
    }
    if (newest_sequence_ && buffer.sequence - *newest_sequence_ < largest_gap) counts_.lost += buffer.sequence - *newest_sequence_ - 1;
    newest_sequence_ = buffer.sequence;
    const Buffer& memory = buffers_[buffer.index];
    if ((buffer.flags & V4L2_BUF_FLAG_ERROR) || buffer.bytesused == 0 || buffer.bytesused > memory.length) {
        ++counts_.corrupt;
        return std::nullopt;
    }
    ++counts_.frames;
    const TimeNs time = TimeNs{buffer.timestamp.tv_sec} * ns_per_s + TimeNs{buffer.timestamp.tv_usec} * 1000;
    return CompressedFrame{{memory.address, buffer.bytesused}, time, buffer.sequence};
}

CameraResult<std::optional<CompressedFrame>> V4l2Camera::next(int timeout_ms) {
    if (held_ && !queue(*held_)) return tl::make_unexpected(error("handing back a buffer"));
    held_.reset();
    for (std::size_t tries = 0; tries < 2 * buffers_.size(); ++tries) {  // bad pictures in a row do not keep the caller
        const int ready = system_.wait(fd_, timeout_ms);
        if (ready < 0) return tl::make_unexpected(error("waiting for a picture"));
        if (ready == 0) return std::optional<CompressedFrame>{};
        v4l2_buffer buffer{};
        buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
        buffer.memory = V4L2_MEMORY_MMAP;
        if (system_.ioctl(fd_, VIDIOC_DQBUF, &buffer) != 0) {
            if (errno == EAGAIN || errno == EIO) {  // nothing yet; a hiccup of the transport, the buffer stays the kernel's
                if (errno == EIO) ++counts_.corrupt;
                continue;
            }
            return tl::make_unexpected(error("taking a picture"));
        }
        if (buffer.index >= buffers_.size())
            return tl::make_unexpected(CameraError{
                CameraFault::broken, fmt::format("{}: the kernel filled buffer {} of {}.", node_.name, buffer.index, buffers_.size())});
        if (const auto frame = accept(buffer)) {
            held_ = buffer.index;
            return std::optional<CompressedFrame>{*frame};
        }
        if (!queue(buffer.index)) return tl::make_unexpected(error("handing back a buffer"));
    }
    return std::optional<CompressedFrame>{};
}

bool V4l2Camera::set_control(std::uint32_t id, std::int32_t value) {
    v4l2_queryctrl query{};
    query.id = id;
    if (system_.ioctl(fd_, VIDIOC_QUERYCTRL, &query) != 0 || (query.flags & V4L2_CTRL_FLAG_DISABLED) || query.minimum > query.maximum)
        return false;
    v4l2_control control{};
    control.id = id;
    control.value = std::clamp(value, query.minimum, query.maximum);
    return system_.ioctl(fd_, VIDIOC_S_CTRL, &control) == 0;
}

}  // namespace entoptic::drivers
