#include "gpu/memory.h"

#include <fmt/format.h>
#include <utility>

namespace entoptic::gpu {
namespace {

VkMemoryPropertyFlags wanted_flags(BufferKind kind) {
    switch (kind) {
    case BufferKind::device: return VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT;
    case BufferKind::upload: return VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    case BufferKind::readback:
        return VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    }
    return 0;
}

}  // namespace

Result<Buffer> Buffer::create(const Device& device, std::size_t bytes, BufferKind kind, const std::string& name) {
    Buffer result;
    result.device_ = &device;
    result.size_ = bytes;
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = bytes;
    info.usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT | VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT |
                 VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    ENTOPTIC_VK(vkCreateBuffer(device.handle(), &info, nullptr, &result.buffer_));
    VkMemoryRequirements requirements{};
    vkGetBufferMemoryRequirements(device.handle(), result.buffer_, &requirements);
    auto type = device.memory_type(requirements.memoryTypeBits, wanted_flags(kind));
    if (!type && kind == BufferKind::readback) type = device.memory_type(requirements.memoryTypeBits, wanted_flags(BufferKind::upload));
    if (!type) return forward_error(type.error());
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    allocate.allocationSize = requirements.size;
    allocate.memoryTypeIndex = *type;
    if (const VkResult r = vkAllocateMemory(device.handle(), &allocate, nullptr, &result.memory_); r != VK_SUCCESS) {
        Error error = vulkan_error("vkAllocateMemory", r);
        error.message += fmt::format(", for {} ({} bytes)", name, bytes);
        return forward_error(error);
    }
    ENTOPTIC_VK(vkBindBufferMemory(device.handle(), result.buffer_, result.memory_, 0));
    if (kind != BufferKind::device) ENTOPTIC_VK(vkMapMemory(device.handle(), result.memory_, 0, VK_WHOLE_SIZE, 0, &result.mapped_));
    device.set_name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(result.buffer_), name);
    return result;
}

Buffer::~Buffer() {
    if (!device_) return;
    vkDestroyBuffer(device_->handle(), buffer_, nullptr);
    vkFreeMemory(device_->handle(), memory_, nullptr);
}

Buffer& Buffer::operator=(Buffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(buffer_, other.buffer_);
    std::swap(memory_, other.memory_);
    std::swap(mapped_, other.mapped_);
    std::swap(size_, other.size_);
    return *this;
}

Result<Image> Image::create(const Device& device, const ImageInfo& info) {
    Image result;
    result.device_ = &device;
    result.info_ = info;
    VkExternalMemoryImageCreateInfo external{VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_IMAGE_CREATE_INFO};
    external.handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
    VkImageCreateInfo create{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, info.exportable ? &external : nullptr};
    create.flags = info.flags;
    create.imageType = VK_IMAGE_TYPE_2D;
    create.format = info.format;
    create.extent = {info.width, info.height, 1};
    create.mipLevels = info.mips;
    create.arrayLayers = info.layers;
    create.samples = info.samples;
    create.tiling = VK_IMAGE_TILING_OPTIMAL;
    create.usage = info.usage;
    create.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    ENTOPTIC_VK(vkCreateImage(device.handle(), &create, nullptr, &result.image_));
    VkMemoryRequirements requirements{};
    vkGetImageMemoryRequirements(device.handle(), result.image_, &requirements);
    ENTOPTIC_TRY(type, device.memory_type(requirements.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT));
    VkMemoryDedicatedAllocateInfo dedicated{VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO};
    dedicated.image = result.image_;
    VkExportMemoryAllocateInfo exported{VK_STRUCTURE_TYPE_EXPORT_MEMORY_ALLOCATE_INFO, &dedicated};
    exported.handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, info.exportable ? static_cast<void*>(&exported) : nullptr};
    allocate.allocationSize = requirements.size;
    allocate.memoryTypeIndex = type;
    ENTOPTIC_VK(vkAllocateMemory(device.handle(), &allocate, nullptr, &result.memory_));
    ENTOPTIC_VK(vkBindImageMemory(device.handle(), result.image_, result.memory_, 0));
    result.memory_size_ = requirements.size;
    result.memory_type_bits_ = requirements.memoryTypeBits;
    device.set_name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(result.image_), info.name);
    return result;
}

Image::~Image() {
    if (!device_) return;
    vkDestroyImage(device_->handle(), image_, nullptr);
    vkFreeMemory(device_->handle(), memory_, nullptr);
}

Image& Image::operator=(Image&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(info_, other.info_);
    std::swap(image_, other.image_);
    std::swap(memory_, other.memory_);
    std::swap(memory_size_, other.memory_size_);
    std::swap(memory_type_bits_, other.memory_type_bits_);
    return *this;
}

Result<int> Image::export_fd() const {
    if (!info_.exportable) return failure("export_fd: the image was not made exportable");
    const auto get = reinterpret_cast<PFN_vkGetMemoryFdKHR>(vkGetDeviceProcAddr(device_->handle(), "vkGetMemoryFdKHR"));
    if (!get) return missing("The Vulkan driver lacks VK_KHR_external_memory_fd, which OpenXR applications' images need.");
    VkMemoryGetFdInfoKHR info{VK_STRUCTURE_TYPE_MEMORY_GET_FD_INFO_KHR};
    info.memory = memory_;
    info.handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
    int fd = -1;
    ENTOPTIC_VK(get(device_->handle(), &info, &fd));
    return fd;
}

Result<VkImageView> Image::create_view(std::uint32_t layer, VkFormat format, VkImageAspectFlags aspect) const {
    VkImageViewCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    VkImageViewUsageCreateInfo usage{VK_STRUCTURE_TYPE_IMAGE_VIEW_USAGE_CREATE_INFO};
    usage.usage = VK_IMAGE_USAGE_SAMPLED_BIT;
    info.pNext = &usage;
    info.image = image_;
    info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    info.format = format;
    info.subresourceRange = {aspect, 0, 1, layer, 1};
    VkImageView view = VK_NULL_HANDLE;
    ENTOPTIC_VK(vkCreateImageView(device_->handle(), &info, nullptr, &view));
    return view;
}

}  // namespace entoptic::gpu
