#include "runtime/objects/name_registry.h"

#include "runtime/objects/path_table.h"

namespace entoptic::runtime {

namespace {

int utf8_length(unsigned char lead) {
    if (lead < 0x80) return 1;
    if (lead >= 0xc2 && lead < 0xe0) return 2;
    if (lead >= 0xe0 && lead < 0xf0) return 3;
    if (lead >= 0xf0 && lead < 0xf5) return 4;
    return 0;
}

bool valid_utf8(const std::string& text) {
    for (std::size_t i = 0; i < text.size();) {
        const int length = utf8_length(static_cast<unsigned char>(text[i]));
        if (length == 0 || i + std::size_t(length) > text.size()) return false;
        for (int k = 1; k < length; ++k) {
            if ((static_cast<unsigned char>(text[i + std::size_t(k)]) & 0xc0) != 0x80) return false;
        }
        i += std::size_t(length);
    }
    return true;
}

}  // namespace

Outcome check_names(const std::string& name, const std::string& localized) {
    if (name.empty()) return error(XR_ERROR_NAME_INVALID, "the name is empty or not terminated");
    if (!valid_path_level(name)) return error(XR_ERROR_PATH_FORMAT_INVALID, "\"{}\" may hold only [a-z0-9-_.]", name);
    if (localized.empty()) return error(XR_ERROR_LOCALIZED_NAME_INVALID, "the localized name of \"{}\" is empty or not terminated", name);
    if (!valid_utf8(localized)) return error(XR_ERROR_LOCALIZED_NAME_INVALID, "the localized name of \"{}\" is not UTF-8", name);
    return XR_SUCCESS;
}

Outcome NameRegistry::add(const std::string& name, const std::string& localized) {
    std::lock_guard lock(mutex_);
    if (names_.contains(name)) return error(XR_ERROR_NAME_DUPLICATED, "the name \"{}\" is taken", name);
    if (localized_.contains(localized)) return error(XR_ERROR_LOCALIZED_NAME_DUPLICATED, "the localized name \"{}\" is taken", localized);
    names_.insert(name);
    localized_.insert(localized);
    return XR_SUCCESS;
}

void NameRegistry::remove(const std::string& name, const std::string& localized) {
    std::lock_guard lock(mutex_);
    names_.erase(name);
    localized_.erase(localized);
}

}  // namespace entoptic::runtime
