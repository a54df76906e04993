// labels: unit
#include "runtime/objects/handle_table.h"

#include <gtest/gtest.h>
#include <thread>
#include <vector>

namespace entoptic::runtime {
namespace {

class Thing final : public Object {
public:
    Thing(ObjectType type, std::vector<int>* order, int id) : Object(type), order_(order), id_(id) {}
    Instance& instance() override { std::abort(); }
    void retire() override {
        if (order_) order_->push_back(id_);
    }

private:
    std::vector<int>* order_;
    int id_;
};

std::shared_ptr<Thing> thing(ObjectType type, std::vector<int>* order = nullptr, int id = 0) {
    return std::make_shared<Thing>(type, order, id);
}

TEST(HandleTable, FindsByHandleAndType) {
    HandleTable table;
    const auto object = thing(ObjectType::session);
    const std::uint64_t handle = table.insert(object, 0);
    EXPECT_NE(handle, 0u);
    EXPECT_EQ(object->handle(), handle);
    EXPECT_EQ(table.find(handle, ObjectType::session), object);
    EXPECT_EQ(table.find(handle, ObjectType::space), nullptr);
    EXPECT_EQ(table.find(0, ObjectType::session), nullptr);
    EXPECT_EQ(table.find(0x1234, ObjectType::session), nullptr);
    EXPECT_EQ(table.find(~std::uint64_t(0), ObjectType::session), nullptr);
}

TEST(HandleTable, DestroyedHandleStaysInvalidWhenItsSlotIsUsedAgain) {
    HandleTable table;
    const std::uint64_t old = table.insert(thing(ObjectType::space), 0);
    EXPECT_TRUE(table.remove(old, ObjectType::space));
    EXPECT_FALSE(table.remove(old, ObjectType::space));
    const std::uint64_t fresh = table.insert(thing(ObjectType::space), 0);
    EXPECT_NE(old, fresh);
    EXPECT_EQ(table.find(old), nullptr);
    EXPECT_NE(table.find(fresh), nullptr);
}

TEST(HandleTable, ChildrenGoFirst) {
    HandleTable table;
    std::vector<int> order;
    const std::uint64_t parent = table.insert(thing(ObjectType::instance, &order, 1), 0);
    const std::uint64_t child = table.insert(thing(ObjectType::session, &order, 2), parent);
    const std::uint64_t grandchild = table.insert(thing(ObjectType::space, &order, 3), child);
    EXPECT_TRUE(table.remove(parent, ObjectType::instance));
    EXPECT_EQ(order, (std::vector<int>{3, 2, 1}));
    EXPECT_EQ(table.find(grandchild), nullptr);
    EXPECT_EQ(table.size(), 0u);
    EXPECT_EQ(table.insert(thing(ObjectType::space), child), 0u) << "the parent is gone";
}

TEST(HandleTable, ManyThreads) {
    HandleTable table;
    const std::uint64_t parent = table.insert(thing(ObjectType::instance), 0);
    std::vector<std::thread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&] {
            for (int i = 0; i < 500; ++i) {
                const std::uint64_t handle = table.insert(thing(ObjectType::space), parent);
                EXPECT_NE(table.find(handle, ObjectType::space), nullptr);
                EXPECT_TRUE(table.remove(handle, ObjectType::space));
                EXPECT_EQ(table.find(handle), nullptr);
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(table.size(), 1u);
}

}  // namespace
}  // namespace entoptic::runtime
