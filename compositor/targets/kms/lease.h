// The ways to hold a panel (HoldPanel, panel.h). Each returns missing when there is no panel that way, and failed when there is one that
// cannot be had; what it returns keeps the connection that a lease hangs on.
#pragma once

#include "compositor/targets/kms/panel.h"

namespace entoptic::compositor::kms {

// A lease from the Wayland compositor of this session (wp_drm_lease_device_v1).
Result<HeldPanel> lease_from_wayland(const PanelWish& wish);
// A lease from the X server of this session (RandR 1.6).
Result<HeldPanel> lease_from_x11(const PanelWish& wish);
// The graphics card itself, where no display server holds it.
Result<HeldPanel> hold_card(const PanelWish& wish);

}  // namespace entoptic::compositor::kms
