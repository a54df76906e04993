// What `entoptic doctor` looks at: each check says what it found and, where something is wrong, the command that mends it.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace entoptic::app {

struct Finding {
    enum class State { good, note, problem } state = State::good;  // note: works, or is not needed; problem: something does not work
    std::string check;                                             // "vulkan", "headset", ...
    std::string what;                                              // what was found
    std::string mend;                                              // a command, or what to do; empty when there is nothing
};

// Where things are; tests give their own.
struct MachinePlaces {
    std::string sysfs = "/sys", dev = "/dev";
    std::vector<std::string> udev_rules{"/etc/udev/rules.d", "/run/udev/rules.d", "/usr/local/lib/udev/rules.d", "/usr/lib/udev/rules.d",
                                        "/lib/udev/rules.d"};
    std::function<bool(const std::string&)> may_open;  // whether this user may read and write that node; empty: the kernel is asked
};

std::vector<Finding> check_vulkan();
std::vector<Finding> check_openxr();  // manifest, library, loader, active runtime
std::vector<Finding> check_configuration();
std::vector<Finding> check_udev_rules(const MachinePlaces& places);
std::vector<Finding> check_graphics_nodes(const MachinePlaces& places);  // rights on /dev/dri/*
std::vector<Finding> check_headset(const MachinePlaces& places);         // USB functions, permissions, panel
std::vector<Finding> check_eye_cameras(const MachinePlaces& places);
// The panel of a headset among the connected displays: /sys/class/drm/*/edid.
std::vector<Finding> check_panel(const MachinePlaces& places, bool headset_is_there);

std::vector<Finding> check_machine(const MachinePlaces& places = {});

const char* name_of(Finding::State state);  // "good", "note", "problem"

}  // namespace entoptic::app
