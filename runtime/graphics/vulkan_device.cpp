#include "runtime/graphics/vulkan_device.h"

#include "runtime/graphics/vulkan_images.h"

namespace entoptic::runtime::graphics {

Outcome VulkanDevice::describe(const XrSwapchainCreateInfo& info, SwapchainRequest& request) const {
    const auto format = static_cast<VkFormat>(info.format);
    ENTOPTIC_XR_TRY(request_image(info, format, request));
    VkImageFormatProperties limits{};
    const VkResult result = context_->instance_functions.GetPhysicalDeviceImageFormatProperties(
        context_->physical_device, format, VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_OPTIMAL, request.vk_usage, request.vk_create_flags, &limits);
    const bool fits = info.width <= limits.maxExtent.width && info.height <= limits.maxExtent.height &&
                      info.arraySize * info.faceCount <= limits.maxArrayLayers && info.mipCount <= limits.maxMipLevels;
    if (result != VK_SUCCESS || !fits) {
        return error(XR_ERROR_FEATURE_UNSUPPORTED, "the GPU has no {}x{}x{} image of format {} with usage {:#x}", info.width, info.height,
                     info.arraySize, info.format, request.vk_usage);
    }
    return XR_SUCCESS;
}

Outcome VulkanDevice::import(SwapchainAllocation allocation, std::unique_ptr<SwapchainImages>& images) {
    auto imported = std::make_unique<VulkanImages>(context_);
    ENTOPTIC_XR_TRY(imported->import(std::move(allocation.images)));
    images = std::move(imported);
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
