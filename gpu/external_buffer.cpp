#include "gpu/external_buffer.h"

#include <cstdint>
#include <fmt/format.h>
#include <utility>

namespace entoptic::gpu {
namespace {

constexpr VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;

bool can(const Device& device, VkExternalMemoryHandleTypeFlagBits type, VkExternalMemoryFeatureFlagBits what) {
    VkPhysicalDeviceExternalBufferInfo question{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_EXTERNAL_BUFFER_INFO};
    question.usage = usage;
    question.handleType = type;
    VkExternalBufferProperties answer{VK_STRUCTURE_TYPE_EXTERNAL_BUFFER_PROPERTIES};
    vkGetPhysicalDeviceExternalBufferProperties(device.physical(), &question, &answer);
    return (answer.externalMemoryProperties.externalMemoryFeatures & what) != 0;
}

// Null where the device's extension is not there.
template <class Function> Function function_of(const Device& device, const char* name) {
    return reinterpret_cast<Function>(vkGetDeviceProcAddr(device.handle(), name));
}

std::size_t host_memory_alignment(const Device& device) {
    VkPhysicalDeviceExternalMemoryHostPropertiesEXT host{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_EXTERNAL_MEMORY_HOST_PROPERTIES_EXT};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &host};
    vkGetPhysicalDeviceProperties2(device.physical(), &properties);
    return static_cast<std::size_t>(host.minImportedHostPointerAlignment);
}

}  // namespace

Result<void> ExternalBuffer::create_handle(std::size_t bytes, VkExternalMemoryHandleTypeFlagBits type) {
    VkExternalMemoryBufferCreateInfo external{VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_BUFFER_CREATE_INFO};
    external.handleTypes = type;
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, &external};
    info.size = bytes;
    info.usage = usage;
    ENTOPTIC_VK(vkCreateBuffer(device_->handle(), &info, nullptr, &buffer_));
    return {};
}

Result<void> ExternalBuffer::allocate(const VkMemoryAllocateInfo& info, const std::string& name) {
    ENTOPTIC_VK(vkAllocateMemory(device_->handle(), &info, nullptr, &memory_));
    ENTOPTIC_VK(vkBindBufferMemory(device_->handle(), buffer_, memory_, 0));
    device_->set_name(VK_OBJECT_TYPE_BUFFER, reinterpret_cast<std::uint64_t>(buffer_), name);
    return {};
}

Result<ExternalBuffer> ExternalBuffer::over_host_memory(const Device& device, std::span<std::byte> memory, const std::string& name) {
    constexpr auto type = VK_EXTERNAL_MEMORY_HANDLE_TYPE_HOST_ALLOCATION_BIT_EXT;
    const auto properties_of = function_of<PFN_vkGetMemoryHostPointerPropertiesEXT>(device, "vkGetMemoryHostPointerPropertiesEXT");
    if (!properties_of || !can(device, type, VK_EXTERNAL_MEMORY_FEATURE_IMPORTABLE_BIT))
        return missing("The Vulkan driver cannot draw into memory of others (VK_EXT_external_memory_host).");
    const std::size_t alignment = host_memory_alignment(device);
    if (alignment == 0 || memory.empty() || memory.size() % alignment != 0 ||
        reinterpret_cast<std::uintptr_t>(memory.data()) % alignment != 0)
        return failure(fmt::format("{}: memory that Vulkan draws into must start and end at multiples of {} bytes.", name, alignment));
    VkMemoryHostPointerPropertiesEXT pointer{VK_STRUCTURE_TYPE_MEMORY_HOST_POINTER_PROPERTIES_EXT};
    ENTOPTIC_VK(properties_of(device.handle(), type, memory.data(), &pointer));
    ExternalBuffer result;
    result.device_ = &device;
    ENTOPTIC_CHECK(result.create_handle(memory.size(), type));
    VkMemoryRequirements requirements{};
    vkGetBufferMemoryRequirements(device.handle(), result.buffer_, &requirements);
    if (requirements.size > memory.size())
        return failure(fmt::format("{}: Vulkan wants {} bytes for a buffer of {}.", name, requirements.size, memory.size()));
    ENTOPTIC_TRY(memory_type, device.memory_type(requirements.memoryTypeBits & pointer.memoryTypeBits, 0));
    VkImportMemoryHostPointerInfoEXT import{VK_STRUCTURE_TYPE_IMPORT_MEMORY_HOST_POINTER_INFO_EXT};
    import.handleType = type;
    import.pHostPointer = memory.data();
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, &import};
    info.allocationSize = memory.size();
    info.memoryTypeIndex = memory_type;
    ENTOPTIC_CHECK(result.allocate(info, name));
    return result;
}

Result<ExternalBuffer> ExternalBuffer::create_shared(const Device& device, std::size_t bytes, const std::string& name, int& dma_buf) {
    constexpr auto type = VK_EXTERNAL_MEMORY_HANDLE_TYPE_DMA_BUF_BIT_EXT;
    const auto fd_of = function_of<PFN_vkGetMemoryFdKHR>(device, "vkGetMemoryFdKHR");
    if (!fd_of || !can(device, type, VK_EXTERNAL_MEMORY_FEATURE_EXPORTABLE_BIT))
        return missing("The Vulkan driver does not share memory as dma-bufs (VK_EXT_external_memory_dma_buf).");
    ExternalBuffer result;
    result.device_ = &device;
    ENTOPTIC_CHECK(result.create_handle(bytes, type));
    VkMemoryRequirements requirements{};
    vkGetBufferMemoryRequirements(device.handle(), result.buffer_, &requirements);
    ENTOPTIC_TRY(memory_type, device.memory_type(requirements.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT));
    VkMemoryDedicatedAllocateInfo dedicated{VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO};
    dedicated.buffer = result.buffer_;
    VkExportMemoryAllocateInfo exported{VK_STRUCTURE_TYPE_EXPORT_MEMORY_ALLOCATE_INFO, &dedicated};
    exported.handleTypes = type;
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, &exported};
    info.allocationSize = requirements.size;
    info.memoryTypeIndex = memory_type;
    ENTOPTIC_CHECK(result.allocate(info, name));
    VkMemoryGetFdInfoKHR fd{VK_STRUCTURE_TYPE_MEMORY_GET_FD_INFO_KHR};
    fd.memory = result.memory_;
    fd.handleType = type;
    ENTOPTIC_VK(fd_of(device.handle(), &fd, &dma_buf));
    return result;
}

Binding ExternalBuffer::binding() const {
    Binding binding(VK_NULL_HANDLE, VK_NULL_HANDLE, VK_IMAGE_LAYOUT_UNDEFINED);
    binding.buffer = {buffer_, 0, VK_WHOLE_SIZE};
    return binding;
}

ExternalBuffer::~ExternalBuffer() {
    if (!device_) return;
    vkDestroyBuffer(device_->handle(), buffer_, nullptr);
    vkFreeMemory(device_->handle(), memory_, nullptr);
}

ExternalBuffer& ExternalBuffer::operator=(ExternalBuffer&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(buffer_, other.buffer_);
    std::swap(memory_, other.memory_);
    return *this;
}

}  // namespace entoptic::gpu
