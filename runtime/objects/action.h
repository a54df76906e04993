// XrActionSet and XrAction: what the application declared. Immutable after creation; states live in the session (ActionInput).
#pragma once

#include "runtime/objects/handle_table.h"
#include "runtime/objects/interaction_profiles.h"
#include "runtime/objects/name_registry.h"
#include "runtime/openxr.h"

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace entoptic::runtime {

class Action;

class ActionSet final : public Object {
public:
    ActionSet(std::shared_ptr<Instance> instance, std::string set_name, std::string set_localized, std::uint32_t set_priority)
        : Object(ObjectType::action_set),
          name(std::move(set_name)),
          localized(std::move(set_localized)),
          priority(set_priority),
          instance_(std::move(instance)) {}
    Instance& instance() override { return *instance_; }
    void retire() override;

    NameRegistry& action_names() { return action_names_; }
    // Living actions of the set. One that was destroyed after it was attached lives on in the session.
    void add(std::shared_ptr<Action> action);
    std::vector<std::shared_ptr<Action>> actions() const;

    void mark_attached() { attached_ = true; }
    bool attached() const { return attached_; }

    const std::string name, localized;
    const std::uint32_t priority;

private:
    std::shared_ptr<Instance> instance_;
    NameRegistry action_names_;
    mutable std::mutex mutex_;
    std::vector<std::weak_ptr<Action>> actions_;
    std::atomic<bool> attached_{false};
};

class Action final : public Object {
public:
    Action(std::shared_ptr<ActionSet> set, const XrActionCreateInfo& info, std::vector<UserPath> subaction_paths);
    Instance& instance() override { return set->instance(); }
    void retire() override { set->action_names().remove(name, localized); }
    bool declares(UserPath user) const { return std::find(subaction_paths.begin(), subaction_paths.end(), user) != subaction_paths.end(); }

    const std::shared_ptr<ActionSet> set;
    const std::string name, localized;
    const XrActionType type;
    const std::vector<UserPath> subaction_paths;
};

ComponentKind kind_of(XrActionType type);

}  // namespace entoptic::runtime
