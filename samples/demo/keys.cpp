#include "samples/demo/keys.h"

#include <poll.h>
#include <unistd.h>

namespace samples {

KeyReader::KeyReader() {
    termios state{};
    // A job in the background that changes the terminal would be stopped by SIGTTOU.
    if (isatty(STDIN_FILENO) == 0 || tcgetpgrp(STDIN_FILENO) != getpgrp() || tcgetattr(STDIN_FILENO, &state) != 0) { return; }
    saved_ = state;
    state.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    state.c_cc[VMIN] = 0;
    state.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSANOW, &state);
}

KeyReader::~KeyReader() {
    if (saved_) { tcsetattr(STDIN_FILENO, TCSANOW, &*saved_); }
}

std::optional<char> KeyReader::next() const {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    char key = 0;
    if (saved_ && poll(&input, 1, 0) == 1 && (input.revents & POLLIN) != 0 && read(STDIN_FILENO, &key, 1) == 1) { return key; }
    return std::nullopt;
}

}  // namespace samples
