// `entoptic status`: what runs, and what this machine computes on.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/live_settings.h"
#include "app/status_file.h"
#include "drivers/pupil_labs/pupil_labs_device.h"
#include "gpu/device.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>

namespace entoptic::app {
namespace {

Json device_json() {
    const auto device = gpu::Device::create({});
    if (!device) return {{"present", false}, {"why", device.error().message}};
    const gpu::Device& d = **device;
    return {{"present", true},
            {"name", d.name()},
            {"driver", d.driver()},
            {"software", d.is_software()},
            {"exports_memory", d.can_export_memory()}};
}

Json eye_cameras_json() {
    const auto found = drivers::find_eye_cameras(drivers::linux_video_system());
    if (found.empty()) return {{"present", false}, {"why", drivers::no_eye_cameras()}};
    Json cameras = Json::array();
    for (const auto& [node, eye] : found)
        cameras.push_back({{"eye", eye == 0 ? "left" : "right"}, {"name", node.name}, {"path", node.path}, {"bus", node.bus}});
    return {{"present", true}, {"cameras", cameras}};
}

Json status_json() {
    Json runtimes = Json::array();
    for (const RunningRuntime& runtime : running_runtimes()) {
        Json one = {{"pid", runtime.pid}};
        one.update(runtime.status);
        runtimes.push_back(one);
    }
    return {{"version", ENTOPTIC_VERSION},
            {"service", {{"running", false}, {"why", "this version has none: the runtime works inside the application"}}},
            {"device", device_json()},
            {"eye_cameras", eye_cameras_json()},
            {"runtimes", runtimes}};
}

std::string text_of(const Json& json, const char* key) {
    const auto found = json.find(key);
    if (found == json.end()) return "?";
    return found->is_string() ? found->get<std::string>() : found->dump();
}

void print_part(const Json& runtime, const char* name) {
    const auto found = runtime.find(name);
    if (found == runtime.end()) return;
    if (found->is_object() && found->contains("present")) {
        fmt::print("  {:<12} {}, {}\n", name, found->value("present", false) ? "present" : "absent", text_of(*found, "why"));
    } else if (found->is_object()) {
        std::string parts;
        for (const auto& [key, value] : found->items())
            parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", key, value.is_string() ? value.get<std::string>() : value.dump());
        fmt::print("  {:<12} {}\n", name, parts);
    } else {
        fmt::print("  {:<12} {}\n", name, text_of(runtime, name));
    }
}

void print_runtime(const Json& runtime) {
    fmt::print("Runtime {} in process {}\n", text_of(runtime, "version"), text_of(runtime, "pid"));
    for (const char* name : {"application", "device", "headset", "eye_tracker", "cameras", "clock", "frames", "photometry"})
        print_part(runtime, name);
    for (const Json& effect : runtime.value("effects", Json::array()))
        fmt::print("  {:<12} {} {}: {}\n", text_of(effect, "slot"), text_of(effect, "model"), effect.value("on", false) ? "on" : "off",
                   text_of(effect, "why"));
    if (const auto adjusted = answer_of(runtime); adjusted && !text_of(adjusted->choice).empty())
        fmt::print("  {:<12} {}\n", "set", text_of(adjusted->choice));
    for (const Json& error : runtime.value("errors", Json::array()))
        fmt::print("  problem      {}\n", error.is_string() ? error.get<std::string>() : error.dump());
}

void print_status(const Json& status) {
    fmt::print("Entoptic {}\n", ENTOPTIC_VERSION);
    fmt::print("Service: not running; {}.\n", text_of(status["service"], "why"));
    const Json& device = status["device"];
    if (device["present"].get<bool>())
        fmt::print("Device: {} ({})\n", text_of(device, "name"), text_of(device, "driver"));
    else
        fmt::print("Device: none. {}\n", text_of(device, "why"));
    const Json& eyes = status["eye_cameras"];
    if (!eyes["present"].get<bool>()) fmt::print("Eye cameras: none. {}\n", text_of(eyes, "why"));
    for (const Json& camera : eyes.value("cameras", Json::array()))
        fmt::print("Eye camera: {} eye, {} ({})\n", text_of(camera, "eye"), text_of(camera, "name"), text_of(camera, "path"));
    if (status["runtimes"].empty()) fmt::print("No runtime is running. Start one with: entoptic run -- hello_xr -g Vulkan\n");
    for (const Json& runtime : status["runtimes"]) print_runtime(runtime);
}

}  // namespace

void add_status(CLI::App& app, Action& action) {
    auto json = std::make_shared<bool>(false);
    CLI::App* command = app.add_subcommand("status", "Show what is running, and what is missing");
    command->add_flag("--json", *json, "One JSON document on standard output");
    command->callback([json, &action] {
        action = [json]() -> Result<int> {
            const Json status = status_json();
            if (*json)
                print_json(status);
            else
                print_status(status);
            return 0;
        };
    });
}

}  // namespace entoptic::app
