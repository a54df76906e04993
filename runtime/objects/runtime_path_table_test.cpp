// labels: unit
#include "runtime/objects/path_table.h"

#include "runtime/objects/event_queue.h"
#include "runtime/objects/interaction_profiles.h"
#include "runtime/objects/name_registry.h"

#include <gtest/gtest.h>
#include <limits>

namespace entoptic::runtime {
namespace {

TEST(Paths, FormatIsTheSpecifications) {
    for (const char* good : {"/a", "/user/hand/left", "/a.b/c-d/e_f/0", "/.a", "/a..", "/...a"}) EXPECT_TRUE(valid_path(good)) << good;
    for (const char* bad :
         {"", "/", "//", "/a/", "/a//a", "\\a", "/ ", "/wha?", "/aaA", "foo", "oof/", "/../foo", "/.", "/../..", "/a/.."}) {
        EXPECT_FALSE(valid_path(bad)) << bad;
    }
    EXPECT_TRUE(valid_path("/" + std::string(XR_MAX_PATH_LENGTH - 2, 'a')));
    EXPECT_FALSE(valid_path("/" + std::string(XR_MAX_PATH_LENGTH - 1, 'a')));
}

TEST(Paths, SameTextSameNumber) {
    PathTable table;
    XrPath a = 0, b = 0;
    EXPECT_EQ(table.from_string("/user/head", a).code(), XR_SUCCESS);
    EXPECT_EQ(table.from_string("/user/head", b).code(), XR_SUCCESS);
    EXPECT_EQ(a, b);
    std::string text;
    EXPECT_EQ(table.to_string(a, text).code(), XR_SUCCESS);
    EXPECT_EQ(text, "/user/head");
    EXPECT_EQ(table.to_string(XR_NULL_PATH, text).code(), XR_ERROR_PATH_INVALID);
    EXPECT_EQ(table.to_string(a + 1, text).code(), XR_ERROR_PATH_INVALID);
}

TEST(Names, CheckedAndUnique) {
    EXPECT_EQ(check_names("", "x").code(), XR_ERROR_NAME_INVALID);
    EXPECT_EQ(check_names("INVALID NAME", "x").code(), XR_ERROR_PATH_FORMAT_INVALID);
    EXPECT_EQ(check_names("ok", "").code(), XR_ERROR_LOCALIZED_NAME_INVALID);
    EXPECT_EQ(check_names("ok", "\xff\xfe").code(), XR_ERROR_LOCALIZED_NAME_INVALID);
    EXPECT_EQ(check_names("ok", "Größe 目").code(), XR_SUCCESS);
    NameRegistry names;
    EXPECT_EQ(names.add("a", "A").code(), XR_SUCCESS);
    EXPECT_EQ(names.add("a", "B").code(), XR_ERROR_NAME_DUPLICATED);
    EXPECT_EQ(names.add("b", "A").code(), XR_ERROR_LOCALIZED_NAME_DUPLICATED);
    names.remove("a", "A");
    EXPECT_EQ(names.add("b", "A").code(), XR_SUCCESS);
}

TEST(Events, OldestAreLostAndCounted) {
    EventQueue queue;
    for (std::uint32_t i = 0; i < EventQueue::capacity + 5; ++i) {
        queue.push(XR_NULL_HANDLE, XrEventDataEventsLost{XR_TYPE_EVENT_DATA_EVENTS_LOST, nullptr, 1000 + i});
    }
    XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER};
    const auto count = [&] { return reinterpret_cast<const XrEventDataEventsLost*>(&event)->lostEventCount; };
    ASSERT_EQ(queue.poll(event), XR_SUCCESS);
    EXPECT_EQ(count(), 5u);
    ASSERT_EQ(queue.poll(event), XR_SUCCESS);
    EXPECT_EQ(count(), 1005u) << "the oldest that is left";
    for (std::size_t i = 1; i < EventQueue::capacity; ++i) ASSERT_EQ(queue.poll(event), XR_SUCCESS);
    EXPECT_EQ(queue.poll(event), XR_EVENT_UNAVAILABLE);
}

// Of an application of version 1.0 without extensions.
constexpr Features plain = 0;

TEST(InteractionProfiles, LegalPathsOnly) {
    const Profile* touch = find_profile("/interaction_profiles/oculus/touch_controller");
    ASSERT_NE(touch, nullptr);
    EXPECT_NE(touch->find(UserPath::left_hand, "/input/x/click", ComponentKind::boolean, plain), nullptr);
    EXPECT_EQ(touch->find(UserPath::right_hand, "/input/x/click", ComponentKind::boolean, plain), nullptr);
    EXPECT_EQ(touch->find(UserPath::left_hand, "/input/nothing/click", ComponentKind::boolean, plain), nullptr);
    EXPECT_EQ(touch->find(UserPath::left_hand, "/input", ComponentKind::boolean, plain), nullptr);
    EXPECT_EQ(touch->find(UserPath::left_hand, "", ComponentKind::boolean, plain), nullptr);
    EXPECT_EQ(find_profile("/interaction_profiles/none"), nullptr);
}

TEST(InteractionProfiles, AnIdentifierAloneMeansTheComponentThatSuits) {
    const Profile* index = find_profile("/interaction_profiles/valve/index_controller");
    ASSERT_NE(index, nullptr);
    EXPECT_EQ(index->find(UserPath::left_hand, "/input/trigger", ComponentKind::boolean, plain)->path, "/input/trigger/click");
    EXPECT_EQ(index->find(UserPath::left_hand, "/input/trigger", ComponentKind::scalar, plain)->path, "/input/trigger/value");
    EXPECT_EQ(index->find(UserPath::left_hand, "/input/thumbstick", ComponentKind::vector2, plain)->path, "/input/thumbstick");
    EXPECT_EQ(index->find(UserPath::left_hand, "/input/thumbstick", ComponentKind::boolean, plain)->path, "/input/thumbstick/click");
    EXPECT_EQ(index->find(UserPath::left_hand, "/input/grip", ComponentKind::pose, plain)->path, "/input/grip/pose");
}

TEST(InteractionProfiles, NamesForPeople) {
    EXPECT_EQ(component_name("/input/trigger/value"), "Trigger");
    EXPECT_EQ(component_name("/input/volume_up/click"), "Volume Up");
    EXPECT_EQ(component_name("/input/gaze_ext/pose"), "Gaze");
    EXPECT_EQ(component_name("/input/thumbstick/x"), "Thumbstick X");
    EXPECT_EQ(identifier_of("/input/trigger/value"), "/input/trigger");
    EXPECT_EQ(identifier_of("/output/haptic"), "/output/haptic");
}

TEST(InteractionProfiles, NonsenseOfADeviceIsCleaned) {
    ControllerState state;
    state.trigger = std::numeric_limits<float>::quiet_NaN();
    state.thumbstick = {std::numeric_limits<float>::infinity(), -5};
    EXPECT_EQ(read_component(Source::trigger, state).x, 0);
    EXPECT_EQ(read_component(Source::thumbstick, state).x, 0);
    EXPECT_EQ(read_component(Source::thumbstick, state).y, -1);
}

}  // namespace
}  // namespace entoptic::runtime
