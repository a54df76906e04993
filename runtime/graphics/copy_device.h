// A Vulkan device of the runtime's own on the GPU that composes: it fills the compositor's images from the CPU's memory, for graphics APIs
// that cannot share theirs.
#pragma once

#include "runtime/graphics/vulkan_dispatch.h"

#include "interfaces/image_memory.h"
#include "runtime/objects/outcome.h"

#include <memory>
#include <mutex>
#include <span>
#include <vector>

namespace entoptic::runtime::graphics {

class CopyDevice {
public:
    // XR_ERROR_RUNTIME_FAILURE when no device has this UUID.
    static Outcome create(const std::array<std::uint8_t, 16>& device_uuid, std::shared_ptr<CopyDevice>& device);
    ~CopyDevice();
    CopyDevice(const CopyDevice&) = delete;
    CopyDevice& operator=(const CopyDevice&) = delete;

    const DeviceDispatch& functions() const { return functions_; }
    VkDevice device() const { return device_; }
    VkCommandPool pool() const { return pool_; }
    std::uint32_t queue_family() const { return queue_family_; }
    // Of memory that the CPU can write without flushing; 32: none.
    std::uint32_t host_memory_type(std::uint32_t bits) const;
    Outcome submit(VkCommandBuffer commands, VkFence fence);

private:
    CopyDevice() = default;
    Outcome open(const std::array<std::uint8_t, 16>& device_uuid);

    InstanceDispatch instance_functions_;
    DeviceDispatch functions_;
    VkInstance instance_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    std::uint32_t queue_family_ = 0;
    std::mutex queue_mutex_;
};

// One image of the compositor, and memory of the CPU's that it is filled from.
class CopiedImage {
public:
    CopiedImage(std::shared_ptr<CopyDevice> device, const ImageMemory& memory, std::uint32_t texel_bytes, VkImageAspectFlags aspect);
    ~CopiedImage();
    CopiedImage(const CopiedImage&) = delete;
    CopiedImage& operator=(const CopiedImage&) = delete;

    // Once. The file descriptor is taken over on success (set to -1).
    Outcome import(ImageMemory& memory);
    // Level by level, in each all layers, rows without gaps. Not to be written while pending().
    std::span<std::byte> level(std::uint32_t level) const;
    // Sends what was written on its way to the image.
    Outcome send();
    bool pending() const { return pending_; }
    // Returns when it is there.
    Outcome wait();

private:
    Outcome make_buffer();
    Outcome record();

    const std::shared_ptr<CopyDevice> device_;
    const VkFormat format_;
    const std::uint32_t texel_bytes_;
    std::vector<VkBufferImageCopy> regions_;  // one a level
    VkDeviceSize buffer_size_ = 0;
    VkImage image_ = VK_NULL_HANDLE;
    VkDeviceMemory image_memory_ = VK_NULL_HANDLE, buffer_memory_ = VK_NULL_HANDLE;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    std::byte* mapped_ = nullptr;
    VkCommandBuffer commands_ = VK_NULL_HANDLE;
    VkFence sent_ = VK_NULL_HANDLE;
    bool pending_ = false;
};

}  // namespace entoptic::runtime::graphics
