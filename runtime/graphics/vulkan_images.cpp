#include "runtime/graphics/vulkan_images.h"

#include "runtime/graphics/vulkan_import.h"

namespace entoptic::runtime::graphics {

VulkanImages::~VulkanImages() {
    const DeviceDispatch& vk = context_->functions;
    for (const auto& image : images_) {
        // However long it takes: what the GPU still draws into must not be freed. A GPU that hangs ends the wait as a lost device.
        static_cast<void>(wait(image->acquired, image->acquired_pending, UINT64_MAX).code());
        static_cast<void>(wait(image->released, image->released_pending, UINT64_MAX).code());
        if (image->acquired) vk.DestroyFence(context_->device, image->acquired, nullptr);
        if (image->released) vk.DestroyFence(context_->device, image->released, nullptr);
        if (image->image) vk.DestroyImage(context_->device, image->image, nullptr);
        if (image->memory) vk.FreeMemory(context_->device, image->memory, nullptr);
    }
    if (pool_) vk.DestroyCommandPool(context_->device, pool_, nullptr);
}

Outcome VulkanImages::import(std::vector<ImageMemory> memories) {
    const Descriptors descriptors{memories};
    if (memories.empty()) return error(XR_ERROR_RUNTIME_FAILURE, "the compositor gave no image");
    const ImageMemory description = memories.front();
    for (ImageMemory& memory : memories) {
        if (memory.device_uuid != context_->device_uuid) {
            return error(XR_ERROR_RUNTIME_FAILURE, "the compositor's image lies on another GPU than the application's");
        }
        Image& image = *images_.emplace_back(std::make_unique<Image>());
        ENTOPTIC_XR_TRY(import_image(context_->functions, context_->device, memory, image.image, image.memory));
        const VkFenceCreateInfo info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
        for (VkFence* fence : {&image.acquired, &image.released}) {
            const VkResult result = context_->functions.CreateFence(context_->device, &info, nullptr, fence);
            if (result != VK_SUCCESS) return failed("vkCreateFence", result);
        }
    }
    return make_commands(description);
}

Outcome VulkanImages::record(VkCommandBuffer commands, const VkImageMemoryBarrier& barrier) {
    const DeviceDispatch& vk = context_->functions;
    VkCommandBufferBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    if (VkResult result = vk.BeginCommandBuffer(commands, &begin); result != VK_SUCCESS) return failed("vkBeginCommandBuffer", result);
    vk.CmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0, nullptr, 1,
                          &barrier);
    const VkResult result = vk.EndCommandBuffer(commands);
    return result == VK_SUCCESS ? Outcome() : failed("vkEndCommandBuffer", result);
}

Outcome VulkanImages::make_commands(const ImageMemory& description) {
    const DeviceDispatch& vk = context_->functions;
    VkCommandPoolCreateInfo pool{};
    pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool.queueFamilyIndex = context_->queue_family;
    if (VkResult result = vk.CreateCommandPool(context_->device, &pool, nullptr, &pool_); result != VK_SUCCESS) {
        return failed("vkCreateCommandPool", result);
    }
    const auto format = static_cast<VkFormat>(description.vk_format);
    const VkImageLayout attachment =
        is_depth_format(format) ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    const VkAccessFlags everything = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT;
    for (const auto& image : images_) {
        VkCommandBufferAllocateInfo allocate{};
        allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
        allocate.commandPool = pool_;
        allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
        allocate.commandBufferCount = 3;
        std::array<VkCommandBuffer, 3> buffers{};
        if (VkResult result = vk.AllocateCommandBuffers(context_->device, &allocate, buffers.data()); result != VK_SUCCESS) {
            return failed("vkAllocateCommandBuffers", result);
        }
        image->first_acquire = buffers[0];
        image->acquire = buffers[1];
        image->release = buffers[2];
        VkImageMemoryBarrier barrier{};
        barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
        barrier.image = image->image;
        barrier.subresourceRange = {aspect_of(format), 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
        barrier.dstAccessMask = everything;
        barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
        barrier.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED;
        barrier.newLayout = attachment;
        ENTOPTIC_XR_TRY(record(image->first_acquire, barrier));
        barrier.oldLayout = VK_IMAGE_LAYOUT_GENERAL;
        barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_EXTERNAL;
        barrier.dstQueueFamilyIndex = context_->queue_family;
        ENTOPTIC_XR_TRY(record(image->acquire, barrier));
        barrier.srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT;
        barrier.dstAccessMask = 0;
        barrier.oldLayout = attachment;
        barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
        barrier.srcQueueFamilyIndex = context_->queue_family;
        barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_EXTERNAL;
        ENTOPTIC_XR_TRY(record(image->release, barrier));
    }
    return XR_SUCCESS;
}

Outcome VulkanImages::submit(VkCommandBuffer commands, VkFence fence, bool& pending) {
    if (VkResult result = context_->functions.ResetFences(context_->device, 1, &fence); result != VK_SUCCESS)
        return failed("vkResetFences", result);
    VkSubmitInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    info.commandBufferCount = 1;
    info.pCommandBuffers = &commands;
    std::lock_guard lock(context_->queue_mutex);
    const VkResult result = context_->functions.QueueSubmit(context_->queue, 1, &info, fence);
    if (result != VK_SUCCESS) return failed("vkQueueSubmit", result);
    pending = true;
    return XR_SUCCESS;
}

Outcome VulkanImages::wait(VkFence fence, bool& pending, std::uint64_t longest_ns) {
    if (!pending) return XR_SUCCESS;
    const VkResult result = context_->functions.WaitForFences(context_->device, 1, &fence, VK_TRUE, longest_ns);
    if (result != VK_SUCCESS) return failed("the wait for the application's GPU work", result);
    pending = false;
    return XR_SUCCESS;
}

Outcome VulkanImages::enumerate(XrSwapchainImageBaseHeader* images) const {
    auto* out = reinterpret_cast<XrSwapchainImageVulkanKHR*>(images);
    for (std::size_t i = 0; i < images_.size(); ++i) {
        if (out[i].type != XR_TYPE_SWAPCHAIN_IMAGE_VULKAN_KHR) {
            return error(XR_ERROR_VALIDATION_FAILURE, "images[{}].type must be XR_TYPE_SWAPCHAIN_IMAGE_VULKAN_KHR", i);
        }
    }
    for (std::size_t i = 0; i < images_.size(); ++i) out[i].image = images_[i]->image;
    return XR_SUCCESS;
}

Outcome VulkanImages::acquire(std::uint32_t index) {
    Image& image = *images_[index];
    // Its commands are free again then.
    ENTOPTIC_XR_TRY(wait(image.acquired, image.acquired_pending));
    ENTOPTIC_XR_TRY(submit(image.used ? image.acquire : image.first_acquire, image.acquired, image.acquired_pending));
    image.used = true;
    return XR_SUCCESS;
}

Outcome VulkanImages::release(std::uint32_t index) {
    Image& image = *images_[index];
    std::lock_guard lock(image.released_mutex);
    ENTOPTIC_XR_TRY(wait(image.released, image.released_pending));
    return submit(image.release, image.released, image.released_pending);
}

Outcome VulkanImages::wait_released(std::uint32_t index) {
    Image& image = *images_[index];
    std::lock_guard lock(image.released_mutex);
    return wait(image.released, image.released_pending);
}

}  // namespace entoptic::runtime::graphics
