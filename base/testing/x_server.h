// An X server for tests. Header-only.
#pragma once

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace entoptic::testing {

// An X server without a screen of its own (Debian's package xvfb), for as long as this lives.
// It does not start anew when the last client goes: the next one might come just then.
class VirtualServer {
public:
    VirtualServer() {
        int ends[2];
        if (pipe(ends) != 0) return;
        process_ = fork();
        if (process_ == 0) {
            // It must not outlive a test that crashes, nor hold its output open.
            prctl(PR_SET_PDEATHSIG, SIGTERM);
            const int nowhere = open("/dev/null", O_RDWR);
            dup2(nowhere, 1);
            dup2(nowhere, 2);
            const std::string number = std::to_string(ends[1]);
            execlp("Xvfb", "Xvfb", "-noreset", "-displayfd", number.c_str(), "-screen", "0", "640x480x24", static_cast<char*>(nullptr));
            _exit(127);
        }
        close(ends[1]);
        char text[16] = {};
        // The number comes before the line's end, sometimes by itself.
        for (std::size_t length = 0; length < sizeof text - 1 && !std::strchr(text, '\n');) {
            const ssize_t got = read(ends[0], text + length, sizeof text - 1 - length);
            if (got <= 0) break;
            length += static_cast<std::size_t>(got);
        }
        if (std::strchr(text, '\n')) display_ = ":" + std::to_string(std::atoi(text));
        close(ends[0]);
    }
    ~VirtualServer() {
        if (process_ <= 0) return;
        kill(process_, SIGTERM);
        waitpid(process_, nullptr, 0);
    }
    const std::string& display() const { return display_; }  // empty: there is no Xvfb

private:
    pid_t process_ = -1;
    std::string display_;
};

}  // namespace entoptic::testing
