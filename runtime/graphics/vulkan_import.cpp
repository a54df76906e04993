#include "runtime/graphics/vulkan_import.h"

#include <bit>
#include <unistd.h>

namespace entoptic::runtime::graphics {

namespace {

Outcome create_image(const DeviceDispatch& vk, VkDevice device, const ImageMemory& memory, VkImage& image) {
    VkExternalMemoryImageCreateInfo external{};
    external.sType = VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_IMAGE_CREATE_INFO;
    external.handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
    VkImageCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
    info.pNext = &external;
    info.flags = memory.vk_create_flags;
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = static_cast<VkFormat>(memory.vk_format);
    info.extent = {memory.width, memory.height, 1};
    info.mipLevels = memory.mip_levels;
    info.arrayLayers = memory.array_layers;
    info.samples = static_cast<VkSampleCountFlagBits>(memory.samples);
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = memory.vk_usage;
    info.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
    info.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    const VkResult result = vk.CreateImage(device, &info, nullptr, &image);
    return result == VK_SUCCESS ? Outcome() : failed("vkCreateImage", result);
}

}  // namespace

Outcome failed(const char* what, VkResult result) {
    const bool memory = result == VK_ERROR_OUT_OF_HOST_MEMORY || result == VK_ERROR_OUT_OF_DEVICE_MEMORY;
    return error(memory ? XR_ERROR_OUT_OF_MEMORY : XR_ERROR_RUNTIME_FAILURE, "{} failed in the application's Vulkan device (VkResult {})",
                 what, static_cast<int>(result));
}

Descriptors::~Descriptors() {
    for (ImageMemory& memory : memories) {
        if (memory.fd >= 0) ::close(memory.fd);
    }
}

Outcome import_image(const DeviceDispatch& vk, VkDevice device, ImageMemory& memory, VkImage& image, VkDeviceMemory& bound) {
    ENTOPTIC_XR_TRY(create_image(vk, device, memory, image));
    VkMemoryRequirements requirements{};
    vk.GetImageMemoryRequirements(device, image, &requirements);
    const std::uint32_t types = requirements.memoryTypeBits & memory.memory_type_bits;
    if (types == 0 || requirements.size > memory.size) {
        return error(XR_ERROR_RUNTIME_FAILURE,
                     "the compositor's image does not fit the application's device; both must be the same GPU and driver");
    }
    VkMemoryDedicatedAllocateInfo dedicated{};
    dedicated.sType = VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO;
    dedicated.image = image;
    VkImportMemoryFdInfoKHR import{};
    import.sType = VK_STRUCTURE_TYPE_IMPORT_MEMORY_FD_INFO_KHR;
    import.pNext = &dedicated;
    import.handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
    import.fd = memory.fd;
    VkMemoryAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    allocate.pNext = &import;
    allocate.allocationSize = memory.size;
    // The memory type of an import must be the exporter's: the lowest of the bits both sides allow.
    allocate.memoryTypeIndex = static_cast<std::uint32_t>(std::countr_zero(types));
    if (VkResult result = vk.AllocateMemory(device, &allocate, nullptr, &bound); result != VK_SUCCESS)
        return failed("vkAllocateMemory of an imported image", result);
    memory.fd = -1;  // the device's now
    const VkResult result = vk.BindImageMemory(device, image, bound, 0);
    return result == VK_SUCCESS ? Outcome() : failed("vkBindImageMemory", result);
}

}  // namespace entoptic::runtime::graphics
