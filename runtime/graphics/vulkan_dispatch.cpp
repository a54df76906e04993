#include "runtime/graphics/vulkan_dispatch.h"

#include <cstring>

extern "C" VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetInstanceProcAddr(VkInstance instance, const char* name);

namespace entoptic::runtime::graphics {

const std::array<const char*, 2> instance_extensions{VK_KHR_GET_PHYSICAL_DEVICE_PROPERTIES_2_EXTENSION_NAME,
                                                     VK_KHR_EXTERNAL_MEMORY_CAPABILITIES_EXTENSION_NAME};
const std::array<const char*, 4> device_extensions{VK_KHR_EXTERNAL_MEMORY_EXTENSION_NAME, VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME,
                                                   VK_KHR_GET_MEMORY_REQUIREMENTS_2_EXTENSION_NAME,
                                                   VK_KHR_DEDICATED_ALLOCATION_EXTENSION_NAME};

bool InstanceDispatch::load(PFN_vkGetInstanceProcAddr get, VkInstance instance) {
    bool complete = true;
    const auto one = [&](auto& function, const char* name) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(get(instance, name));
        complete &= function != nullptr;
    };
    one(EnumeratePhysicalDevices, "vkEnumeratePhysicalDevices");
    one(GetPhysicalDeviceImageFormatProperties, "vkGetPhysicalDeviceImageFormatProperties");
    one(GetPhysicalDeviceQueueFamilyProperties, "vkGetPhysicalDeviceQueueFamilyProperties");
    one(EnumerateDeviceExtensionProperties, "vkEnumerateDeviceExtensionProperties");
    one(GetDeviceProcAddr, "vkGetDeviceProcAddr");
    // The KHR name first: an instance of version 1.0 has no other, and calling the core one there is an error.
    const auto khr = get(instance, "vkGetPhysicalDeviceProperties2KHR");
    GetPhysicalDeviceProperties2 =
        reinterpret_cast<PFN_vkGetPhysicalDeviceProperties2>(khr ? khr : get(instance, "vkGetPhysicalDeviceProperties2"));
    return complete && GetPhysicalDeviceProperties2;
}

bool DeviceDispatch::load(PFN_vkGetDeviceProcAddr get, VkDevice device) {
    bool complete = true;
    const auto one = [&](auto& function, const char* name) {
        function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(get(device, name));
        complete &= function != nullptr;
    };
    one(GetDeviceQueue, "vkGetDeviceQueue");
    one(CreateImage, "vkCreateImage");
    one(DestroyImage, "vkDestroyImage");
    one(GetImageMemoryRequirements, "vkGetImageMemoryRequirements");
    one(AllocateMemory, "vkAllocateMemory");
    one(FreeMemory, "vkFreeMemory");
    one(BindImageMemory, "vkBindImageMemory");
    one(CreateCommandPool, "vkCreateCommandPool");
    one(DestroyCommandPool, "vkDestroyCommandPool");
    one(AllocateCommandBuffers, "vkAllocateCommandBuffers");
    one(BeginCommandBuffer, "vkBeginCommandBuffer");
    one(EndCommandBuffer, "vkEndCommandBuffer");
    one(CmdPipelineBarrier, "vkCmdPipelineBarrier");
    one(QueueSubmit, "vkQueueSubmit");
    one(CreateFence, "vkCreateFence");
    one(DestroyFence, "vkDestroyFence");
    one(ResetFences, "vkResetFences");
    one(WaitForFences, "vkWaitForFences");
    return complete;
}

PFN_vkGetInstanceProcAddr instance_proc_addr(Instance& instance) {
    void* given = instance.vk_get_instance_proc_addr.load();
    return given ? reinterpret_cast<PFN_vkGetInstanceProcAddr>(given) : &vkGetInstanceProcAddr;
}

VkPhysicalDevice find_physical_device(const InstanceDispatch& dispatch, VkInstance vk_instance, const std::array<std::uint8_t, 16>& uuid) {
    std::uint32_t count = 0;
    if (dispatch.EnumeratePhysicalDevices(vk_instance, &count, nullptr) != VK_SUCCESS) return VK_NULL_HANDLE;
    std::vector<VkPhysicalDevice> devices(count);
    const VkResult result = dispatch.EnumeratePhysicalDevices(vk_instance, &count, devices.data());
    if (result != VK_SUCCESS && result != VK_INCOMPLETE) return VK_NULL_HANDLE;
    devices.resize(count);
    for (VkPhysicalDevice device : devices) {
        VkPhysicalDeviceIDProperties id{};
        id.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES;
        VkPhysicalDeviceProperties2 properties{};
        properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
        properties.pNext = &id;
        dispatch.GetPhysicalDeviceProperties2(device, &properties);
        if (std::memcmp(id.deviceUUID, uuid.data(), uuid.size()) == 0) return device;
    }
    return VK_NULL_HANDLE;
}

}  // namespace entoptic::runtime::graphics
