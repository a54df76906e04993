// Action sets, actions, bindings, states and haptics.
#include "runtime/objects/action.h"

#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/paths.h"
#include "runtime/api/verify.h"
#include "runtime/objects/action_input.h"
#include "runtime/objects/session.h"

#include <cmath>

namespace entoptic::runtime::api {

namespace {

constexpr DurationNs shortest_vibration = 20'000'000;  // for XR_MIN_HAPTIC_DURATION

Outcome check_action_type(XrActionType type) {
    switch (type) {
        case XR_ACTION_TYPE_BOOLEAN_INPUT:
        case XR_ACTION_TYPE_FLOAT_INPUT:
        case XR_ACTION_TYPE_VECTOR2F_INPUT:
        case XR_ACTION_TYPE_POSE_INPUT:
        case XR_ACTION_TYPE_VIBRATION_OUTPUT:
            return XR_SUCCESS;
        default:
            return invalid("{} is not an action type", static_cast<int>(type));
    }
}

Outcome read_subaction_paths(Instance& instance, const XrActionCreateInfo& info, std::vector<UserPath>& users) {
    if (info.countSubactionPaths == 0) return XR_SUCCESS;
    ENTOPTIC_XR_TRY(require_pointer(info.subactionPaths, "createInfo->subactionPaths"));
    for (std::uint32_t i = 0; i < info.countSubactionPaths; ++i) {
        UserPath user{};
        ENTOPTIC_XR_TRY(to_user_path(instance, info.subactionPaths[i], user));
        if (std::find(users.begin(), users.end(), user) != users.end()) {
            return error(XR_ERROR_PATH_UNSUPPORTED, "the subaction path {} is given twice", user_path_text(user));
        }
        users.push_back(user);
    }
    return XR_SUCCESS;
}

Outcome read_binding(Instance& instance, const Profile& profile, const XrActionSuggestedBinding& given, SuggestedBinding& binding) {
    std::shared_ptr<Action> action;
    ENTOPTIC_XR_TRY(find(given.action, action));
    if (&action->instance() != &instance) return invalid("action \"{}\" belongs to another instance", action->name);
    ENTOPTIC_XR_TRY(instance.paths().to_string(given.binding, binding.path));
    const auto split = split_binding_path(binding.path);
    if (!split || !profile.find(split->user, split->below, kind_of(action->type), instance.features())) {
        return error(XR_ERROR_PATH_UNSUPPORTED, "{} has no path {}", profile.path, binding.path);
    }
    if (action->set->attached()) {
        return error(XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "action set \"{}\" is attached to a session; suggest bindings before",
                     action->set->name);
    }
    binding.action = action;
    return XR_SUCCESS;
}

// XR_ERROR_VALIDATION_FAILURE unless the ranges are those of XrInteractionProfileDpadBindingEXT. Written so that NaN fails.
Outcome check_dpad(const XrInteractionProfileDpadBindingEXT& given) {
    const auto force = [](float value) { return value > 0 && value <= 1; };
    if (!force(given.forceThreshold) || !force(given.forceThresholdReleased) || given.forceThresholdReleased > given.forceThreshold) {
        return invalid("forceThreshold {} and forceThresholdReleased {} must lie in (0, 1], the second not above the first",
                       given.forceThreshold, given.forceThresholdReleased);
    }
    if (!(given.centerRegion > 0 && given.centerRegion < 1)) return invalid("centerRegion {} must lie in (0, 1)", given.centerRegion);
    constexpr float half_turn = 3.14159265f;
    if (!(given.wedgeAngle >= 0 && given.wedgeAngle < half_turn)) return invalid("wedgeAngle {} must lie in [0, pi)", given.wedgeAngle);
    return XR_SUCCESS;
}

Outcome read_dpad(Instance& instance, const Profile& profile, const XrInteractionProfileDpadBindingEXT& given,
                  std::vector<SuggestedDpad>& dpads) {
    SuggestedDpad dpad;
    ENTOPTIC_XR_TRY(instance.paths().to_string(given.binding, dpad.path));
    const auto split = split_binding_path(dpad.path);
    const std::string up = split ? std::string(split->below) + "/dpad_up" : std::string();
    if (!split || !profile.find(split->user, up, ComponentKind::boolean, instance.features())) {
        return error(XR_ERROR_PATH_UNSUPPORTED, "{} has no stick or pad {} that could be a direction pad", profile.path, dpad.path);
    }
    std::shared_ptr<ActionSet> set;
    ENTOPTIC_XR_TRY(find(given.actionSet, set));
    ENTOPTIC_XR_TRY(check_dpad(given));
    for (const SuggestedDpad& other : dpads) {
        if (other.path == dpad.path && other.set.lock() == set) return invalid("{} is modified twice for one action set", dpad.path);
    }
    dpad.set = set;
    dpad.settings = {given.forceThreshold, given.forceThresholdReleased, given.centerRegion, given.wedgeAngle, given.isSticky == XR_TRUE};
    dpads.push_back(std::move(dpad));
    return XR_SUCCESS;
}

Outcome read_modifications(Instance& instance, const Profile& profile, const void* chain, std::vector<SuggestedDpad>& dpads) {
    if (!instance.enabled(XR_KHR_BINDING_MODIFICATION_EXTENSION_NAME)) return XR_SUCCESS;
    const auto* given = chained<XrBindingModificationsKHR>(chain, XR_TYPE_BINDING_MODIFICATIONS_KHR);
    if (!given || given->bindingModificationCount == 0) return XR_SUCCESS;
    ENTOPTIC_XR_TRY(require_pointer(given->bindingModifications, "bindingModifications"));
    for (std::uint32_t i = 0; i < given->bindingModificationCount; ++i) {
        const auto* modification = given->bindingModifications[i];
        ENTOPTIC_XR_TRY(require_pointer(modification, "a binding modification"));
        if (modification->type != XR_TYPE_INTERACTION_PROFILE_DPAD_BINDING_EXT || !instance.has(feature_dpad)) {
            return invalid("binding modification {} is of type {}, which no enabled extension has", i,
                           static_cast<int>(modification->type));
        }
        ENTOPTIC_XR_TRY(read_dpad(instance, profile, *reinterpret_cast<const XrInteractionProfileDpadBindingEXT*>(modification), dpads));
    }
    return XR_SUCCESS;
}

// What the functions on one action of a session have in common.
struct ActionQuery {
    std::shared_ptr<Session> session;
    std::shared_ptr<Action> action;
    std::optional<UserPath> subaction;
};

Outcome read_query(XrAction action_handle, XrPath subaction, XrActionType type, ActionQuery& query) {
    ENTOPTIC_XR_TRY(find(action_handle, query.action));
    if (&query.action->instance() != &query.session->instance()) return invalid("the action belongs to another instance than the session");
    if (query.action->type != type) {
        return error(XR_ERROR_ACTION_TYPE_MISMATCH, "action \"{}\" is of another type than this function's", query.action->name);
    }
    if (subaction != XR_NULL_PATH) {
        std::string text;
        ENTOPTIC_XR_TRY(query.session->instance().paths().to_string(subaction, text));
        query.subaction = parse_user_path(text);
        if (!query.subaction || !query.action->declares(*query.subaction)) {
            return error(XR_ERROR_PATH_UNSUPPORTED, "action \"{}\" was not created with the subaction path {}", query.action->name, text);
        }
    }
    return query.session->input().check_attached(*query.action);
}

template <class State>
Outcome get_state(XrSession handle, const XrActionStateGetInfo* info, State* state, XrStructureType state_type, XrActionType type,
                  ActionState& found) {
    ActionQuery query;
    ENTOPTIC_XR_TRY(find(handle, query.session));
    ENTOPTIC_XR_TRY(require(info, XR_TYPE_ACTION_STATE_GET_INFO, "getInfo"));
    ENTOPTIC_XR_TRY(require(state, state_type, "state"));
    ENTOPTIC_XR_TRY(read_query(info->action, info->subactionPath, type, query));
    found = query.session->input().state(*query.action, query.subaction);
    state->isActive = found.active;
    return XR_SUCCESS;
}

template <class State> void write_change(const ActionState& found, State* state) {
    state->changedSinceLastSync = found.changed;
    state->lastChangeTime = found.last_change;
}

Outcome read_active_sets(Instance& instance, const XrActionsSyncInfo& info, std::vector<ActiveSet>& active) {
    if (info.countActiveActionSets == 0) return XR_SUCCESS;
    ENTOPTIC_XR_TRY(require_pointer(info.activeActionSets, "syncInfo->activeActionSets"));
    for (std::uint32_t i = 0; i < info.countActiveActionSets; ++i) {
        const XrActiveActionSet& given = info.activeActionSets[i];
        ActiveSet entry;
        ENTOPTIC_XR_TRY(find(given.actionSet, entry.set));
        if (given.subactionPath != XR_NULL_PATH) {
            UserPath user{};
            ENTOPTIC_XR_TRY(to_user_path(instance, given.subactionPath, user));
            entry.subaction = user;
        }
        active.push_back(std::move(entry));
    }
    return XR_SUCCESS;
}

Outcome read_haptic(XrSession handle, const XrHapticActionInfo* info, ActionQuery& query) {
    ENTOPTIC_XR_TRY(find(handle, query.session));
    ENTOPTIC_XR_TRY(require(info, XR_TYPE_HAPTIC_ACTION_INFO, "hapticActionInfo"));
    return read_query(info->action, info->subactionPath, XR_ACTION_TYPE_VIBRATION_OUTPUT, query);
}

Outcome vibrate(const ActionQuery& query, DurationNs duration, float frequency, float amplitude) {
    if (!query.session->focused()) return XR_SESSION_NOT_FOCUSED;
    RuntimeHost& host = query.session->host();
    for (const UserPath user : query.session->input().haptic_outputs(*query.action, query.subaction)) {
        ControllerSource* controller = host.headset().controllers[user == UserPath::right_hand ? 1 : 0];
        if (controller) controller->vibrate(host.clock().now(), duration, frequency, amplitude);
    }
    return XR_SUCCESS;
}

Outcome check_vibration(const XrHapticVibration& vibration) {
    if (vibration.duration < 0 && vibration.duration != XR_MIN_HAPTIC_DURATION) return invalid("the vibration's duration is negative");
    if (!std::isfinite(vibration.amplitude) || !std::isfinite(vibration.frequency) || vibration.frequency < 0) {
        return invalid("the vibration's amplitude and frequency must be finite and the frequency not negative");
    }
    return XR_SUCCESS;
}

std::string source_name(const Profile* profile, const SplitPath& split, XrInputSourceLocalizedNameFlags parts) {
    std::string text;
    const auto append = [&](std::string_view part) { text += (text.empty() || part.empty() ? "" : " ") + std::string(part); };
    if (parts & XR_INPUT_SOURCE_LOCALIZED_NAME_USER_PATH_BIT) append(user_path_name(split.user));
    if (parts & XR_INPUT_SOURCE_LOCALIZED_NAME_INTERACTION_PROFILE_BIT) append(profile ? profile->name : "Controller");
    if (parts & XR_INPUT_SOURCE_LOCALIZED_NAME_COMPONENT_BIT) append(component_name(split.below));
    return text;
}

}  // namespace

XrResult XRAPI_CALL create_action_set(XrInstance handle, const XrActionSetCreateInfo* info, XrActionSet* set_handle) {
    return call("xrCreateActionSet", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_ACTION_SET_CREATE_INFO, "createInfo"));
        ENTOPTIC_XR_TRY(require_pointer(set_handle, "actionSet"));
        const std::string name = bounded_text(info->actionSetName), localized = bounded_text(info->localizedActionSetName);
        ENTOPTIC_XR_TRY(check_names(name, localized));
        auto set = std::make_shared<ActionSet>(instance, name, localized, info->priority);
        ENTOPTIC_XR_TRY(instance->action_set_names().add(name, localized));
        return publish(set, handle_value(handle), set_handle);
    });
}

XrResult XRAPI_CALL destroy_action_set(XrActionSet handle) {
    return call("xrDestroyActionSet", handle, [&] { return destroy<ActionSet>(handle_value(handle)); });
}

XrResult XRAPI_CALL create_action(XrActionSet handle, const XrActionCreateInfo* info, XrAction* action_handle) {
    return call("xrCreateAction", handle, [&]() -> Outcome {
        std::shared_ptr<ActionSet> set;
        ENTOPTIC_XR_TRY(find(handle, set));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_ACTION_CREATE_INFO, "createInfo"));
        ENTOPTIC_XR_TRY(require_pointer(action_handle, "action"));
        if (set->attached()) {
            return error(XR_ERROR_ACTIONSETS_ALREADY_ATTACHED, "action set \"{}\" is attached to a session; create its actions before",
                         set->name);
        }
        const std::string name = bounded_text(info->actionName), localized = bounded_text(info->localizedActionName);
        ENTOPTIC_XR_TRY(check_names(name, localized));
        ENTOPTIC_XR_TRY(check_action_type(info->actionType));
        std::vector<UserPath> users;
        ENTOPTIC_XR_TRY(read_subaction_paths(set->instance(), *info, users));
        auto action = std::make_shared<Action>(set, *info, std::move(users));
        ENTOPTIC_XR_TRY(set->action_names().add(name, localized));
        set->add(action);
        return publish(action, handle_value(handle), action_handle);
    });
}

XrResult XRAPI_CALL destroy_action(XrAction handle) {
    return call("xrDestroyAction", handle, [&] { return destroy<Action>(handle_value(handle)); });
}

XrResult XRAPI_CALL suggest_interaction_profile_bindings(XrInstance handle, const XrInteractionProfileSuggestedBinding* info) {
    return call("xrSuggestInteractionProfileBindings", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_INTERACTION_PROFILE_SUGGESTED_BINDING, "suggestedBindings"));
        if (info->countSuggestedBindings == 0) return invalid("countSuggestedBindings is 0");
        ENTOPTIC_XR_TRY(require_pointer(info->suggestedBindings, "suggestedBindings->suggestedBindings"));
        const Profile* profile = nullptr;
        ENTOPTIC_XR_TRY(find_interaction_profile(*instance, info->interactionProfile, profile));
        ProfileSuggestions suggestions;
        for (std::uint32_t i = 0; i < info->countSuggestedBindings; ++i) {
            SuggestedBinding binding;
            ENTOPTIC_XR_TRY(read_binding(*instance, *profile, info->suggestedBindings[i], binding));
            suggestions.bindings.push_back(std::move(binding));
        }
        ENTOPTIC_XR_TRY(read_modifications(*instance, *profile, info->next, suggestions.dpads));
        instance->suggestions().set(std::string(profile->path), std::move(suggestions));
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL attach_session_action_sets(XrSession handle, const XrSessionActionSetsAttachInfo* info) {
    return call("xrAttachSessionActionSets", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_SESSION_ACTION_SETS_ATTACH_INFO, "attachInfo"));
        if (info->countActionSets == 0) return invalid("countActionSets is 0");
        ENTOPTIC_XR_TRY(require_pointer(info->actionSets, "attachInfo->actionSets"));
        std::vector<std::shared_ptr<ActionSet>> sets;
        for (std::uint32_t i = 0; i < info->countActionSets; ++i) {
            std::shared_ptr<ActionSet> set;
            ENTOPTIC_XR_TRY(find(info->actionSets[i], set));
            if (&set->instance() != &session->instance()) return invalid("action set \"{}\" belongs to another instance", set->name);
            if (std::find(sets.begin(), sets.end(), set) == sets.end()) sets.push_back(std::move(set));
        }
        return session->input().attach(sets);
    });
}

XrResult XRAPI_CALL get_current_interaction_profile(XrSession handle, XrPath top_level, XrInteractionProfileState* state) {
    return call("xrGetCurrentInteractionProfile", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(state, XR_TYPE_INTERACTION_PROFILE_STATE, "interactionProfile"));
        if (!session->input().attached()) return error(XR_ERROR_ACTIONSET_NOT_ATTACHED, "call xrAttachSessionActionSets first");
        UserPath user{};
        ENTOPTIC_XR_TRY(to_user_path(session->instance(), top_level, user));
        const Profile* profile = session->input().current_profile(user);
        state->interactionProfile = profile ? session->instance().paths().known(profile->path) : XR_NULL_PATH;
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL get_action_state_boolean(XrSession handle, const XrActionStateGetInfo* info, XrActionStateBoolean* state) {
    return call("xrGetActionStateBoolean", handle, [&]() -> Outcome {
        ActionState found;
        ENTOPTIC_XR_TRY(get_state(handle, info, state, XR_TYPE_ACTION_STATE_BOOLEAN, XR_ACTION_TYPE_BOOLEAN_INPUT, found));
        state->currentState = found.x > 0.5f;
        write_change(found, state);
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL get_action_state_float(XrSession handle, const XrActionStateGetInfo* info, XrActionStateFloat* state) {
    return call("xrGetActionStateFloat", handle, [&]() -> Outcome {
        ActionState found;
        ENTOPTIC_XR_TRY(get_state(handle, info, state, XR_TYPE_ACTION_STATE_FLOAT, XR_ACTION_TYPE_FLOAT_INPUT, found));
        state->currentState = found.x;
        write_change(found, state);
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL get_action_state_vector2f(XrSession handle, const XrActionStateGetInfo* info, XrActionStateVector2f* state) {
    return call("xrGetActionStateVector2f", handle, [&]() -> Outcome {
        ActionState found;
        ENTOPTIC_XR_TRY(get_state(handle, info, state, XR_TYPE_ACTION_STATE_VECTOR2F, XR_ACTION_TYPE_VECTOR2F_INPUT, found));
        state->currentState = {found.x, found.y};
        write_change(found, state);
        return XR_SUCCESS;
    });
}

XrResult XRAPI_CALL get_action_state_pose(XrSession handle, const XrActionStateGetInfo* info, XrActionStatePose* state) {
    return call("xrGetActionStatePose", handle, [&]() -> Outcome {
        ActionState found;
        return get_state(handle, info, state, XR_TYPE_ACTION_STATE_POSE, XR_ACTION_TYPE_POSE_INPUT, found);
    });
}

XrResult XRAPI_CALL sync_actions(XrSession handle, const XrActionsSyncInfo* info) {
    return call("xrSyncActions", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_ACTIONS_SYNC_INFO, "syncInfo"));
        std::vector<ActiveSet> active;
        ENTOPTIC_XR_TRY(read_active_sets(session->instance(), *info, active));
        bool profile_changed = false;
        const Outcome outcome = session->input().sync(active, session->host().clock().now(), session->focused(), profile_changed);
        if (profile_changed) {
            const XrEventDataInteractionProfileChanged event{XR_TYPE_EVENT_DATA_INTERACTION_PROFILE_CHANGED, nullptr, handle};
            session->instance().events().push(handle, event);
        }
        return outcome;
    });
}

XrResult XRAPI_CALL enumerate_bound_sources_for_action(XrSession handle, const XrBoundSourcesForActionEnumerateInfo* info,
                                                       uint32_t capacity, uint32_t* count, XrPath* sources) {
    return call("xrEnumerateBoundSourcesForAction", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        std::shared_ptr<Action> action;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_BOUND_SOURCES_FOR_ACTION_ENUMERATE_INFO, "enumerateInfo"));
        ENTOPTIC_XR_TRY(find(info->action, action));
        ENTOPTIC_XR_TRY(session->input().check_attached(*action));
        std::vector<XrPath> paths;
        for (const std::string& source : session->input().bound_sources(*action))
            paths.push_back(session->instance().paths().known(source));
        return two_call_values(capacity, count, sources, paths);
    });
}

XrResult XRAPI_CALL get_input_source_localized_name(XrSession handle, const XrInputSourceLocalizedNameGetInfo* info, uint32_t capacity,
                                                    uint32_t* count, char* buffer) {
    return call("xrGetInputSourceLocalizedName", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_INPUT_SOURCE_LOCALIZED_NAME_GET_INFO, "getInfo"));
        constexpr XrInputSourceLocalizedNameFlags known = XR_INPUT_SOURCE_LOCALIZED_NAME_USER_PATH_BIT |
                                                          XR_INPUT_SOURCE_LOCALIZED_NAME_INTERACTION_PROFILE_BIT |
                                                          XR_INPUT_SOURCE_LOCALIZED_NAME_COMPONENT_BIT;
        if (info->whichComponents == 0 || (info->whichComponents & ~known) != 0)
            return invalid("whichComponents is {:#x}", info->whichComponents);
        std::string text;
        ENTOPTIC_XR_TRY(session->instance().paths().to_string(info->sourcePath, text));
        if (!session->input().attached()) return error(XR_ERROR_ACTIONSET_NOT_ATTACHED, "call xrAttachSessionActionSets first");
        const auto split = split_binding_path(text);
        if (!split) return error(XR_ERROR_PATH_UNSUPPORTED, "{} is not an input source", text);
        return two_call_string(capacity, count, buffer,
                               source_name(session->input().current_profile(split->user), *split, info->whichComponents));
    });
}

XrResult XRAPI_CALL apply_haptic_feedback(XrSession handle, const XrHapticActionInfo* info, const XrHapticBaseHeader* feedback) {
    return call("xrApplyHapticFeedback", handle, [&]() -> Outcome {
        ActionQuery query;
        ENTOPTIC_XR_TRY(read_haptic(handle, info, query));
        ENTOPTIC_XR_TRY(require(feedback, XR_TYPE_HAPTIC_VIBRATION, "hapticFeedback"));
        const auto& vibration = *reinterpret_cast<const XrHapticVibration*>(feedback);
        ENTOPTIC_XR_TRY(check_vibration(vibration));
        const DurationNs duration = vibration.duration == XR_MIN_HAPTIC_DURATION ? shortest_vibration : vibration.duration;
        return vibrate(query, duration, vibration.frequency, std::fmin(std::fmax(vibration.amplitude, 0.0f), 1.0f));
    });
}

XrResult XRAPI_CALL stop_haptic_feedback(XrSession handle, const XrHapticActionInfo* info) {
    return call("xrStopHapticFeedback", handle, [&]() -> Outcome {
        ActionQuery query;
        ENTOPTIC_XR_TRY(read_haptic(handle, info, query));
        return vibrate(query, 0, 0, 0);
    });
}

}  // namespace entoptic::runtime::api
