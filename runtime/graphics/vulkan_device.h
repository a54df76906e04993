// The application's Vulkan device and queue, as xrCreateSession got them.
#pragma once

#include "runtime/graphics/image_request.h"
#include "runtime/graphics/vulkan_dispatch.h"

#include "runtime/objects/graphics.h"

#include <memory>
#include <mutex>

namespace entoptic::runtime::graphics {

// What images share. Outlives the device object while images exist; the application keeps the VkDevice itself alive.
struct VulkanContext {
    InstanceDispatch instance_functions;
    DeviceDispatch functions;
    VkPhysicalDevice physical_device = VK_NULL_HANDLE;
    VkDevice device = VK_NULL_HANDLE;
    std::uint32_t queue_family = 0;
    VkQueue queue = VK_NULL_HANDLE;
    std::array<std::uint8_t, 16> device_uuid{};
    // The specification makes the application keep its own work off the queue during the calls that use it; this orders our own.
    std::mutex queue_mutex;
};

class VulkanDevice final : public GraphicsDevice {
public:
    explicit VulkanDevice(std::shared_ptr<VulkanContext> context) : context_(std::move(context)) {}
    std::vector<std::int64_t> formats(const std::vector<std::int64_t>& compositor) const override { return compositor; }
    Outcome describe(const XrSwapchainCreateInfo& info, SwapchainRequest& request) const override;
    Outcome import(SwapchainAllocation allocation, std::unique_ptr<SwapchainImages>& images) override;

private:
    std::shared_ptr<VulkanContext> context_;
};

}  // namespace entoptic::runtime::graphics
