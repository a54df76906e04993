// What xrCreateSwapchain asks for, as Vulkan's numbers: common to all graphics APIs, for the compositor makes every image with Vulkan.
#pragma once

#include "runtime/graphics/vulkan_openxr.h"

#include "interfaces/frame_service.h"
#include "runtime/objects/outcome.h"

namespace entoptic::runtime::graphics {

bool is_depth_format(VkFormat format);
VkImageAspectFlags aspect_of(VkFormat format);

// Fills format, usage and create flags of `request`. XR_ERROR_FEATURE_UNSUPPORTED when a colour format is asked for as depth attachment,
// or a depth format as colour attachment.
Outcome request_image(const XrSwapchainCreateInfo& info, VkFormat format, SwapchainRequest& request);

}  // namespace entoptic::runtime::graphics
