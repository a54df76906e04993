#include "compositor/targets/kms/panel_choice.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace entoptic::compositor::kms {
namespace {

// 2: a known headset; 1: the kernel says it is one; 0: neither.
int rank_of(const Connector& connector, const std::string& headset) {
    if (!connector.connected) return 0;
    return !headset.empty() ? 2 : connector.non_desktop ? 1 : 0;
}

std::string inventory(const std::vector<Connector>& connectors) {
    std::vector<std::string> parts;
    for (const Connector& c : connectors)
        parts.push_back(fmt::format("{}: {}", c.name, c.connected ? "a display for desktops" : "nothing"));
    return parts.empty() ? "it has no connectors" : fmt::format("{}", fmt::join(parts, ", "));
}

const drmModeModeInfo* nearest_mode(const Connector& connector, const PanelWish& wish) {
    const drmModeModeInfo* best = nullptr;
    const auto distance = [&](const drmModeModeInfo& m) { return std::abs(refresh_hz(m) - wish.refresh_hz); };
    for (const drmModeModeInfo& mode : connector.modes)
        if (mode.hdisplay == wish.width && mode.vdisplay == wish.height && refresh_hz(mode) > 0 &&
            (!best || distance(mode) < distance(*best)))
            best = &mode;
    return best;
}

Error no_such_mode(const Connector& connector, const PanelWish& wish) {
    std::vector<std::string> sizes;
    for (const drmModeModeInfo& mode : connector.modes) {
        std::string size = fmt::format("{}x{}", mode.hdisplay, mode.vdisplay);
        if (std::find(sizes.begin(), sizes.end(), size) == sizes.end()) sizes.push_back(std::move(size));
    }
    return {ErrorKind::failed,
            fmt::format("The panel on {} has no mode of {}x{} pixels; it has {}. Plug its cable in again; a longer or adapted "
                        "cable may not carry the full size.",
                        connector.name, wish.width, wish.height, sizes.empty() ? "none" : fmt::format("{}", fmt::join(sizes, ", ")))};
}

// What drives it already, else what drives nothing: a desktop's monitor is not darkened.
std::uint32_t free_crtc(const Connector& panel, const std::vector<Connector>& connectors) {
    const auto allowed = [&](std::uint32_t crtc) { return std::find(panel.crtcs.begin(), panel.crtcs.end(), crtc) != panel.crtcs.end(); };
    if (panel.crtc && allowed(panel.crtc)) return panel.crtc;
    for (const std::uint32_t crtc : panel.crtcs)
        if (std::none_of(connectors.begin(), connectors.end(), [&](const Connector& c) { return c.connected && c.crtc == crtc; }))
            return crtc;
    return 0;
}

}  // namespace

double refresh_hz(const drmModeModeInfo& mode) {
    const double total = static_cast<double>(mode.htotal) * mode.vtotal;
    if (total <= 0 || mode.htotal < mode.hdisplay || mode.vtotal < mode.vdisplay) return 0;
    const double fields = mode.flags & DRM_MODE_FLAG_INTERLACE ? 2 : 1;
    const double scans = (mode.flags & DRM_MODE_FLAG_DBLSCAN ? 2.0 : 1.0) * std::max<double>(mode.vscan, 1);
    return static_cast<double>(mode.clock) * 1e3 / total * fields / scans;
}

Result<PanelChoice> choose_panel(const std::vector<Connector>& connectors, const PanelWish& wish) {
    PanelChoice choice;
    int best = 0;
    for (const Connector& connector : connectors) {
        std::string headset = connector.edid.empty() ? "" : wish.headset_of_edid(connector.edid);
        const int rank = rank_of(connector, headset);
        if (rank <= best) continue;
        best = rank;
        choice.connector = connector;
        choice.headset = headset.empty() ? "a headset" : std::move(headset);
    }
    if (best == 0) return missing(fmt::format("no headset's panel ({})", inventory(connectors)));
    const drmModeModeInfo* mode = nearest_mode(choice.connector, wish);
    if (!mode) return forward_error(no_such_mode(choice.connector, wish));
    choice.mode = *mode;
    choice.crtc = free_crtc(choice.connector, connectors);
    if (choice.crtc == 0)
        return failure(
            fmt::format("The graphics card drives as many displays as it can, none is left for the panel on {}. Switch a monitor off.",
                        choice.connector.name));
    return choice;
}

}  // namespace entoptic::compositor::kms
