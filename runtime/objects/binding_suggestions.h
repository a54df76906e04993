// What the application suggested with xrSuggestInteractionProfileBindings. Thread-safe.
#pragma once

#include "runtime/openxr.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace entoptic::runtime {

class Action;

struct SuggestedBinding {
    std::weak_ptr<Action> action;
    std::string path;
};

class BindingSuggestions {
public:
    // Replaces what was suggested for this profile before.
    void set(const std::string& profile, std::vector<SuggestedBinding> bindings) {
        std::lock_guard lock(mutex_);
        by_profile_[profile] = std::move(bindings);
    }
    std::map<std::string, std::vector<SuggestedBinding>> all() const {
        std::lock_guard lock(mutex_);
        return by_profile_;
    }

private:
    mutable std::mutex mutex_;
    std::map<std::string, std::vector<SuggestedBinding>> by_profile_;
};

}  // namespace entoptic::runtime
