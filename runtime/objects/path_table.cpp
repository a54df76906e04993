#include "runtime/objects/path_table.h"

#include <algorithm>

namespace entoptic::runtime {

namespace {

constexpr std::size_t max_paths = std::size_t(1) << 20;

bool path_character(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.'; }

}  // namespace

bool valid_path_level(std::string_view level) {
    return std::all_of(level.begin(), level.end(), path_character) &&
           std::any_of(level.begin(), level.end(), [](char c) { return c != '.'; });
}

bool valid_path(std::string_view path) {
    if (path.size() < 2 || path.size() >= XR_MAX_PATH_LENGTH || path.front() != '/') return false;
    for (std::size_t begin = 1; begin <= path.size();) {
        const std::size_t end = std::min(path.find('/', begin), path.size());
        if (!valid_path_level(path.substr(begin, end - begin))) return false;
        begin = end + 1;
        if (end + 1 == path.size()) return false;  // ends with a slash
    }
    return true;
}

Outcome PathTable::from_string(std::string_view text, XrPath& path) {
    if (!valid_path(text)) {
        return error(XR_ERROR_PATH_FORMAT_INVALID, "\"{}\" is not a path: write levels of [a-z0-9-_.] that each follow a slash",
                     text.substr(0, 64));
    }
    std::lock_guard lock(mutex_);
    if (auto found = paths_.find(text); found != paths_.end()) {
        path = found->second;
        return XR_SUCCESS;
    }
    if (texts_.size() >= max_paths) return error(XR_ERROR_PATH_COUNT_EXCEEDED, "more than {} different paths", max_paths);
    texts_.emplace_back(text);
    path = texts_.size();
    paths_.emplace(texts_.back(), path);
    return XR_SUCCESS;
}

XrPath PathTable::known(std::string_view text) {
    XrPath path = XR_NULL_PATH;
    static_cast<void>(from_string(text, path).code());
    return path;
}

Outcome PathTable::to_string(XrPath path, std::string& text) const {
    std::lock_guard lock(mutex_);
    if (path == XR_NULL_PATH || path > texts_.size()) {
        return error(XR_ERROR_PATH_INVALID, "{} is not a path of this instance; get one from xrStringToPath", path);
    }
    text = texts_[path - 1];
    return XR_SUCCESS;
}

bool PathTable::valid(XrPath path) const {
    std::lock_guard lock(mutex_);
    return path != XR_NULL_PATH && path <= texts_.size();
}

std::string PathTable::text(XrPath path) const {
    std::lock_guard lock(mutex_);
    return path == XR_NULL_PATH || path > texts_.size() ? std::string() : texts_[path - 1];
}

}  // namespace entoptic::runtime
