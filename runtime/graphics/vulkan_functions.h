// XR_KHR_vulkan_enable and XR_KHR_vulkan_enable2: see graphics/bindings.h.
#pragma once

#include "runtime/graphics/bindings.h"

namespace entoptic::runtime::graphics {

std::span<const FunctionEntry> vulkan_functions();
bool has_vulkan_binding(const void* chain);
// XR_ERROR_GRAPHICS_DEVICE_INVALID also when the binding's device is not the one that xrGetVulkanGraphicsDevice named.
Outcome make_vulkan_device(Instance& instance, const void* chain, std::unique_ptr<GraphicsDevice>& device);

}  // namespace entoptic::runtime::graphics
