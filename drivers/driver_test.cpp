// labels: unit
#include "drivers/driver.h"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace entoptic::drivers {
namespace {

TEST(Drivers, TheTableHasEveryDeviceOnce) {
    std::set<std::string> names;
    for (const Driver* driver : driver_table()) {
        ASSERT_NE(driver, nullptr);
        EXPECT_TRUE(names.insert(driver->name).second) << driver->name;
        EXPECT_NE(std::string(driver->description), "");
    }
    EXPECT_TRUE(names.count("virtual"));
}

TEST(Drivers, OpensTheVirtualHeadsetByName) {
    const auto headset = open_headset({});
    ASSERT_TRUE(headset) << headset.error().message;
    EXPECT_NE(headset->head, nullptr);
    ASSERT_NE(headset->eye_tracker, nullptr);
    EXPECT_TRUE(headset->eye_tracker->present());
    EXPECT_NE(headset->controllers[0], nullptr);
    EXPECT_NE(headset->controllers[1], nullptr);
    EXPECT_EQ(headset->display.panel_width, 1440);
    EXPECT_EQ(headset->display.panel_height, 1600);
}

TEST(Drivers, AutoFindsSomething) {
    DriverOptions options;
    options.name = "auto";
    EXPECT_TRUE(open_headset(options));
}

TEST(Drivers, AnUnknownNameSaysWhatThereIs) {
    DriverOptions options;
    options.name = "rift";
    const auto headset = open_headset(options);
    ASSERT_FALSE(headset);
    EXPECT_EQ(headset.error().kind, ErrorKind::usage);
    EXPECT_NE(headset.error().message.find("virtual"), std::string::npos) << headset.error().message;
}

TEST(Drivers, WrongOptionsAreUsageErrors) {
    for (const auto& change : std::vector<void (*)(DriverOptions&)>{
             [](DriverOptions& o) { o.panel_width = 0; }, [](DriverOptions& o) { o.panel_height = 100'000; },
             [](DriverOptions& o) { o.ipd_mm = 6.3; }, [](DriverOptions& o) { o.ipd_mm = std::nan(""); },
             [](DriverOptions& o) { o.script = "/nowhere/script.toml"; }, [](DriverOptions& o) { o.script = ""; },
             [](DriverOptions& o) { o.script = "/tmp"; }}) {
        DriverOptions options;
        change(options);
        const auto headset = open_headset(options);
        ASSERT_FALSE(headset);
        EXPECT_EQ(headset.error().kind, ErrorKind::usage) << headset.error().message;
    }
}

}  // namespace
}  // namespace entoptic::drivers
