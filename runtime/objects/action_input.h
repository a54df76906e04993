// The input side of one session: attached action sets, their bindings, and the states of the last xrSyncActions. Thread-safe.
#pragma once

#include "interfaces/headset.h"
#include "runtime/objects/action.h"
#include "runtime/objects/binding_suggestions.h"
#include "runtime/objects/device_overrides.h"
#include "runtime/objects/outcome.h"

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace entoptic::runtime {

// One action's state, of one subaction path or of all together.
struct ActionState {
    bool active = false, changed = false;
    TimeNs last_change = 0;
    float x = 0, y = 0;
};

// The device part a pose action follows.
struct PoseRoot {
    UserPath user = UserPath::left_hand;
    Source source = Source::none;
    std::string_view component;  // "/input/grip/pose"
    bool operator==(const PoseRoot&) const = default;
};

struct ActiveSet {
    std::shared_ptr<ActionSet> set;
    std::optional<UserPath> subaction;  // nothing: all
};

class ActionInput {
public:
    explicit ActionInput(Instance& instance) : instance_(instance) {}

    // Takes the suggestions made so far and binds. XR_ERROR_ACTIONSETS_ALREADY_ATTACHED.
    Outcome attach(const std::vector<std::shared_ptr<ActionSet>>& sets);
    bool attached() const;
    // XR_ERROR_ACTIONSET_NOT_ATTACHED unless this action's set is.
    Outcome check_attached(const Action& action) const;

    // Reads the devices at `now`. Without focus every action becomes inactive and XR_SESSION_NOT_FOCUSED is returned.
    // `profile_changed` tells that the current profile of some user path is another one than before.
    Outcome sync(const std::vector<ActiveSet>& active, TimeNs now, bool focused, bool& profile_changed);
    // The session lost the focus: nothing is active until the next sync.
    void release_all();

    // The action is attached; `subaction` is declared by it.
    ActionState state(const Action& action, std::optional<UserPath> subaction) const;
    std::optional<PoseRoot> pose_root(const Action& action, std::optional<UserPath> subaction) const;
    // User paths with a haptic output bound to the action.
    std::vector<UserPath> haptic_outputs(const Action& action, std::optional<UserPath> subaction) const;
    // Binding paths of the action on the devices that are there now.
    std::vector<std::string> bound_sources(const Action& action) const;
    // Null while no profile is current.
    const Profile* current_profile(UserPath user) const;
    // Devices that the application plays itself; they take effect with the next sync.
    DeviceOverrides& overrides() { return overrides_; }

private:
    struct Binding {
        UserPath user;
        const Component* component;
        std::string path, identifier;  // full binding path; user path and identifier, what priorities are about
        DpadSettings dpad;
        bool pressed = false;  // hysteresis of scalar to boolean
    };
    struct Bound {
        std::shared_ptr<Action> action;
        std::vector<Binding> bindings;
        std::array<ActionState, user_path_count> by_user;
        ActionState combined;
        std::array<std::optional<PoseRoot>, user_path_count> root_by_user;
        std::optional<PoseRoot> root;  // of all subaction paths together: one device, kept while it is bound
        bool root_usable = false;      // and it is there
    };
    struct SyncContext;

    const Bound* find(const Action& action) const;
    bool suggested(const Profile& profile, UserPath user) const;
    const Profile* best_profile(UserPath user) const;
    void choose_profiles();
    void bind(Bound& bound) const;
    DpadSettings dpad_settings(const Bound& bound, const ProfileSuggestions& suggestions, std::string_view path, Source source) const;
    bool update_profiles(const SyncContext& context);
    void update(Bound& bound, const SyncContext& context);
    static bool usable(const Bound& bound, const Binding& binding, const SyncContext& context);
    SyncContext read_devices(TimeNs now);
    ComponentValue read(const Binding& binding, const SyncContext& context) const;
    ComponentValue read(UserPath user, Source source, std::string_view component, const SyncContext& context) const;
    ComponentValue read_override(UserPath user, std::string_view component) const;
    void set_priorities(SyncContext& context);

    Instance& instance_;
    mutable std::mutex mutex_;
    bool attached_ = false;
    std::vector<std::shared_ptr<ActionSet>> sets_;
    std::vector<Bound> bound_;
    DeviceOverrides overrides_;
    std::map<const Profile*, ProfileSuggestions> suggestions_;  // as they were when the sets were attached
    std::array<const Profile*, user_path_count> best_{};        // what the application's suggestions make of each user path
    std::array<const Profile*, user_path_count> candidates_{};  // what is bound: the same, or a device that the application plays
    std::array<const Profile*, user_path_count> current_{};
};

}  // namespace entoptic::runtime
