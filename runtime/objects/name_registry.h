// Names that must be unique among living siblings: action sets of an instance, actions of a set. Thread-safe.
#pragma once

#include "runtime/objects/outcome.h"

#include <mutex>
#include <set>
#include <string>

namespace entoptic::runtime {

// Checks a name ([a-z0-9-_.]) and its localized form (UTF-8, not empty): XR_ERROR_NAME_INVALID, XR_ERROR_PATH_FORMAT_INVALID,
// XR_ERROR_LOCALIZED_NAME_INVALID.
Outcome check_names(const std::string& name, const std::string& localized);

class NameRegistry {
public:
    // XR_ERROR_NAME_DUPLICATED, XR_ERROR_LOCALIZED_NAME_DUPLICATED; nothing is added then.
    Outcome add(const std::string& name, const std::string& localized);
    void remove(const std::string& name, const std::string& localized);

private:
    std::mutex mutex_;
    std::set<std::string> names_, localized_;
};

}  // namespace entoptic::runtime
