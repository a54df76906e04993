#include "runtime/objects/handle_table.h"

#include <algorithm>
#include <mutex>

namespace entoptic::runtime {

namespace {

constexpr std::uint32_t generation_mask = 0xffffff;

std::uint64_t compose(std::uint32_t slot, ObjectType type, std::uint32_t generation) {
    return std::uint64_t(slot) | std::uint64_t(type) << 32 | std::uint64_t(generation) << 40;
}
std::uint32_t slot_index(std::uint64_t handle) { return static_cast<std::uint32_t>(handle); }
ObjectType tag(std::uint64_t handle) { return static_cast<ObjectType>(handle >> 32 & 0xff); }
std::uint32_t generation_of(std::uint64_t handle) { return static_cast<std::uint32_t>(handle >> 40) & generation_mask; }

}  // namespace

const char* object_type_name(ObjectType type) {
    switch (type) {
        case ObjectType::instance:
            return "XrInstance";
        case ObjectType::session:
            return "XrSession";
        case ObjectType::space:
            return "XrSpace";
        case ObjectType::action_set:
            return "XrActionSet";
        case ObjectType::action:
            return "XrAction";
        case ObjectType::swapchain:
            return "XrSwapchain";
        case ObjectType::messenger:
            return "XrDebugUtilsMessengerEXT";
        case ObjectType::none:
            break;
    }
    return "handle";
}

HandleTable& HandleTable::global() {
    static HandleTable* table = new HandleTable;  // never destroyed: an application may call from a static destructor
    return *table;
}

const HandleTable::Slot* HandleTable::slot_of(std::uint64_t handle) const {
    const std::uint32_t index = slot_index(handle);
    if (handle == 0 || index >= slots_.size()) return nullptr;
    const Slot& slot = slots_[index];
    const bool matches = slot.object && slot.generation == generation_of(handle) && slot.object->type() == tag(handle);
    return matches ? &slot : nullptr;
}

std::uint64_t HandleTable::insert(std::shared_ptr<Object> object, std::uint64_t parent) {
    std::unique_lock lock(mutex_);
    if (parent != 0 && !slot_of(parent)) return 0;
    std::uint32_t index = 0;
    if (free_.empty()) {
        index = static_cast<std::uint32_t>(slots_.size());
        slots_.emplace_back();
        free_.reserve(slots_.size());  // so that remove() never allocates
    } else {
        index = free_.back();
        free_.pop_back();
    }
    Slot& slot = slots_[index];
    slot.generation = (slot.generation + 1) & generation_mask;
    if (slot.generation == 0) slot.generation = 1;
    const std::uint64_t handle = compose(index, object->type(), slot.generation);
    object->handle_ = handle;
    slot.object = std::move(object);
    slot.parent = parent;
    if (parent != 0) slots_[slot_index(parent)].children.push_back(handle);
    return handle;
}

std::shared_ptr<Object> HandleTable::find(std::uint64_t handle, ObjectType type) const {
    std::shared_lock lock(mutex_);
    const Slot* slot = slot_of(handle);
    return slot && slot->object->type() == type ? slot->object : nullptr;
}

std::shared_ptr<Object> HandleTable::find(std::uint64_t handle) const {
    std::shared_lock lock(mutex_);
    const Slot* slot = slot_of(handle);
    return slot ? slot->object : nullptr;
}

void HandleTable::detach(std::uint64_t handle, std::vector<std::shared_ptr<Object>>& removed) {
    Slot& slot = slots_[slot_index(handle)];
    const std::vector<std::uint64_t> children = std::move(slot.children);
    slot.children.clear();
    for (auto child = children.rbegin(); child != children.rend(); ++child) detach(*child, removed);
    removed.push_back(std::move(slot.object));
    slot.object.reset();
    free_.push_back(slot_index(handle));
}

bool HandleTable::remove(std::uint64_t handle, ObjectType type) {
    std::vector<std::shared_ptr<Object>> removed;
    {
        std::unique_lock lock(mutex_);
        const Slot* slot = slot_of(handle);
        if (!slot || slot->object->type() != type) return false;
        if (slot->parent != 0) std::erase(slots_[slot_index(slot->parent)].children, handle);
        detach(handle, removed);
    }
    for (const auto& object : removed) object->retire();
    return true;
}

std::size_t HandleTable::size() const {
    std::shared_lock lock(mutex_);
    return slots_.size() - free_.size();
}

}  // namespace entoptic::runtime
