#include "app/system/checks.h"

#include "app/config.h"
#include "app/launch.h"
#include "app/system/active_runtime.h"
#include "drivers/display/edid.h"
#include "drivers/hid/hid_bus.h"
#include "drivers/vive_pro/vive_pro_connection.h"
#include "gpu/device.h"

#include <algorithm>
#include <dlfcn.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;
using State = Finding::State;

constexpr const char* rules_name = "60-entoptic.rules";

std::vector<fs::path> entries(const fs::path& folder) {
    std::error_code error;
    std::vector<fs::path> out;
    for (const auto& entry : fs::directory_iterator(folder, error)) out.push_back(entry.path());
    std::sort(out.begin(), out.end());
    return out;
}

std::string line_of(const fs::path& path) {
    std::ifstream in(path);
    std::string line;
    std::getline(in, line);
    return line;
}

bool may_open(const MachinePlaces& places, const std::string& node) {
    return places.may_open ? places.may_open(node) : access(node.c_str(), R_OK | W_OK) == 0;
}

// The rules that came with this build: installed, or in the build tree.
std::string own_rules() {
    std::error_code error;
    const fs::path root = fs::read_symlink("/proc/self/exe", error).parent_path().parent_path();
    return (root / "lib/udev/rules.d" / rules_name).string();
}

std::string install_rules() {
    return fmt::format("sudo cp {} /etc/udev/rules.d/ && sudo udevadm control --reload && sudo udevadm trigger", own_rules());
}

}  // namespace

const char* name_of(State state) {
    switch (state) {
        case State::good:
            return "good";
        case State::note:
            return "note";
        default:
            return "problem";
    }
}

std::vector<Finding> check_vulkan() {
    const auto device = gpu::Device::create({});
    if (!device) return {{State::problem, "vulkan", device.error().message, "sudo apt-get install mesa-vulkan-drivers"}};
    std::vector<Finding> out;
    if ((*device)->is_software())
        out.push_back({State::note, "vulkan",
                       fmt::format("{} computes on the CPU: far below 90 frames a second at the panel's size.", (*device)->name()),
                       "Install the driver of your graphics card (AMD, Intel: mesa-vulkan-drivers; NVIDIA: nvidia-driver)"});
    else
        out.push_back({State::good, "vulkan", fmt::format("{} ({})", (*device)->name(), (*device)->driver()), ""});
    if (!(*device)->can_export_memory())
        out.push_back({State::problem, "vulkan",
                       "The driver cannot hand images to other devices (VK_KHR_external_memory_fd): no application can draw for it.",
                       "sudo apt-get install mesa-vulkan-drivers"});
    return out;
}

std::vector<Finding> check_openxr() {
    const auto manifest = find_manifest();
    if (!manifest) return {{State::problem, "runtime", manifest.error().message, "cmake --build --preset dev --target openxr_entoptic"}};
    std::vector<Finding> out;
    const RuntimeChoice ours = ActiveRuntime("", {}, *manifest).current(*manifest);
    std::error_code error;
    if (!fs::exists(ours.library, error))
        out.push_back({State::problem, "runtime", fmt::format("{} names {}, which is not there.", *manifest, ours.library),
                       "cmake --build --preset dev --target openxr_entoptic"});
    else
        out.push_back({State::good, "runtime", *manifest, ""});
    const RuntimeChoice active = ActiveRuntime::of_user().current(*manifest);
    if (active.ours)
        out.push_back({State::good, "active runtime", fmt::format("Entoptic, by {}", active.source), ""});
    else
        out.push_back({State::note, "active runtime",
                       active.file.empty()
                           ? "None: applications run on Entoptic under `entoptic run` only."
                           : fmt::format("{} ({}): applications run on Entoptic under `entoptic run` only.", active.library, active.source),
                       "entoptic runtime set"});
    if (void* loader = dlopen("libopenxr_loader.so.1", RTLD_LAZY | RTLD_LOCAL)) {
        dlclose(loader);
        out.push_back({State::good, "loader", "libopenxr_loader.so.1", ""});
    } else {
        out.push_back({State::note, "loader", "The system has no OpenXR loader; only applications that bring their own will run.",
                       "sudo apt-get install libopenxr-loader1"});
    }
    return out;
}

std::vector<Finding> check_configuration() {
    const auto config = load_config(std::nullopt);
    if (!config) return {{State::problem, "configuration", config.error().message, "entoptic config"}};
    return {{State::good, "configuration", config_file().empty() ? "defaults; there is no file" : config_file(), ""}};
}

std::vector<Finding> check_udev_rules(const MachinePlaces& places) {
    std::error_code error;
    for (const std::string& folder : places.udev_rules)
        if (const fs::path file = fs::path(folder) / rules_name; fs::exists(file, error))
            return {{State::good, "permissions", file.string(), ""}};
    return {{State::note, "permissions", "Entoptic's udev rules are not installed: headsets and eye cameras may be closed to this user.",
             install_rules()}};
}

// Render nodes are the GPU; card nodes are what puts pictures on a headset's panel where no desktop leases it.
std::vector<Finding> check_graphics_nodes(const MachinePlaces& places) {
    std::vector<Finding> out;
    std::string usable;
    bool any = false;
    for (const fs::path& node : entries(fs::path(places.dev) / "dri")) {
        const std::string name = node.filename().string();
        const bool render = name.rfind("renderD", 0) == 0;
        if (!render && name.rfind("card", 0) != 0) continue;
        any = true;
        if (may_open(places, node.string()))
            usable += (usable.empty() ? "" : ", ") + node.string();
        else if (render)
            out.push_back({State::problem, "graphics",
                           fmt::format("{} may not be opened by this user: the GPU cannot be used.", node.string()),
                           "sudo usermod -aG render,video $USER, then log in again"});
        else
            out.push_back(
                {State::note, "graphics",
                 fmt::format("{} may not be opened by this user: a headset's panel there needs a desktop that leases it.", node.string()),
                 install_rules()});
    }
    if (!usable.empty()) out.push_back({State::good, "graphics", usable, ""});
    if (!any)
        out.push_back({State::note, "graphics", "There is no /dev/dri: no GPU, and no display that a headset's panel could be on.",
                       "Load the driver of your graphics card; in a container, pass /dev/dri through"});
    return out;
}

std::vector<Finding> check_headset(const MachinePlaces& places) {
    const auto found = drivers::vive_pro::find_headsets(drivers::system_hid_bus());
    std::vector<Finding> out;
    for (const auto& functions : found) {
        for (const auto* info : {&functions.imu, &functions.light, &functions.mainboard})
            if (!info->path.empty() && !may_open(places, info->path))
                out.push_back({State::problem, "headset",
                               fmt::format("{} ({:04x}:{:04x}) may not be opened by this user.", info->path, info->vendor, info->product),
                               install_rules()});
        if (functions.mainboard.path.empty())
            out.push_back({State::problem, "headset", "The tracking unit is there, the mainboard is not: no display.",
                           "Switch the link box off and on; check that its power supply is plugged in"});
        if (out.empty())
            out.push_back({State::good, "headset",
                           fmt::format("{} on {} and {}", functions.is_vive ? "Vive" : "Vive Pro or alike", functions.imu.path,
                                       functions.mainboard.path),
                           ""});
    }
    if (found.empty())
        out.push_back({State::note, "headset", "No Vive Pro on USB; the virtual headset needs none.",
                       "Plug in the link box and its power, and press its button"});
    for (Finding& finding : check_panel(places, !found.empty())) out.push_back(std::move(finding));
    return out;
}

std::vector<Finding> check_panel(const MachinePlaces& places, bool headset_is_there) {
    std::vector<Finding> out;
    for (const fs::path& connector : entries(fs::path(places.sysfs) / "class/drm")) {
        std::ifstream in(connector / "edid", std::ios::binary);
        const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
        if (bytes.empty()) continue;
        const auto edid = drivers::parse_edid(bytes);
        if (!edid) {
            out.push_back({State::note, "display", fmt::format("{}: {}", connector.filename().string(), edid.error().message),
                           "Plug the display's cable in again"});
        } else if (const char* headset = drivers::headset_of_edid(*edid)) {
            out.push_back({State::good, "display",
                           fmt::format("{} on {}, {}x{} at {:.2f} Hz", headset, connector.filename().string(), edid->preferred.width,
                                       edid->preferred.height, edid->preferred.refresh_hz()),
                           ""});
        }
    }
    const bool shown = std::any_of(out.begin(), out.end(), [](const Finding& f) { return f.state == State::good; });
    if (headset_is_there && !shown)
        out.push_back(
            {State::note, "display", "The headset's panel is on no connector; it appears some seconds after it was switched on.",
             "Start `entoptic run --hmd vive-pro`; if it stays away, check the DisplayPort cable and switch the link box off and on"});
    return out;
}

std::vector<Finding> check_eye_cameras(const MachinePlaces& places) {
    std::vector<Finding> out;
    for (const fs::path& node : entries(fs::path(places.sysfs) / "class/video4linux")) {
        const std::string name = line_of(node / "name"), device = (fs::path(places.dev) / node.filename()).string();
        if (name.rfind("Pupil Cam", 0) != 0 || line_of(node / "index") != "0") continue;  // index 1 carries metadata only
        if (!may_open(places, device))
            out.push_back({State::problem, "eye camera", fmt::format("{} ({}) may not be opened by this user.", device, name),
                           "sudo usermod -aG video $USER, then log in again"});
        else
            out.push_back({State::good, "eye camera", fmt::format("{} on {}", name, device), ""});
    }
    if (out.empty())
        out.push_back(
            {State::note, "eye camera", "No Pupil Labs camera is plugged in; gaze and pupil come from models or the virtual tracker.", ""});
    return out;
}

std::vector<Finding> check_machine(const MachinePlaces& places) {
    std::vector<Finding> all;
    for (auto& part : {check_vulkan(), check_openxr(), check_configuration(), check_udev_rules(places), check_graphics_nodes(places),
                       check_headset(places), check_eye_cameras(places)})
        all.insert(all.end(), part.begin(), part.end());
    return all;
}

}  // namespace entoptic::app
