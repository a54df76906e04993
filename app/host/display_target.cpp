#include "app/host/display_target.h"

#include "compositor/targets/headless.h"
#include "compositor/targets/kms/panel.h"
#include "compositor/targets/window.h"
#include "drivers/display/edid.h"

#include <fmt/format.h>

namespace entoptic::app {
namespace {

// How long a headset takes from "display on" to a connector that shows it is not measured; seconds (facts/devices.md 1.3). choice:
constexpr DurationNs panel_patience = 5 * ns_per_s;

bool is_real(const Config& config) { return config.hmd.value == "vive-pro"; }

std::string headset_of(std::span<const std::uint8_t> bytes) {
    const auto edid = drivers::parse_edid(bytes);
    const char* headset = edid ? drivers::headset_of_edid(*edid) : nullptr;
    return headset ? headset : "";
}

Result<std::unique_ptr<compositor::DisplayTarget>> open_panel(gpu::Device& device, Clock& clock, const Config& config,
                                                              const DisplayIdentity& display) {
    compositor::kms::PanelOptions options;
    options.wish.width = eye_count * static_cast<std::uint32_t>(display.panel_width);
    options.wish.height = static_cast<std::uint32_t>(display.panel_height);
    options.wish.refresh_hz = static_cast<double>(display.refresh_numerator) / static_cast<double>(display.refresh_denominator);
    options.wish.headset_of_edid = headset_of;
    options.patience = is_real(config) ? panel_patience : 0;
    return compositor::kms::make_panel_target(device, clock, std::move(options));
}

Result<std::unique_ptr<compositor::DisplayTarget>> open_window(gpu::Device& device, const DisplayIdentity& display,
                                                               const std::string& application) {
    const compositor::PictureSize panel{static_cast<std::uint32_t>(display.panel_width), static_cast<std::uint32_t>(display.panel_height)};
    return compositor::make_window_target(device, {panel, fmt::format("Entoptic: {}", application), false});
}

}  // namespace

bool may_be_window(const Config& config) { return config.target.value == "window" || (config.target.value == "auto" && is_real(config)); }

Result<OpenTarget> open_target(gpu::Device& device, Clock& clock, const Config& config, const DisplayIdentity& display,
                               const std::string& application) {
    const std::string& wanted = config.target.value;
    if (wanted == "headless" || (wanted == "auto" && !is_real(config))) return OpenTarget{compositor::make_headless_target(), false, ""};
    if (wanted == "window") {
        ENTOPTIC_TRY(window, open_window(device, display, application));
        return OpenTarget{std::move(window), false, ""};
    }
    auto panel = open_panel(device, clock, config, display);
    if (panel) return OpenTarget{std::move(*panel), true, ""};
    if (wanted == "kms") return forward_error(panel.error());
    if (auto window = open_window(device, display, application))
        return OpenTarget{std::move(*window), false, fmt::format("Pictures go to a window. {}", panel.error().message)};
    return OpenTarget{compositor::make_headless_target(), false,
                      fmt::format("Pictures are shown nowhere, as there is no window either. {}", panel.error().message)};
}

}  // namespace entoptic::app
