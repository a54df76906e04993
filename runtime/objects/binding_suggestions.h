// What the application suggested with xrSuggestInteractionProfileBindings. Thread-safe.
#pragma once

#include "runtime/objects/dpad.h"
#include "runtime/openxr.h"

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace entoptic::runtime {

class Action;
class ActionSet;

struct SuggestedBinding {
    std::weak_ptr<Action> action;
    std::string path;
};

// How the direction pad made of one stick or pad behaves for the actions of a set (XR_EXT_dpad_binding).
struct SuggestedDpad {
    std::string path;  // "/user/hand/left/input/trackpad"
    std::weak_ptr<ActionSet> set;
    DpadSettings settings;
};

struct ProfileSuggestions {
    std::vector<SuggestedBinding> bindings;
    std::vector<SuggestedDpad> dpads;
};

class BindingSuggestions {
public:
    // Replaces what was suggested for this profile before.
    void set(const std::string& profile, ProfileSuggestions suggestions) {
        std::lock_guard lock(mutex_);
        by_profile_[profile] = std::move(suggestions);
    }
    std::map<std::string, ProfileSuggestions> all() const {
        std::lock_guard lock(mutex_);
        return by_profile_;
    }

private:
    mutable std::mutex mutex_;
    std::map<std::string, ProfileSuggestions> by_profile_;
};

}  // namespace entoptic::runtime
