// Buffers whose memory crosses Vulkan's border: over memory of somebody else's, or for another driver to use. The GPU's side only.
#pragma once

#include "gpu/commands.h"

#include <cstddef>
#include <span>
#include <string>

namespace entoptic::gpu {

class ExternalBuffer {
public:
    ExternalBuffer() = default;
    // Over `memory`, which outlives the buffer: the GPU's writes arrive in it. Address and size must suit the driver (mappings of whole pages
    // do). Errors: the driver has no VK_EXT_external_memory_host, or refuses this memory (it may refuse mappings of devices).
    static Result<ExternalBuffer> over_host_memory(const Device& device, std::span<std::byte> memory, const std::string& name);
    // In the GPU's own memory. `dma_buf` becomes a file descriptor of it for other drivers, which the caller owns. Errors: the driver has no
    // VK_EXT_external_memory_dma_buf, or there is no room.
    static Result<ExternalBuffer> create_shared(const Device& device, std::size_t bytes, const std::string& name, int& dma_buf);
    ~ExternalBuffer();
    ExternalBuffer(ExternalBuffer&& other) noexcept { *this = std::move(other); }
    ExternalBuffer& operator=(ExternalBuffer&& other) noexcept;

    Binding binding() const;  // all of it, as a storage buffer
    explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }

private:
    Result<void> create_handle(std::size_t bytes, VkExternalMemoryHandleTypeFlagBits type);
    Result<void> allocate(const VkMemoryAllocateInfo& info, const std::string& name);

    const Device* device_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
};

}  // namespace entoptic::gpu
