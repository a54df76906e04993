#include "runtime/graphics/copy_device.h"

#include "runtime/graphics/image_request.h"
#include "runtime/graphics/vulkan_import.h"

#include <algorithm>

namespace entoptic::runtime::graphics {

namespace {

constexpr std::uint64_t longest_gpu_wait_ns = 20'000'000'000;
constexpr VkDeviceSize level_alignment = 16;  // of every texel size there is, and of 4 (VkBufferImageCopy::bufferOffset)

VkDeviceSize level_size(const VkBufferImageCopy& region, std::uint32_t texel_bytes) {
    return VkDeviceSize(region.imageExtent.width) * region.imageExtent.height * region.imageSubresource.layerCount * texel_bytes;
}

// The first family that has graphics: a transfer of depth needs that. Every device that composes has one.
std::uint32_t graphics_family(VkPhysicalDevice physical) {
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
    const auto found = std::find_if(families.begin(), families.end(),
                                    [](const VkQueueFamilyProperties& family) { return (family.queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0; });
    return found == families.end() ? 0 : static_cast<std::uint32_t>(found - families.begin());
}

}  // namespace

Outcome CopyDevice::create(const std::array<std::uint8_t, 16>& device_uuid, std::shared_ptr<CopyDevice>& device) {
    std::shared_ptr<CopyDevice> made(new CopyDevice);
    ENTOPTIC_XR_TRY(made->open(device_uuid));
    device = std::move(made);
    return XR_SUCCESS;
}

Outcome CopyDevice::open(const std::array<std::uint8_t, 16>& device_uuid) {
    const VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "Entoptic", 0, "Entoptic", 0, VK_API_VERSION_1_1};
    VkInstanceCreateInfo instance{};
    instance.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO;
    instance.pApplicationInfo = &application;
    if (VkResult result = vkCreateInstance(&instance, nullptr, &instance_); result != VK_SUCCESS) return failed("vkCreateInstance", result);
    if (instance_functions_.load(&vkGetInstanceProcAddr, instance_))
        physical_ = find_physical_device(instance_functions_, instance_, device_uuid);
    if (!physical_) return error(XR_ERROR_RUNTIME_FAILURE, "the GPU that composes cannot be opened for copies; see `entoptic doctor`");
    const float priority = 1;
    VkDeviceQueueCreateInfo queue{};
    queue.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO;
    queue.queueFamilyIndex = queue_family_ = graphics_family(physical_);
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    const char* const extensions[] = {VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME};
    VkDeviceCreateInfo device{};
    device.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO;
    device.queueCreateInfoCount = 1;
    device.pQueueCreateInfos = &queue;
    device.enabledExtensionCount = 1;
    device.ppEnabledExtensionNames = extensions;
    if (VkResult result = vkCreateDevice(physical_, &device, nullptr, &device_); result != VK_SUCCESS)
        return failed("vkCreateDevice", result);
    if (!functions_.load(instance_functions_.GetDeviceProcAddr, device_))
        return error(XR_ERROR_RUNTIME_FAILURE, "the GPU that composes lacks functions of Vulkan 1.0");
    functions_.GetDeviceQueue(device_, queue.queueFamilyIndex, 0, &queue_);
    VkCommandPoolCreateInfo pool{};
    pool.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO;
    pool.queueFamilyIndex = queue.queueFamilyIndex;
    const VkResult result = vkCreateCommandPool(device_, &pool, nullptr, &pool_);
    return result == VK_SUCCESS ? Outcome() : failed("vkCreateCommandPool", result);
}

CopyDevice::~CopyDevice() {
    if (pool_) vkDestroyCommandPool(device_, pool_, nullptr);
    if (device_) vkDestroyDevice(device_, nullptr);
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

std::uint32_t CopyDevice::host_memory_type(std::uint32_t bits) const {
    VkPhysicalDeviceMemoryProperties properties{};
    vkGetPhysicalDeviceMemoryProperties(physical_, &properties);
    constexpr VkMemoryPropertyFlags wanted = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    for (std::uint32_t i = 0; i < properties.memoryTypeCount; ++i) {
        if ((bits & (1u << i)) != 0 && (properties.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    }
    return 32;
}

Outcome CopyDevice::submit(VkCommandBuffer commands, VkFence fence) {
    VkSubmitInfo info{};
    info.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO;
    info.commandBufferCount = 1;
    info.pCommandBuffers = &commands;
    const std::lock_guard lock(queue_mutex_);
    const VkResult result = vkQueueSubmit(queue_, 1, &info, fence);
    return result == VK_SUCCESS ? Outcome() : failed("vkQueueSubmit", result);
}

CopiedImage::CopiedImage(std::shared_ptr<CopyDevice> device, const ImageMemory& memory, std::uint32_t texel_bytes,
                         VkImageAspectFlags aspect)
    : device_(std::move(device)), format_(static_cast<VkFormat>(memory.vk_format)), texel_bytes_(texel_bytes) {
    for (std::uint32_t i = 0; i < memory.mip_levels; ++i) {
        VkBufferImageCopy region{};
        region.bufferOffset = (buffer_size_ + level_alignment - 1) / level_alignment * level_alignment;
        region.imageSubresource = {aspect, i, 0, memory.array_layers};
        region.imageExtent = {std::max(memory.width >> i, 1u), std::max(memory.height >> i, 1u), 1};
        buffer_size_ = region.bufferOffset + level_size(region, texel_bytes);
        regions_.push_back(region);
    }
}

CopiedImage::~CopiedImage() {
    const VkDevice device = device_->device();
    if (pending_) vkWaitForFences(device, 1, &sent_, VK_TRUE, UINT64_MAX);
    if (sent_) vkDestroyFence(device, sent_, nullptr);
    if (commands_) vkFreeCommandBuffers(device, device_->pool(), 1, &commands_);
    if (buffer_) vkDestroyBuffer(device, buffer_, nullptr);
    if (buffer_memory_) vkFreeMemory(device, buffer_memory_, nullptr);
    if (image_) vkDestroyImage(device, image_, nullptr);
    if (image_memory_) vkFreeMemory(device, image_memory_, nullptr);
}

Outcome CopiedImage::import(ImageMemory& memory) {
    ENTOPTIC_XR_TRY(import_image(device_->functions(), device_->device(), memory, image_, image_memory_));
    ENTOPTIC_XR_TRY(make_buffer());
    const VkFenceCreateInfo info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
    if (VkResult result = vkCreateFence(device_->device(), &info, nullptr, &sent_); result != VK_SUCCESS)
        return failed("vkCreateFence", result);
    return record();
}

Outcome CopiedImage::make_buffer() {
    const VkDevice device = device_->device();
    VkBufferCreateInfo info{};
    info.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO;
    info.size = buffer_size_;
    info.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT;
    if (VkResult result = vkCreateBuffer(device, &info, nullptr, &buffer_); result != VK_SUCCESS) return failed("vkCreateBuffer", result);
    VkMemoryRequirements requirements{};
    vkGetBufferMemoryRequirements(device, buffer_, &requirements);
    VkMemoryAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO;
    allocate.allocationSize = requirements.size;
    allocate.memoryTypeIndex = device_->host_memory_type(requirements.memoryTypeBits);
    if (allocate.memoryTypeIndex == 32)
        return error(XR_ERROR_RUNTIME_FAILURE, "the GPU that composes has no memory that the CPU can write");
    VkResult result = vkAllocateMemory(device, &allocate, nullptr, &buffer_memory_);
    if (result == VK_SUCCESS) result = vkBindBufferMemory(device, buffer_, buffer_memory_, 0);
    void* mapped = nullptr;
    if (result == VK_SUCCESS) result = vkMapMemory(device, buffer_memory_, 0, VK_WHOLE_SIZE, 0, &mapped);
    mapped_ = static_cast<std::byte*>(mapped);
    return result == VK_SUCCESS ? Outcome() : failed("the memory of an image's copy", result);
}

// The whole image is written anew: what it held before is of no use, and the compositor has done with it.
Outcome CopiedImage::record() {
    const VkDevice device = device_->device();
    VkCommandBufferAllocateInfo allocate{};
    allocate.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO;
    allocate.commandPool = device_->pool();
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    VkResult result = vkAllocateCommandBuffers(device, &allocate, &commands_);
    if (result != VK_SUCCESS) return failed("vkAllocateCommandBuffers", result);
    VkCommandBufferBeginInfo begin{};
    begin.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO;
    if (result = vkBeginCommandBuffer(commands_, &begin); result != VK_SUCCESS) return failed("vkBeginCommandBuffer", result);
    VkImageMemoryBarrier barrier{};
    barrier.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER;
    barrier.image = image_;
    barrier.subresourceRange = {aspect_of(format_), 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
    barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr, 1,
                         &barrier);
    vkCmdCopyBufferToImage(commands_, buffer_, image_, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, static_cast<std::uint32_t>(regions_.size()),
                           regions_.data());
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = 0;
    barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;  // compositor/images.h: how an image is handed over
    barrier.srcQueueFamilyIndex = device_->queue_family();
    barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_EXTERNAL;
    vkCmdPipelineBarrier(commands_, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, 0, 0, nullptr, 0, nullptr, 1,
                         &barrier);
    result = vkEndCommandBuffer(commands_);
    return result == VK_SUCCESS ? Outcome() : failed("vkEndCommandBuffer", result);
}

std::span<std::byte> CopiedImage::level(std::uint32_t level) const {
    const VkBufferImageCopy& region = regions_.at(level);
    return {mapped_ + region.bufferOffset, static_cast<std::size_t>(level_size(region, texel_bytes_))};
}

Outcome CopiedImage::send() {
    ENTOPTIC_XR_TRY(wait());
    if (VkResult result = vkResetFences(device_->device(), 1, &sent_); result != VK_SUCCESS) return failed("vkResetFences", result);
    ENTOPTIC_XR_TRY(device_->submit(commands_, sent_));
    pending_ = true;
    return XR_SUCCESS;
}

Outcome CopiedImage::wait() {
    if (!pending_) return XR_SUCCESS;
    const VkResult result = vkWaitForFences(device_->device(), 1, &sent_, VK_TRUE, longest_gpu_wait_ns);
    if (result != VK_SUCCESS) return failed("the wait for an image's copy", result);
    pending_ = false;
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
