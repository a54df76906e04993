#include "runtime/objects/action_input.h"

#include "runtime/objects/instance.h"

#include <algorithm>
#include <cmath>

namespace entoptic::runtime {

namespace {

constexpr float press_threshold = 0.6f, release_threshold = 0.4f;
constexpr unsigned all_users = (1u << user_path_count) - 1;

constexpr std::size_t index_of(UserPath user) { return static_cast<std::size_t>(user); }
constexpr unsigned bit_of(UserPath user) { return 1u << static_cast<unsigned>(user); }
constexpr bool is_hand(UserPath user) { return user == UserPath::left_hand || user == UserPath::right_hand; }

bool convertible(ComponentKind from, ComponentKind to) {
    const auto number = [](ComponentKind kind) { return kind == ComponentKind::boolean || kind == ComponentKind::scalar; };
    return from == to || (number(from) && number(to));
}

// Stronger of two values: true over false, larger magnitude, longer vector.
bool stronger(const ComponentValue& a, const ComponentValue& b) { return a.x * a.x + a.y * a.y > b.x * b.x + b.y * b.y; }

void advance(ActionState& state, bool active, ComponentValue value, TimeNs now) {
    if (!active) {
        state = {};
        return;
    }
    state.changed = value.x != state.x || value.y != state.y;
    if (state.changed) state.last_change = now;
    state.active = true;
    state.x = value.x;
    state.y = value.y;
}

}  // namespace

struct ActionInput::SyncContext {
    TimeNs now = 0;
    std::array<ControllerState, 2> controllers;
    std::array<bool, user_path_count> present{};
    std::array<bool, user_path_count> overridden{};         // played by the application
    std::map<const ActionSet*, unsigned> active_users;      // bits of the user paths a set is active for
    std::map<std::string, std::uint32_t> highest_priority;  // of the active sets with a binding to this identifier
};

Outcome ActionInput::attach(const std::vector<std::shared_ptr<ActionSet>>& sets) {
    std::lock_guard lock(mutex_);
    if (attached_) {
        return error(XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "this session has its action sets already; attach all of them in one call");
    }
    attached_ = true;
    sets_ = sets;
    for (const auto& set : sets) {
        set->mark_attached();
        for (auto& action : set->actions()) bound_.push_back({std::move(action), {}, {}, {}, {}, {}, false});
    }
    for (auto& [path, suggestions] : instance_.suggestions().all()) suggestions_[find_profile(path)] = std::move(suggestions);
    for (int i = 0; i < user_path_count; ++i) best_[static_cast<std::size_t>(i)] = best_profile(static_cast<UserPath>(i));
    choose_profiles();
    return XR_SUCCESS;
}

bool ActionInput::suggested(const Profile& profile, UserPath user) const {
    const auto entry = suggestions_.find(&profile);
    if (entry == suggestions_.end()) return false;
    return std::any_of(entry->second.bindings.begin(), entry->second.bindings.end(), [&](const SuggestedBinding& binding) {
        const auto action = binding.action.lock();
        const auto split = split_binding_path(binding.path);
        return action && split && split->user == user && find(*action);
    });
}

// Hands present themselves as the most capable profile that the application has bindings for.
const Profile* ActionInput::best_profile(UserPath user) const {
    const Profile* best = nullptr;
    for (const auto& [profile, suggestions] : suggestions_) {
        const bool better = !best || profile->preference < best->preference;
        if (better && (profile->preference < 100 || !is_hand(user)) && suggested(*profile, user)) best = profile;
    }
    return best;
}

// Binds again when a device came that is another one than before.
void ActionInput::choose_profiles() {
    std::array<const Profile*, user_path_count> chosen{};
    for (int i = 0; i < user_path_count; ++i) {
        const auto user = static_cast<UserPath>(i);
        const auto device = overrides_.device(user);
        const bool as_played = device && device->active && suggested(*device->profile, user);
        chosen[index_of(user)] = as_played ? device->profile : best_[index_of(user)];
    }
    if (chosen == candidates_) return;
    candidates_ = chosen;
    for (Bound& bound : bound_) bind(bound);
}

DpadSettings ActionInput::dpad_settings(const Bound& bound, const ProfileSuggestions& suggestions, std::string_view path,
                                        Source source) const {
    for (const SuggestedDpad& dpad : suggestions.dpads) {
        if (is_dpad(source) && path.starts_with(dpad.path + "/") && dpad.set.lock() == bound.action->set) return dpad.settings;
    }
    return {};
}

void ActionInput::bind(Bound& bound) const {
    const ComponentKind wanted = kind_of(bound.action->type);
    bound.bindings.clear();
    for (const auto& [profile, suggestions] : suggestions_) {
        for (const SuggestedBinding& suggestion : suggestions.bindings) {
            const auto split = split_binding_path(suggestion.path);
            if (suggestion.action.lock() != bound.action || !split || candidates_[index_of(split->user)] != profile) continue;
            const Component* component = profile->find(split->user, split->below, wanted, instance_.features());
            const bool declared = bound.action->subaction_paths.empty() || bound.action->declares(split->user);
            if (!component || !convertible(component->kind, wanted) || !declared) continue;
            const std::string user(user_path_text(split->user));
            bound.bindings.push_back({split->user, component, suggestion.path, user + std::string(identifier_of(split->below)),
                                      dpad_settings(bound, suggestions, suggestion.path, component->source)});
        }
    }
}

bool ActionInput::attached() const {
    std::lock_guard lock(mutex_);
    return attached_;
}

Outcome ActionInput::check_attached(const Action& action) const {
    std::lock_guard lock(mutex_);
    for (const auto& set : sets_) {
        if (set == action.set) return XR_SUCCESS;
    }
    return error(XR_ERROR_ACTIONSET_NOT_ATTACHED, "action set \"{}\" is not attached to this session; call xrAttachSessionActionSets first",
                 action.set->name);
}

const ActionInput::Bound* ActionInput::find(const Action& action) const {
    for (const Bound& bound : bound_) {
        if (bound.action.get() == &action) return &bound;
    }
    return nullptr;
}

ActionInput::SyncContext ActionInput::read_devices(TimeNs now) {
    SyncContext context;
    context.now = now;
    Headset& headset = instance_.host().headset();
    for (std::size_t hand = 0; hand < 2; ++hand) {
        if (headset.controllers[hand]) context.controllers[hand] = headset.controllers[hand]->state_at(now);
        context.present[hand] = headset.controllers[hand] && context.controllers[hand].active;
    }
    context.present[index_of(UserPath::head)] = true;
    context.present[index_of(UserPath::eyes)] = headset.eye_tracker && headset.eye_tracker->present();
    for (int i = 0; i < user_path_count; ++i) {
        const auto device = overrides_.device(static_cast<UserPath>(i));
        if (device) context.present[static_cast<std::size_t>(i)] = context.overridden[static_cast<std::size_t>(i)] = device->active;
    }
    return context;
}

// What the application set for the component: itself, or the axis of its stick.
ComponentValue ActionInput::read_override(UserPath user, std::string_view component) const {
    const std::string path = std::string(user_path_text(user)) + std::string(component);
    if (const auto value = overrides_.value(path)) return *value;
    const bool x = path.ends_with("/x"), y = path.ends_with("/y");
    const auto stick = x || y ? overrides_.value(path.substr(0, path.size() - 2)) : std::nullopt;
    return stick ? ComponentValue{x ? stick->x : stick->y, 0} : ComponentValue{};
}

ComponentValue ActionInput::read(UserPath user, Source source, std::string_view component, const SyncContext& context) const {
    if (context.overridden[index_of(user)]) return read_override(user, component);
    return is_hand(user) ? read_component(source, context.controllers[index_of(user)]) : ComponentValue{};
}

ComponentValue ActionInput::read(const Binding& binding, const SyncContext& context) const {
    const Source source = binding.component->source;
    const bool set = context.overridden[index_of(binding.user)] &&
                     overrides_.value(std::string(user_path_text(binding.user)) + std::string(binding.component->path));
    if (!is_dpad(source) || set) return read(binding.user, source, binding.component->path, context);
    const bool stick = dpad_parent(source) == "/input/thumbstick";
    const ComponentValue thumb = read(binding.user, stick ? Source::thumbstick : Source::trackpad, dpad_parent(source), context);
    const float press = stick ? 1.0f : read(binding.user, Source::trackpad_click, "/input/trackpad/click", context).x;
    return {dpad_pressed(source, thumb, press, binding.dpad, binding.pressed) ? 1.0f : 0.0f, 0};
}

bool ActionInput::update_profiles(const SyncContext& context) {
    bool changed = false;
    for (std::size_t user = 0; user < user_path_count; ++user) {
        const Profile* profile = context.present[user] ? candidates_[user] : nullptr;
        changed |= profile != current_[user];
        current_[user] = profile;
    }
    return changed;
}

bool ActionInput::usable(const Bound& bound, const Binding& binding, const SyncContext& context) {
    const auto active = context.active_users.find(bound.action->set.get());
    return active != context.active_users.end() && (active->second & bit_of(binding.user)) != 0 && context.present[index_of(binding.user)];
}

// An input that actions of several active sets are bound to belongs to the set of the highest priority.
void ActionInput::set_priorities(SyncContext& context) {
    for (const Bound& bound : bound_) {
        for (const Binding& binding : bound.bindings) {
            if (!usable(bound, binding, context)) continue;
            auto [entry, added] = context.highest_priority.try_emplace(binding.identifier, bound.action->set->priority);
            if (!added) entry->second = std::max(entry->second, bound.action->set->priority);
        }
    }
}

void ActionInput::update(Bound& bound, const SyncContext& context) {
    std::array<bool, user_path_count> active{};
    std::array<ComponentValue, user_path_count> values{};
    std::array<std::optional<PoseRoot>, user_path_count> roots{};
    std::optional<PoseRoot> root;
    bool keeps_root = false, root_usable = false;
    const bool to_boolean = bound.action->type == XR_ACTION_TYPE_BOOLEAN_INPUT;
    for (Binding& binding : bound.bindings) {
        const bool outranked = bound.action->type != XR_ACTION_TYPE_VIBRATION_OUTPUT && usable(bound, binding, context) &&
                               context.highest_priority.at(binding.identifier) > bound.action->set->priority;
        const PoseRoot candidate{binding.user, binding.component->source, binding.component->path};
        keeps_root |= bound.root == candidate;
        if (!usable(bound, binding, context) || outranked) {
            binding.pressed = false;
            continue;
        }
        const std::size_t user = index_of(binding.user);
        ComponentValue value = read(binding, context);
        if (to_boolean || binding.component->kind == ComponentKind::boolean) {
            binding.pressed = value.x >= (binding.pressed ? release_threshold : press_threshold);
            value = {binding.pressed ? 1.0f : 0.0f, 0};
        }
        if (!active[user] || stronger(value, values[user])) values[user] = value;
        active[user] = true;
        if (!roots[user]) roots[user] = candidate;
        if (!root) root = candidate;
        root_usable |= bound.root == candidate;
    }
    ComponentValue combined;
    bool any = false;
    for (std::size_t user = 0; user < user_path_count; ++user) {
        advance(bound.by_user[user], active[user], values[user], context.now);
        if (!active[user]) continue;
        if (!any || stronger(values[user], combined)) combined = values[user];
        any = true;
    }
    advance(bound.combined, any, combined, context.now);
    bound.root_by_user = roots;
    if (!keeps_root) bound.root = root;
    bound.root_usable = keeps_root ? root_usable : root.has_value();
}

Outcome ActionInput::sync(const std::vector<ActiveSet>& active, TimeNs now, bool focused, bool& profile_changed) {
    SyncContext context = read_devices(now);
    std::lock_guard lock(mutex_);
    for (const ActiveSet& entry : active) {
        if (std::find(sets_.begin(), sets_.end(), entry.set) == sets_.end()) {
            return error(XR_ERROR_ACTIONSET_NOT_ATTACHED, "action set \"{}\" is not attached to this session", entry.set->name);
        }
        const auto declares = [&](const Bound& bound) {
            return bound.action->set == entry.set && bound.action->declares(*entry.subaction);
        };
        if (entry.subaction && std::none_of(bound_.begin(), bound_.end(), declares)) {
            return error(XR_ERROR_PATH_UNSUPPORTED, "no action of set \"{}\" was created with the subaction path {}", entry.set->name,
                         user_path_text(*entry.subaction));
        }
        context.active_users[entry.set.get()] |= entry.subaction ? bit_of(*entry.subaction) : all_users;
    }
    choose_profiles();
    profile_changed = update_profiles(context);
    if (!focused) context.active_users.clear();
    set_priorities(context);
    for (Bound& bound : bound_) update(bound, context);
    return focused ? XR_SUCCESS : XR_SESSION_NOT_FOCUSED;
}

void ActionInput::release_all() {
    std::lock_guard lock(mutex_);
    const SyncContext nothing;
    for (Bound& bound : bound_) update(bound, nothing);
}

ActionState ActionInput::state(const Action& action, std::optional<UserPath> subaction) const {
    std::lock_guard lock(mutex_);
    const Bound* bound = find(action);
    if (!bound) return {};
    return subaction ? bound->by_user[index_of(*subaction)] : bound->combined;
}

std::optional<PoseRoot> ActionInput::pose_root(const Action& action, std::optional<UserPath> subaction) const {
    std::lock_guard lock(mutex_);
    const Bound* bound = find(action);
    if (!bound) return std::nullopt;
    if (subaction) return bound->root_by_user[index_of(*subaction)];
    return bound->root_usable ? bound->root : std::nullopt;
}

std::vector<UserPath> ActionInput::haptic_outputs(const Action& action, std::optional<UserPath> subaction) const {
    std::lock_guard lock(mutex_);
    std::vector<UserPath> outputs;
    const Bound* bound = find(action);
    if (!bound) return outputs;
    for (const Binding& binding : bound->bindings) {
        const bool wanted = binding.component->source == Source::haptic && (!subaction || *subaction == binding.user);
        if (wanted && std::find(outputs.begin(), outputs.end(), binding.user) == outputs.end()) outputs.push_back(binding.user);
    }
    return outputs;
}

std::vector<std::string> ActionInput::bound_sources(const Action& action) const {
    std::lock_guard lock(mutex_);
    std::vector<std::string> sources;
    const Bound* bound = find(action);
    if (!bound) return sources;
    for (const Binding& binding : bound->bindings) {
        const bool there = current_[index_of(binding.user)] != nullptr;
        if (there && std::find(sources.begin(), sources.end(), binding.path) == sources.end()) sources.push_back(binding.path);
    }
    return sources;
}

const Profile* ActionInput::current_profile(UserPath user) const {
    std::lock_guard lock(mutex_);
    return current_[index_of(user)];
}

}  // namespace entoptic::runtime
