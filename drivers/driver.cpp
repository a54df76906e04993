#include "drivers/driver.h"

#include <fmt/format.h>

namespace entoptic::drivers {

namespace {

// Those that offer what `offers` asks for.
template <class Offers> std::string driver_names(Offers offers) {
    std::string names;
    for (const Driver* driver : driver_table())
        if (offers(*driver)) names += fmt::format("{}{}", names.empty() ? "" : ", ", driver->name);
    return names;
}

bool is_headset(const Driver& driver) { return driver.open != nullptr; }
bool has_eyes(const Driver& driver) { return driver.open_eyes != nullptr; }

Result<Headset> probe(const DriverOptions& options) {
    std::string reasons;
    for (const Driver* driver : driver_table()) {
        if (!is_headset(*driver)) continue;
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
        if (is_headset(*driver) && options.name == driver->name) return driver->open(options);
    }
    return usage_error(fmt::format("There is no headset driver '{}'; there are: {}, auto.", options.name, driver_names(is_headset)));
}

Result<std::shared_ptr<EyeSource>> open_eye_tracker(const std::string& name, Clock& clock) {
    std::string reasons;
    for (const Driver* driver : driver_table()) {
        if (!has_eyes(*driver) || (name != "auto" && name != driver->name)) continue;
        auto eyes = driver->open_eyes(clock);
        if (eyes || name != "auto" || eyes.error().kind != ErrorKind::missing) return eyes;
        reasons += fmt::format(" {}: {}", driver->name, eyes.error().message);
    }
    if (name == "auto") return missing("No eye tracker was found." + reasons);
    return usage_error(fmt::format("There is no eye tracker '{}'; there are: {}, auto.", name, driver_names(has_eyes)));
}

}  // namespace entoptic::drivers
