// Which of a card's connectors is the headset's panel, in which mode, and driven by what. Pure: decides on what DrmCard read.
#pragma once

#include "compositor/targets/kms/drm_card.h"

#include <functional>

namespace entoptic::compositor::kms {

struct PanelWish {
    std::uint32_t width = 2880, height = 1600;  // of both eyes side by side, pixels
    double refresh_hz = 90;                     // the mode nearest to it
    // A headset's name, or "" for an EDID that is no headset's or is damaged. The bytes are untrusted.
    std::function<std::string(std::span<const std::uint8_t>)> headset_of_edid = [](std::span<const std::uint8_t>) { return std::string(); };
};

struct PanelChoice {
    Connector connector;
    std::string headset;  // "HTC Vive Pro", "a headset" when only the kernel knows it for one
    std::uint32_t crtc = 0;
    drmModeModeInfo mode{};
};

// Refreshes per second: pixel clock over total pixels; 0 when the mode is none.
double refresh_hz(const drmModeModeInfo& mode);

// A connector whose EDID is a known headset's comes before one that the kernel marks as no desktop's. Errors: missing when there is
// neither (the message lists what there is); failed when it has no mode of that size, or everything that could drive it drives another.
Result<PanelChoice> choose_panel(const std::vector<Connector>& connectors, const PanelWish& wish);

}  // namespace entoptic::compositor::kms
