// The kernel's side of a video camera, as the few calls that are made of it: the seam at which tests put a camera of their own, with the
// faults they want.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace entoptic::drivers {

// As the system calls of the same names: -1 (or MAP_FAILED) and errno on failure.
class VideoSystem {
public:
    virtual ~VideoSystem() = default;
    virtual std::vector<std::string> nodes() = 0;  // paths of the video devices, sorted
    virtual int open(const char* path) = 0;        // reading and writing, not blocking
    virtual int close(int fd) = 0;
    virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
    virtual void* map(int fd, std::size_t length, std::size_t offset) = 0;
    virtual int unmap(void* address, std::size_t length) = 0;
    // 1: a picture or an error is there; 0: not within `timeout_ms`.
    virtual int wait(int fd, int timeout_ms) = 0;
};

// The machine's own. Lives for ever.
VideoSystem& linux_video_system();

}  // namespace entoptic::drivers
