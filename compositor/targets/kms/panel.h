// A headset's own panel, driven through the kernel (DRM/KMS): pictures without a desktop between, one a refresh, and the true time of each.
#pragma once

#include "compositor/targets/kms/panel_choice.h"
#include "compositor/targets/target.h"

#include <functional>
#include <memory>

namespace entoptic::compositor::kms {

// A card with the right to light the panel on it.
struct HeldPanel {
    std::unique_ptr<DrmCard> card;
    PanelChoice choice;
};
using HoldPanel = std::function<Result<HeldPanel>(const PanelWish&)>;

// The ways to a panel, tried in this order where the session has them: a lease from the Wayland compositor (WAYLAND_DISPLAY), a lease from
// the X server (DISPLAY), the card itself (no display server runs on it). Errors: missing, when no way finds a panel; else why the panel
// that was found cannot be had, and what to do.
Result<HeldPanel> hold_panel(const PanelWish& wish);

struct PanelOptions {
    PanelWish wish;
    HoldPanel hold = hold_panel;
    DurationNs patience = 0;  // how long a panel may take to appear at first: a headset switches it on seconds after it was told to
};

// `device` and `clock` (CLOCK_MONOTONIC's) outlive the target. Errors: of `hold`, after `patience`; or the card refuses buffers or mode.
//
// A panel that is unplugged, or whose lease is taken back, is away: pictures count as not shown, and it is asked for again each second.
Result<std::unique_ptr<DisplayTarget>> make_panel_target(gpu::Device& device, Clock& clock, PanelOptions options);

}  // namespace entoptic::compositor::kms
