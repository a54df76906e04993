// The Vulkan device Entoptic computes on: one instance, one device, one compute-capable queue, used from one thread at a time.
// Thin on purpose: vulkan.h types are visible, nothing is guessed, barriers are explicit.
#pragma once

#include "base/result.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>
#include <vulkan/vulkan.h>

namespace entoptic::gpu {

struct DeviceOptions {
    bool validation = false;                      // Khronos validation layer with synchronization validation
    bool windows = false;                         // surface and swapchain extensions, when the platform has them
    std::string prefer_device;                    // part of a device name; empty: discrete, integrated, virtual, CPU in this order
};

class Device {
public:
    // Errors: ErrorKind::missing with what to install when there is no Vulkan driver or it lacks a feature.
    static Result<std::unique_ptr<Device>> create(const DeviceOptions& options);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;

    VkInstance instance() const { return instance_; }
    VkPhysicalDevice physical() const { return physical_; }
    VkDevice handle() const { return device_; }
    std::uint32_t queue_family() const { return queue_family_; }
    VkQueue queue() const { return queue_; }
    std::mutex& queue_mutex() { return queue_mutex_; }       // hold it around vkQueueSubmit, vkQueuePresentKHR and vkQueueWaitIdle

    const std::string& name() const { return name_; }        // "llvmpipe (LLVM 15.0.6, 256 bits)"
    const std::string& driver() const { return driver_; }    // "llvmpipe Mesa 22.3.6"
    bool is_software() const { return software_; }
    bool has_windows() const { return windows_; }
    bool can_export_memory() const { return external_memory_; }
    double timestamp_period_ns() const { return timestamp_period_ns_; }   // 0: no timestamps
    std::uint32_t max_workgroup_count() const { return 65535; }           // guaranteed in each dimension
    const std::array<std::uint8_t, 16>& device_uuid() const { return device_uuid_; }
    const std::array<std::uint8_t, 16>& driver_uuid() const { return driver_uuid_; }

    // Index of a memory type with all `wanted` flags among `type_bits`, or an error.
    Result<std::uint32_t> memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags wanted) const;

    // Validation messages (warnings and errors) since the start; tests require 0.
    std::uint32_t validation_messages() const { return validation_messages_; }

    void set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const;

private:
    Device() = default;
    Result<void> create_instance(const DeviceOptions& options);
    Result<void> choose_physical(const DeviceOptions& options);
    Result<void> create_device(const DeviceOptions& options);
    static VkBool32 VKAPI_PTR on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                         const VkDebugUtilsMessengerCallbackDataEXT*, void*);

    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    std::uint32_t queue_family_ = 0;
    VkQueue queue_ = VK_NULL_HANDLE;
    std::mutex queue_mutex_;
    VkPhysicalDeviceMemoryProperties memory_{};
    std::string name_, driver_;
    bool software_ = false, windows_ = false, external_memory_ = false, debug_utils_ = false;
    double timestamp_period_ns_ = 0;
    std::array<std::uint8_t, 16> device_uuid_{}, driver_uuid_{};
    std::atomic<std::uint32_t> validation_messages_{0};
    PFN_vkSetDebugUtilsObjectNameEXT set_object_name_ = nullptr;
};

// "vkCreateBuffer failed: out of device memory (VK_ERROR_OUT_OF_DEVICE_MEMORY)"
Error vulkan_error(const char* call, VkResult result);
// Evaluates a Vulkan call; returns its failure from a function that returns Result.
#define ENTOPTIC_VK(call)                                                                                                  \
    if (const VkResult entoptic_vk_result = (call); entoptic_vk_result != VK_SUCCESS)                                      \
    return ::entoptic::forward_error(::entoptic::gpu::vulkan_error(#call, entoptic_vk_result))

}  // namespace entoptic::gpu
