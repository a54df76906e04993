// All handles the runtime has given out. A handle is a number that is looked up, never a pointer that is followed:
// bits 0-31 slot, 32-39 type, 40-63 generation. Thread-safe; no lock is held when an object's own code runs.
#pragma once

#include <openxr/openxr.h>

#include <cstdint>
#include <memory>
#include <shared_mutex>
#include <type_traits>
#include <vector>

namespace entoptic::runtime {

class Instance;

enum class ObjectType : std::uint8_t { none, instance, session, space, action_set, action, swapchain, messenger };

const char* object_type_name(ObjectType type);

// Anything with a handle. Destroying the handle calls retire() once, children first; threads still inside a call keep the object alive.
class Object {
public:
    explicit Object(ObjectType type) : type_(type) {}
    virtual ~Object() = default;
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;

    ObjectType type() const { return type_; }
    std::uint64_t handle() const { return handle_; }
    // The instance it belongs to, for messages. An instance returns itself.
    virtual Instance& instance() = 0;
    // The handle is gone: give back what the application or the compositor must not find in use any more.
    virtual void retire() {}

private:
    friend class HandleTable;
    const ObjectType type_;
    std::uint64_t handle_ = 0;
};

class HandleTable {
public:
    // The process's table.
    static HandleTable& global();

    // Gives the object a handle below `parent` (0: none). Returns 0 when the parent has been destroyed meanwhile.
    std::uint64_t insert(std::shared_ptr<Object> object, std::uint64_t parent);
    // Null when the handle is not one of this type, or was destroyed.
    std::shared_ptr<Object> find(std::uint64_t handle, ObjectType type) const;
    // Any type.
    std::shared_ptr<Object> find(std::uint64_t handle) const;
    // Destroys the handle and everything below it, children first. False when it is not valid.
    bool remove(std::uint64_t handle, ObjectType type);
    // Valid handles of any type.
    std::size_t size() const;

private:
    struct Slot {
        std::uint32_t generation = 0;
        std::shared_ptr<Object> object;
        std::uint64_t parent = 0;
        std::vector<std::uint64_t> children;
    };
    const Slot* slot_of(std::uint64_t handle) const;
    void detach(std::uint64_t handle, std::vector<std::shared_ptr<Object>>& removed);

    mutable std::shared_mutex mutex_;
    std::vector<Slot> slots_;
    std::vector<std::uint32_t> free_;
};

template <class Handle> std::uint64_t handle_value(Handle handle) {
    if constexpr (std::is_pointer_v<Handle>)
        return static_cast<std::uint64_t>(reinterpret_cast<std::uintptr_t>(handle));
    else
        return static_cast<std::uint64_t>(handle);
}
template <class Handle> Handle to_handle(std::uint64_t value) {
    if constexpr (std::is_pointer_v<Handle>)
        return reinterpret_cast<Handle>(static_cast<std::uintptr_t>(value));
    else
        return static_cast<Handle>(value);
}

}  // namespace entoptic::runtime
