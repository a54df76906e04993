// Single key presses from a terminal.
#pragma once

#include <optional>

#include <termios.h>

namespace samples {

// While it lives, and if standard input is a terminal in the foreground, keys arrive without Enter and are not echoed. The
// terminal is restored at its end; Ctrl-C stays a signal.
class KeyReader {
public:
    KeyReader();
    KeyReader(const KeyReader&) = delete;
    KeyReader& operator=(const KeyReader&) = delete;
    ~KeyReader();

    bool active() const { return saved_.has_value(); }
    // The next key that waits, if any; never blocks.
    std::optional<char> next() const;

private:
    std::optional<termios> saved_;
};

}  // namespace samples
