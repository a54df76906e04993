#include "drivers/driver.h"

#include <fmt/format.h>

namespace entoptic::drivers {

namespace {

std::string driver_names() {
    std::string names;
    for (const Driver* driver : driver_table()) names += fmt::format("{}{}", names.empty() ? "" : ", ", driver->name);
    return names;
}

Result<Headset> probe(const DriverOptions& options) {
    std::string reasons;
    for (const Driver* driver : driver_table()) {
        auto headset = driver->open(options);
        if (headset || headset.error().kind != ErrorKind::missing) return headset;
        reasons += fmt::format(" {}: {}", driver->name, headset.error().message);
    }
    return missing("No headset was found." + reasons);
}

}  // namespace

Result<Headset> open_headset(const DriverOptions& options) {
    if (options.name == "auto") return probe(options);
    for (const Driver* driver : driver_table()) {
        if (options.name == driver->name) return driver->open(options);
    }
    return usage_error(fmt::format("There is no headset driver '{}'; there are: {}, auto.", options.name, driver_names()));
}

}  // namespace entoptic::drivers
