// The images of one swapchain in the application's device: imported memory, and the barriers that hand each image over and take it back.
//
// Between the two devices an image is in layout GENERAL and owned by VK_QUEUE_FAMILY_EXTERNAL. acquire() submits the barrier to the
// attachment layout on the application's queue, release() the one back, with a fence: lavapipe cannot export semaphores, so xrEndFrame
// waits for that fence before the compositor may read.
#pragma once

#include "runtime/graphics/vulkan_device.h"

#include <memory>
#include <mutex>
#include <vector>

namespace entoptic::runtime::graphics {

class VulkanImages final : public SwapchainImages {
public:
    explicit VulkanImages(std::shared_ptr<VulkanContext> context) : context_(std::move(context)) {}
    ~VulkanImages() override;

    // Once. Takes over the file descriptors, also when it fails.
    Outcome import(std::vector<ImageMemory> memories);

    std::uint32_t count() const override { return static_cast<std::uint32_t>(images_.size()); }
    Outcome enumerate(XrSwapchainImageBaseHeader* images) const override;
    Outcome acquire(std::uint32_t index) override;
    Outcome release(std::uint32_t index) override;
    Outcome wait_released(std::uint32_t index) override;

private:
    struct Image {
        VkImage image = VK_NULL_HANDLE;
        VkDeviceMemory memory = VK_NULL_HANDLE;
        VkCommandBuffer first_acquire = VK_NULL_HANDLE, acquire = VK_NULL_HANDLE, release = VK_NULL_HANDLE;
        VkFence acquired = VK_NULL_HANDLE, released = VK_NULL_HANDLE;  // of the last submissions of these commands
        bool acquired_pending = false;
        std::mutex released_mutex;      // a fence may not be reset while another thread waits for it
        bool released_pending = false;  // with released_mutex
        bool used = false;              // false: contents and layout are undefined
    };

    Outcome make_commands(const ImageMemory& description);
    Outcome record(VkCommandBuffer commands, const VkImageMemoryBarrier& barrier);
    Outcome submit(VkCommandBuffer commands, VkFence fence, bool& pending);
    static constexpr std::uint64_t longest_gpu_wait_ns = 20'000'000'000;
    Outcome wait(VkFence fence, bool& pending, std::uint64_t longest_ns = longest_gpu_wait_ns);

    std::shared_ptr<VulkanContext> context_;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    std::vector<std::unique_ptr<Image>> images_;
};

}  // namespace entoptic::runtime::graphics
