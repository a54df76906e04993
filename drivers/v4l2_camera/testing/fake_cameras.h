// For tests: cameras behind the seam of system calls, as uvcvideo would show them, with the faults that are ordered. Thread-safe.
#pragma once

#include "base/time.h"
#include "drivers/v4l2_camera/video_system.h"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <deque>
#include <functional>
#include <linux/videodev2.h>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <sys/mman.h>

namespace entoptic::drivers::testing {

struct FakePicture {
    std::vector<std::uint8_t> bytes;
    std::uint32_t sequence = 0;
    TimeNs time = 0;
    std::uint32_t flags = 0;
    std::int64_t claimed_bytes = -1;  // bytesused, when it is a lie
    std::int64_t claimed_index = -1;
};

struct FakeCamera {
    std::string name = "Pupil Cam3 ID0", bus = "usb-fake-1";
    std::uint32_t pixel_format = V4L2_PIX_FMT_MJPEG;
    std::vector<std::pair<int, int>> sizes{{192, 192}, {400, 400}};
    std::vector<double> rates{30, 60, 120, 200};
    std::map<unsigned long, int> failing;            // errno of these requests from now on
    std::map<std::uint32_t, std::int32_t> controls;  // as set
    std::uint32_t buffer_length = 40000, buffer_count = 4;
    bool plugged = true;
    // What the camera sends next; none: nothing now. Called under the system's lock.
    std::function<std::optional<FakePicture>()> picture;
    int opened = 0, streaming = 0, times_started = 0;
};

class FakeVideoSystem final : public VideoSystem {
public:
    std::map<std::string, FakeCamera> cameras;  // by path; change them under `mutex`
    std::mutex mutex;

    std::vector<std::string> nodes() override {
        const std::lock_guard lock(mutex);
        std::vector<std::string> paths;
        for (const auto& [path, camera] : cameras)
            if (camera.plugged) paths.push_back(path);
        return paths;
    }
    int open(const char* path) override {
        const std::lock_guard lock(mutex);
        const auto at = cameras.find(path);
        if (at == cameras.end() || !at->second.plugged) return fail(ENOENT);
        if (at->second.failing.contains(0)) return fail(at->second.failing[0]);
        ++at->second.opened;
        open_[++last_fd_] = {path, {}, {}, {}};
        return last_fd_;
    }
    int close(int fd) override {
        const std::lock_guard lock(mutex);
        const auto at = open_.find(fd);
        if (at == open_.end()) return fail(EBADF);
        --cameras[at->second.path].opened;
        if (at->second.streams) --cameras[at->second.path].streaming;
        open_.erase(at);
        return 0;
    }
    void* map(int fd, std::size_t length, std::size_t offset) override {
        const std::lock_guard lock(mutex);
        auto& memory = open_[fd].memory;
        const std::size_t index = offset / 65536;
        if (index >= memory.size() || length != memory[index].size()) {
            errno = EINVAL;
            return MAP_FAILED;
        }
        return memory[index].data();
    }
    int unmap(void*, std::size_t) override { return 0; }
    int wait(int fd, int) override {
        const std::lock_guard lock(mutex);
        FakeCamera* camera = camera_of(fd);
        if (!camera || !camera->plugged) return 1;  // POLLERR
        fetch(fd, *camera);
        return open_[fd].filled.empty() ? 0 : 1;
    }
    int ioctl(int fd, unsigned long request, void* argument) override {
        const std::lock_guard lock(mutex);
        FakeCamera* camera = camera_of(fd);
        if (!camera) return fail(EBADF);
        if (!camera->plugged) return fail(ENODEV);
        if (const auto at = camera->failing.find(request); at != camera->failing.end()) return fail(at->second);
        return answer(fd, *camera, request, argument);
    }

private:
    struct Open {
        std::string path;
        std::vector<std::vector<std::uint8_t>> memory;
        std::deque<std::uint32_t> free;
        std::deque<std::pair<std::uint32_t, FakePicture>> filled;
        bool streams = false;
    };

    static int fail(int number) {
        errno = number;
        return -1;
    }
    FakeCamera* camera_of(int fd) {
        const auto at = open_.find(fd);
        return at == open_.end() ? nullptr : &cameras[at->second.path];
    }
    void fetch(int fd, FakeCamera& camera) {
        Open& open = open_[fd];
        if (!open.streams || !open.filled.empty() || open.free.empty() || !camera.picture) return;
        if (auto picture = camera.picture()) {
            const std::uint32_t index = open.free.front();
            open.free.pop_front();
            auto& memory = open.memory[index];
            std::copy_n(picture->bytes.begin(), std::min(memory.size(), picture->bytes.size()), memory.begin());
            open.filled.emplace_back(index, std::move(*picture));
        }
    }
    int answer(int fd, FakeCamera& camera, unsigned long request, void* argument) {
        Open& open = open_[fd];
        switch (request) {
            case VIDIOC_QUERYCAP: {
                auto& c = *static_cast<v4l2_capability*>(argument);
                std::strncpy(reinterpret_cast<char*>(c.card), camera.name.c_str(), sizeof c.card - 1);
                std::strncpy(reinterpret_cast<char*>(c.bus_info), camera.bus.c_str(), sizeof c.bus_info - 1);
                c.capabilities = V4L2_CAP_DEVICE_CAPS;
                c.device_caps = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
                return 0;
            }
            case VIDIOC_S_FMT: {
                auto& pix = static_cast<v4l2_format*>(argument)->fmt.pix;
                pix.pixelformat = camera.pixel_format;
                std::pair<int, int> nearest = camera.sizes.at(0);
                for (const auto& size : camera.sizes)
                    if (std::abs(size.first - static_cast<int>(pix.width)) < std::abs(nearest.first - static_cast<int>(pix.width)))
                        nearest = size;
                pix.width = static_cast<std::uint32_t>(nearest.first);
                pix.height = static_cast<std::uint32_t>(nearest.second);
                return 0;
            }
            case VIDIOC_ENUM_FRAMEINTERVALS: {
                auto& i = *static_cast<v4l2_frmivalenum*>(argument);
                if (i.index >= camera.rates.size()) return fail(EINVAL);
                i.type = V4L2_FRMIVAL_TYPE_DISCRETE;
                i.discrete = {10, static_cast<std::uint32_t>(10 * camera.rates[i.index])};
                return 0;
            }
            case VIDIOC_S_PARM:
                return 0;
            case VIDIOC_REQBUFS: {
                auto& r = *static_cast<v4l2_requestbuffers*>(argument);
                r.count = camera.buffer_count;
                open.memory.assign(r.count, std::vector<std::uint8_t>(camera.buffer_length));
                return 0;
            }
            case VIDIOC_QUERYBUF: {
                auto& b = *static_cast<v4l2_buffer*>(argument);
                if (b.index >= open.memory.size()) return fail(EINVAL);
                b.length = camera.buffer_length;
                b.m.offset = b.index * 65536;
                return 0;
            }
            case VIDIOC_QBUF: {
                const auto& b = *static_cast<v4l2_buffer*>(argument);
                if (b.index >= open.memory.size()) return fail(EINVAL);
                open.free.push_back(b.index);
                return 0;
            }
            case VIDIOC_DQBUF: {
                fetch(fd, camera);
                if (open.filled.empty()) return fail(EAGAIN);
                auto& b = *static_cast<v4l2_buffer*>(argument);
                const auto& [index, picture] = open.filled.front();
                b.index = picture.claimed_index >= 0 ? static_cast<std::uint32_t>(picture.claimed_index) : index;
                b.bytesused = static_cast<std::uint32_t>(picture.claimed_bytes >= 0 ? picture.claimed_bytes
                                                                                    : static_cast<std::int64_t>(picture.bytes.size()));
                b.flags = picture.flags;
                b.sequence = picture.sequence;
                b.timestamp.tv_sec = picture.time / ns_per_s;
                b.timestamp.tv_usec = picture.time % ns_per_s / 1000;
                open.filled.pop_front();
                return 0;
            }
            case VIDIOC_STREAMON:
                open.streams = true;
                ++camera.streaming;
                ++camera.times_started;
                return 0;
            case VIDIOC_STREAMOFF:
                if (open.streams) --camera.streaming;
                open.streams = false;
                open.free.clear();
                open.filled.clear();
                return 0;
            case VIDIOC_QUERYCTRL: {
                auto& q = *static_cast<v4l2_queryctrl*>(argument);
                q.minimum = 0;
                q.maximum = 255;
                return 0;
            }
            case VIDIOC_S_CTRL: {
                const auto& c = *static_cast<v4l2_control*>(argument);
                camera.controls[c.id] = c.value;
                return 0;
            }
            default:
                return fail(ENOTTY);
        }
    }

    std::map<int, Open> open_;
    int last_fd_ = 100;
};

}  // namespace entoptic::drivers::testing
