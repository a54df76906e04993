#include "drivers/v4l2_camera/video_system.h"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <filesystem>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

namespace entoptic::drivers {

namespace {

// Retried when a signal came in between.
template <class Call> auto uninterrupted(Call call) {
    auto result = call();
    while (result == -1 && errno == EINTR) result = call();
    return result;
}

class LinuxVideoSystem final : public VideoSystem {
public:
    std::vector<std::string> nodes() override {
        std::vector<std::string> found;
        std::error_code error;
        for (std::filesystem::directory_iterator at("/dev", error), end; !error && at != end; at.increment(error))
            if (at->path().filename().string().rfind("video", 0) == 0) found.push_back(at->path().string());
        std::sort(found.begin(), found.end());
        return found;
    }
    int open(const char* path) override {
        return uninterrupted([&] { return ::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC); });
    }
    int close(int fd) override { return ::close(fd); }
    int ioctl(int fd, unsigned long request, void* argument) override {
        return uninterrupted([&] { return ::ioctl(fd, request, argument); });
    }
    void* map(int fd, std::size_t length, std::size_t offset) override {
        return ::mmap(nullptr, length, PROT_READ | PROT_WRITE, MAP_SHARED, fd, static_cast<off_t>(offset));
    }
    int unmap(void* address, std::size_t length) override { return ::munmap(address, length); }
    int wait(int fd, int timeout_ms) override {
        pollfd entry{fd, POLLIN, 0};
        return ::poll(&entry, 1, timeout_ms);
    }
};

}  // namespace

VideoSystem& linux_video_system() {
    static LinuxVideoSystem system;
    return system;
}

}  // namespace entoptic::drivers
