// Vulkan entry points of the application's own instance and device, through its own vkGetInstanceProcAddr when it gave one.
#pragma once

#include "runtime/graphics/vulkan_openxr.h"

#include "runtime/objects/instance.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace entoptic::runtime::graphics {

struct InstanceDispatch {
    // Null members: the instance lacks them.
    PFN_vkEnumeratePhysicalDevices EnumeratePhysicalDevices = nullptr;
    PFN_vkGetPhysicalDeviceProperties2 GetPhysicalDeviceProperties2 = nullptr;
    PFN_vkGetPhysicalDeviceImageFormatProperties GetPhysicalDeviceImageFormatProperties = nullptr;
    PFN_vkGetPhysicalDeviceQueueFamilyProperties GetPhysicalDeviceQueueFamilyProperties = nullptr;
    PFN_vkEnumerateDeviceExtensionProperties EnumerateDeviceExtensionProperties = nullptr;
    PFN_vkGetDeviceProcAddr GetDeviceProcAddr = nullptr;

    bool load(PFN_vkGetInstanceProcAddr get, VkInstance instance);  // false when one is missing
};

struct DeviceDispatch {
    PFN_vkGetDeviceQueue GetDeviceQueue = nullptr;
    PFN_vkCreateImage CreateImage = nullptr;
    PFN_vkDestroyImage DestroyImage = nullptr;
    PFN_vkGetImageMemoryRequirements GetImageMemoryRequirements = nullptr;
    PFN_vkAllocateMemory AllocateMemory = nullptr;
    PFN_vkFreeMemory FreeMemory = nullptr;
    PFN_vkBindImageMemory BindImageMemory = nullptr;
    PFN_vkCreateCommandPool CreateCommandPool = nullptr;
    PFN_vkDestroyCommandPool DestroyCommandPool = nullptr;
    PFN_vkAllocateCommandBuffers AllocateCommandBuffers = nullptr;
    PFN_vkBeginCommandBuffer BeginCommandBuffer = nullptr;
    PFN_vkEndCommandBuffer EndCommandBuffer = nullptr;
    PFN_vkCmdPipelineBarrier CmdPipelineBarrier = nullptr;
    PFN_vkQueueSubmit QueueSubmit = nullptr;
    PFN_vkCreateFence CreateFence = nullptr;
    PFN_vkDestroyFence DestroyFence = nullptr;
    PFN_vkResetFences ResetFences = nullptr;
    PFN_vkWaitForFences WaitForFences = nullptr;

    bool load(PFN_vkGetDeviceProcAddr get, VkDevice device);
};

// The application's own, else the linked loader's.
PFN_vkGetInstanceProcAddr instance_proc_addr(Instance& instance);

// Extensions the application's device and instance need for images on file descriptors.
extern const std::array<const char*, 2> instance_extensions;
extern const std::array<const char*, 4> device_extensions;

// The physical device of `vk_instance` with this UUID; null when there is none.
VkPhysicalDevice find_physical_device(const InstanceDispatch& dispatch, VkInstance vk_instance, const std::array<std::uint8_t, 16>& uuid);

}  // namespace entoptic::runtime::graphics
