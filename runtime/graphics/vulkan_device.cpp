#include "runtime/graphics/vulkan_device.h"

#include "runtime/graphics/vulkan_images.h"

namespace entoptic::runtime::graphics {

namespace {

struct UsageBit {
    XrSwapchainUsageFlags xr;
    VkImageUsageFlags vk;
};
constexpr UsageBit usage_bits[] = {
    {XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT, VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT},
    {XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT},
    {XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT, VK_IMAGE_USAGE_STORAGE_BIT},
    {XR_SWAPCHAIN_USAGE_TRANSFER_SRC_BIT, VK_IMAGE_USAGE_TRANSFER_SRC_BIT},
    {XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT, VK_IMAGE_USAGE_TRANSFER_DST_BIT},
    {XR_SWAPCHAIN_USAGE_SAMPLED_BIT, VK_IMAGE_USAGE_SAMPLED_BIT},
};

}  // namespace

bool is_depth_format(VkFormat format) { return (aspect_of(format) & VK_IMAGE_ASPECT_COLOR_BIT) == 0; }

VkImageAspectFlags aspect_of(VkFormat format) {
    switch (format) {
        case VK_FORMAT_D16_UNORM:
        case VK_FORMAT_X8_D24_UNORM_PACK32:
        case VK_FORMAT_D32_SFLOAT:
            return VK_IMAGE_ASPECT_DEPTH_BIT;
        case VK_FORMAT_D16_UNORM_S8_UINT:
        case VK_FORMAT_D24_UNORM_S8_UINT:
        case VK_FORMAT_D32_SFLOAT_S8_UINT:
            return VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT;
        case VK_FORMAT_S8_UINT:
            return VK_IMAGE_ASPECT_STENCIL_BIT;
        default:
            return VK_IMAGE_ASPECT_COLOR_BIT;
    }
}

Outcome VulkanDevice::describe(const XrSwapchainCreateInfo& info, SwapchainRequest& request) const {
    const auto format = static_cast<VkFormat>(info.format);
    const bool depth = is_depth_format(format);
    const XrSwapchainUsageFlags wrong = depth ? XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT : XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    if ((info.usageFlags & wrong) != 0) {
        return error(XR_ERROR_FEATURE_UNSUPPORTED, "a {} format cannot have this attachment usage", depth ? "depth" : "colour");
    }
    // The application finds its images in an attachment layout, which needs the attachment usage whether it asked for it or not.
    VkImageUsageFlags usage = depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    for (const UsageBit& bit : usage_bits) usage |= (info.usageFlags & bit.xr) != 0 ? bit.vk : 0u;
    const bool mutable_format = (info.usageFlags & XR_SWAPCHAIN_USAGE_MUTABLE_FORMAT_BIT) != 0;
    const VkImageCreateFlags flags = (mutable_format ? VkImageCreateFlags(VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT) : 0u) |
                                     (info.faceCount == 6 ? VkImageCreateFlags(VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT) : 0u);
    VkImageFormatProperties limits{};
    const VkResult result = context_->instance_functions.GetPhysicalDeviceImageFormatProperties(
        context_->physical_device, format, VK_IMAGE_TYPE_2D, VK_IMAGE_TILING_OPTIMAL, usage, flags, &limits);
    const bool fits = info.width <= limits.maxExtent.width && info.height <= limits.maxExtent.height &&
                      info.arraySize * info.faceCount <= limits.maxArrayLayers && info.mipCount <= limits.maxMipLevels;
    if (result != VK_SUCCESS || !fits) {
        return error(XR_ERROR_FEATURE_UNSUPPORTED, "the GPU has no {}x{}x{} image of format {} with usage {:#x}", info.width, info.height,
                     info.arraySize, info.format, usage);
    }
    request.vk_format = static_cast<std::uint32_t>(format);
    request.vk_usage = usage;
    request.vk_create_flags = flags;
    return XR_SUCCESS;
}

Outcome VulkanDevice::import(SwapchainAllocation allocation, std::unique_ptr<SwapchainImages>& images) {
    auto imported = std::make_unique<VulkanImages>(context_);
    ENTOPTIC_XR_TRY(imported->import(std::move(allocation.images)));
    images = std::move(imported);
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
