// Paths of one instance: strings and the numbers that stand for them. Thread-safe.
#pragma once

#include "runtime/objects/outcome.h"

#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>
#include <deque>

namespace entoptic::runtime {

// One level of a path, or an action's name: [a-z0-9-_.]+ and not dots only.
bool valid_path_level(std::string_view level);
// "/a/b": at least one level, no trailing slash, shorter than XR_MAX_PATH_LENGTH.
bool valid_path(std::string_view path);

class PathTable {
public:
    // XR_ERROR_PATH_FORMAT_INVALID, XR_ERROR_PATH_COUNT_EXCEEDED.
    Outcome from_string(std::string_view text, XrPath& path);
    // For names the runtime itself knows to be well formed.
    XrPath known(std::string_view text);
    // XR_ERROR_PATH_INVALID.
    Outcome to_string(XrPath path, std::string& text) const;
    bool valid(XrPath path) const;
    // Empty for an unknown number.
    std::string text(XrPath path) const;

private:
    mutable std::mutex mutex_;
    std::deque<std::string> texts_;
    std::unordered_map<std::string_view, XrPath> paths_;  // views into texts_
};

}  // namespace entoptic::runtime
