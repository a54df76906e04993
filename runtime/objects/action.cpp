#include "runtime/objects/action.h"

#include "runtime/objects/instance.h"

namespace entoptic::runtime {

void ActionSet::retire() { instance_->action_set_names().remove(name, localized); }

void ActionSet::add(std::shared_ptr<Action> action) {
    std::lock_guard lock(mutex_);
    std::erase_if(actions_, [](const std::weak_ptr<Action>& known) { return known.expired(); });
    actions_.push_back(std::move(action));
}

std::vector<std::shared_ptr<Action>> ActionSet::actions() const {
    std::lock_guard lock(mutex_);
    std::vector<std::shared_ptr<Action>> living;
    for (const auto& known : actions_) {
        if (auto action = known.lock()) living.push_back(std::move(action));
    }
    return living;
}

Action::Action(std::shared_ptr<ActionSet> owner, const XrActionCreateInfo& info, std::vector<UserPath> paths)
    : Object(ObjectType::action),
      set(std::move(owner)),
      name(info.actionName),
      localized(info.localizedActionName),
      type(info.actionType),
      subaction_paths(std::move(paths)) {}

ComponentKind kind_of(XrActionType type) {
    switch (type) {
        case XR_ACTION_TYPE_BOOLEAN_INPUT:
            return ComponentKind::boolean;
        case XR_ACTION_TYPE_FLOAT_INPUT:
            return ComponentKind::scalar;
        case XR_ACTION_TYPE_VECTOR2F_INPUT:
            return ComponentKind::vector2;
        case XR_ACTION_TYPE_POSE_INPUT:
            return ComponentKind::pose;
        default:
            return ComponentKind::haptic;
    }
}

}  // namespace entoptic::runtime
