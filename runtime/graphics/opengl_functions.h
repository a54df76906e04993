// XR_KHR_opengl_enable and XR_MNDX_egl_enable: see graphics/bindings.h.
#pragma once

#include "runtime/graphics/bindings.h"

namespace entoptic::runtime::graphics {

std::span<const FunctionEntry> opengl_functions();
// Xlib's, Xcb's or EGL's.
bool has_opengl_binding(const void* chain);
Outcome make_opengl_device(Instance& instance, const void* chain, std::unique_ptr<GraphicsDevice>& device);

}  // namespace entoptic::runtime::graphics
