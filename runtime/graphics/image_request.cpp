#include "runtime/graphics/image_request.h"

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

Outcome request_image(const XrSwapchainCreateInfo& info, VkFormat format, SwapchainRequest& request) {
    const bool depth = is_depth_format(format);
    const XrSwapchainUsageFlags wrong = depth ? XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT : XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    if ((info.usageFlags & wrong) != 0) {
        return error(XR_ERROR_FEATURE_UNSUPPORTED, "a {} format cannot have this attachment usage", depth ? "depth" : "colour");
    }
    // The application finds its images in an attachment layout, which needs the attachment usage whether it asked for it or not.
    VkImageUsageFlags usage = depth ? VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    for (const UsageBit& bit : usage_bits) usage |= (info.usageFlags & bit.xr) != 0 ? bit.vk : 0u;
    const bool mutable_format = (info.usageFlags & XR_SWAPCHAIN_USAGE_MUTABLE_FORMAT_BIT) != 0;
    request.vk_format = static_cast<std::uint32_t>(format);
    request.vk_usage = usage;
    request.vk_create_flags = (mutable_format ? VkImageCreateFlags(VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT) : 0u) |
                              (info.faceCount == 6 ? VkImageCreateFlags(VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT) : 0u);
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
