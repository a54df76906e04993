#include "runtime/graphics/vulkan_openxr.h"

#include "runtime/graphics/vulkan_functions.h"

#include "base/log.h"
#include "runtime/api/call.h"
#include "runtime/api/verify.h"
#include "runtime/graphics/vulkan_device.h"

#include <algorithm>
#include <cstring>

namespace entoptic::runtime::graphics {

namespace {

using api::call;
using api::check_system;
using api::find;
using api::require;
using api::require_pointer;

template <std::size_t size> std::string joined(const std::array<const char*, size>& names) {
    std::string text;
    for (const char* name : names) text += (text.empty() ? "" : " ") + std::string(name);
    return text;
}

// The application's names and those of ours that `available` holds and the application did not name.
template <std::size_t size>
std::vector<const char*> merged(const char* const* names, std::uint32_t count, const std::array<const char*, size>& ours,
                                const std::vector<VkExtensionProperties>& available) {
    std::vector<const char*> all(names, names + count);
    const auto same = [](const char* a) { return [a](const char* b) { return std::strcmp(a, b) == 0; }; };
    for (const char* name : ours) {
        const bool there =
            std::any_of(available.begin(), available.end(), [&](const auto& found) { return same(name)(found.extensionName); });
        if (there && std::none_of(all.begin(), all.end(), same(name))) all.push_back(name);
    }
    return all;
}

template <class Enumerate> std::vector<VkExtensionProperties> available_extensions(Enumerate&& enumerate) {
    std::uint32_t count = 0;
    enumerate(&count, nullptr);
    std::vector<VkExtensionProperties> properties(count);
    enumerate(&count, properties.data());
    properties.resize(count);
    return properties;
}

Outcome find_system_instance(XrInstance handle, XrSystemId system, std::shared_ptr<Instance>& instance) {
    ENTOPTIC_XR_TRY(find(handle, instance));
    return check_system(system);
}

Outcome find_graphics_device(Instance& instance, VkInstance vk_instance, VkPhysicalDevice* device) {
    if (!vk_instance) return invalid("the VkInstance is null");
    InstanceDispatch dispatch;
    if (!dispatch.load(instance_proc_addr(instance), vk_instance)) {
        return invalid("the VkInstance lacks {}; enable what xrGetVulkanInstanceExtensionsKHR lists", joined(instance_extensions));
    }
    *device = find_physical_device(dispatch, vk_instance, instance.host().frames().device_uuid());
    instance.vk_instance = vk_instance;
    if (!*device) return error(XR_ERROR_RUNTIME_FAILURE, "the GPU that composes is not among the application's; see `entoptic doctor`");
    return XR_SUCCESS;
}

Outcome requirements(Instance& instance, XrGraphicsRequirementsVulkanKHR* out) {
    ENTOPTIC_XR_TRY(require(out, XR_TYPE_GRAPHICS_REQUIREMENTS_VULKAN_KHR, "graphicsRequirements"));
    out->minApiVersionSupported = XR_MAKE_VERSION(1, 0, 0);
    out->maxApiVersionSupported = XR_MAKE_VERSION(1, 3, 0);
    instance.note_graphics_requirements(GraphicsApi::vulkan);
    return XR_SUCCESS;
}

Outcome extension_list(XrInstance handle, XrSystemId system, uint32_t capacity, uint32_t* count, char* buffer, const std::string& list) {
    std::shared_ptr<Instance> instance;
    ENTOPTIC_XR_TRY(find_system_instance(handle, system, instance));
    return api::two_call_string(capacity, count, buffer, list);
}

XrResult XRAPI_CALL get_vulkan_instance_extensions(XrInstance handle, XrSystemId system, uint32_t capacity, uint32_t* count, char* buffer) {
    return call("xrGetVulkanInstanceExtensionsKHR", handle,
                [&] { return extension_list(handle, system, capacity, count, buffer, joined(instance_extensions)); });
}

XrResult XRAPI_CALL get_vulkan_device_extensions(XrInstance handle, XrSystemId system, uint32_t capacity, uint32_t* count, char* buffer) {
    return call("xrGetVulkanDeviceExtensionsKHR", handle,
                [&] { return extension_list(handle, system, capacity, count, buffer, joined(device_extensions)); });
}

XrResult XRAPI_CALL get_vulkan_graphics_device(XrInstance handle, XrSystemId system, VkInstance vk_instance, VkPhysicalDevice* device) {
    return call("xrGetVulkanGraphicsDeviceKHR", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find_system_instance(handle, system, instance));
        ENTOPTIC_XR_TRY(require_pointer(device, "vkPhysicalDevice"));
        return find_graphics_device(*instance, vk_instance, device);
    });
}

XrResult XRAPI_CALL get_vulkan_graphics_device2(XrInstance handle, const XrVulkanGraphicsDeviceGetInfoKHR* info, VkPhysicalDevice* device) {
    return call("xrGetVulkanGraphicsDevice2KHR", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find(handle, instance));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_VULKAN_GRAPHICS_DEVICE_GET_INFO_KHR, "getInfo"));
        ENTOPTIC_XR_TRY(check_system(info->systemId));
        ENTOPTIC_XR_TRY(require_pointer(device, "vulkanPhysicalDevice"));
        return find_graphics_device(*instance, info->vulkanInstance, device);
    });
}

XrResult XRAPI_CALL get_vulkan_graphics_requirements(XrInstance handle, XrSystemId system, XrGraphicsRequirementsVulkanKHR* out) {
    return call("xrGetVulkanGraphicsRequirementsKHR", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find_system_instance(handle, system, instance));
        return requirements(*instance, out);
    });
}

XrResult XRAPI_CALL get_vulkan_graphics_requirements2(XrInstance handle, XrSystemId system, XrGraphicsRequirementsVulkanKHR* out) {
    return call("xrGetVulkanGraphicsRequirements2KHR", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(find_system_instance(handle, system, instance));
        return requirements(*instance, out);
    });
}

// What both create functions of XR_KHR_vulkan_enable2 check first.
template <class CreateInfo>
Outcome check_create(XrInstance handle, const CreateInfo* info, XrStructureType type, const void* out, const void* result,
                     std::shared_ptr<Instance>& instance) {
    ENTOPTIC_XR_TRY(find(handle, instance));
    ENTOPTIC_XR_TRY(require(info, type, "createInfo"));
    ENTOPTIC_XR_TRY(check_system(info->systemId));
    if (info->createFlags != 0) return invalid("createInfo->createFlags must be 0");
    if (!info->pfnGetInstanceProcAddr) return invalid("createInfo->pfnGetInstanceProcAddr is null");
    ENTOPTIC_XR_TRY(require_pointer(info->vulkanCreateInfo, "createInfo->vulkanCreateInfo"));
    ENTOPTIC_XR_TRY(require_pointer(out, "the output handle"));
    return require_pointer(result, "vulkanResult");
}

XrResult XRAPI_CALL create_vulkan_instance(XrInstance handle, const XrVulkanInstanceCreateInfoKHR* info, VkInstance* vk_instance,
                                           VkResult* vk_result) {
    return call("xrCreateVulkanInstanceKHR", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(check_create(handle, info, XR_TYPE_VULKAN_INSTANCE_CREATE_INFO_KHR, vk_instance, vk_result, instance));
        const PFN_vkGetInstanceProcAddr get = info->pfnGetInstanceProcAddr;
        const auto create = reinterpret_cast<PFN_vkCreateInstance>(get(VK_NULL_HANDLE, "vkCreateInstance"));
        const auto enumerate =
            reinterpret_cast<PFN_vkEnumerateInstanceExtensionProperties>(get(VK_NULL_HANDLE, "vkEnumerateInstanceExtensionProperties"));
        if (!create || !enumerate) return invalid("pfnGetInstanceProcAddr does not know vkCreateInstance");
        const auto available =
            available_extensions([&](std::uint32_t* count, VkExtensionProperties* out) { enumerate(nullptr, count, out); });
        VkInstanceCreateInfo merged_info = *info->vulkanCreateInfo;
        const auto names = merged(merged_info.ppEnabledExtensionNames, merged_info.enabledExtensionCount, instance_extensions, available);
        merged_info.enabledExtensionCount = static_cast<std::uint32_t>(names.size());
        merged_info.ppEnabledExtensionNames = names.data();
        *vk_result = create(&merged_info, info->vulkanAllocator, vk_instance);
        if (*vk_result == VK_SUCCESS) {
            instance->vk_get_instance_proc_addr = reinterpret_cast<void*>(get);
            instance->vk_instance = *vk_instance;
        }
        return XR_SUCCESS;  // the application reads vulkanResult
    });
}

XrResult XRAPI_CALL create_vulkan_device(XrInstance handle, const XrVulkanDeviceCreateInfoKHR* info, VkDevice* device,
                                         VkResult* vk_result) {
    return call("xrCreateVulkanDeviceKHR", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(check_create(handle, info, XR_TYPE_VULKAN_DEVICE_CREATE_INFO_KHR, device, vk_result, instance));
        if (!info->vulkanPhysicalDevice) return invalid("createInfo->vulkanPhysicalDevice is null");
        const auto vk_instance = static_cast<VkInstance>(instance->vk_instance.load());
        if (!vk_instance) return invalid("no VkInstance was made with xrCreateVulkanInstanceKHR before");
        const PFN_vkGetInstanceProcAddr get = info->pfnGetInstanceProcAddr;
        const auto create = reinterpret_cast<PFN_vkCreateDevice>(get(vk_instance, "vkCreateDevice"));
        const auto enumerate =
            reinterpret_cast<PFN_vkEnumerateDeviceExtensionProperties>(get(vk_instance, "vkEnumerateDeviceExtensionProperties"));
        if (!create || !enumerate) return invalid("pfnGetInstanceProcAddr does not know vkCreateDevice");
        const auto available = available_extensions(
            [&](std::uint32_t* count, VkExtensionProperties* out) { enumerate(info->vulkanPhysicalDevice, nullptr, count, out); });
        VkDeviceCreateInfo merged_info = *info->vulkanCreateInfo;
        const auto names = merged(merged_info.ppEnabledExtensionNames, merged_info.enabledExtensionCount, device_extensions, available);
        merged_info.enabledExtensionCount = static_cast<std::uint32_t>(names.size());
        merged_info.ppEnabledExtensionNames = names.data();
        *vk_result = create(info->vulkanPhysicalDevice, &merged_info, info->vulkanAllocator, device);
        return XR_SUCCESS;
    });
}

template <class Function> PFN_xrVoidFunction erased(Function function) { return reinterpret_cast<PFN_xrVoidFunction>(function); }

constexpr const char* enable = XR_KHR_VULKAN_ENABLE_EXTENSION_NAME;
constexpr const char* enable2 = XR_KHR_VULKAN_ENABLE2_EXTENSION_NAME;

const FunctionEntry entries[] = {
    {"xrGetVulkanInstanceExtensionsKHR", enable, erased<PFN_xrGetVulkanInstanceExtensionsKHR>(get_vulkan_instance_extensions)},
    {"xrGetVulkanDeviceExtensionsKHR", enable, erased<PFN_xrGetVulkanDeviceExtensionsKHR>(get_vulkan_device_extensions)},
    {"xrGetVulkanGraphicsDeviceKHR", enable, erased<PFN_xrGetVulkanGraphicsDeviceKHR>(get_vulkan_graphics_device)},
    {"xrGetVulkanGraphicsRequirementsKHR", enable, erased<PFN_xrGetVulkanGraphicsRequirementsKHR>(get_vulkan_graphics_requirements)},
    {"xrCreateVulkanInstanceKHR", enable2, erased<PFN_xrCreateVulkanInstanceKHR>(create_vulkan_instance)},
    {"xrCreateVulkanDeviceKHR", enable2, erased<PFN_xrCreateVulkanDeviceKHR>(create_vulkan_device)},
    {"xrGetVulkanGraphicsDevice2KHR", enable2, erased<PFN_xrGetVulkanGraphicsDevice2KHR>(get_vulkan_graphics_device2)},
    {"xrGetVulkanGraphicsRequirements2KHR", enable2, erased<PFN_xrGetVulkanGraphicsRequirements2KHR>(get_vulkan_graphics_requirements2)},
};

Outcome device_invalid(const char* why) { return error(XR_ERROR_GRAPHICS_DEVICE_INVALID, "{}", why); }

// Checks the binding against the GPU that composes, and loads everything.
Outcome fill_context(Instance& instance, const XrGraphicsBindingVulkanKHR& binding, VulkanContext& context) {
    if (!binding.instance || !binding.physicalDevice || !binding.device) return device_invalid("the Vulkan binding holds a null handle");
    const PFN_vkGetInstanceProcAddr get = instance_proc_addr(instance);
    if (!context.instance_functions.load(get, binding.instance))
        return device_invalid("the VkInstance lacks the extensions this runtime lists");
    context.device_uuid = instance.host().frames().device_uuid();
    if (find_physical_device(context.instance_functions, binding.instance, context.device_uuid) != binding.physicalDevice) {
        return device_invalid("the VkPhysicalDevice is not the one xrGetVulkanGraphicsDevice names");
    }
    std::uint32_t count = 0;
    context.instance_functions.GetPhysicalDeviceQueueFamilyProperties(binding.physicalDevice, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    context.instance_functions.GetPhysicalDeviceQueueFamilyProperties(binding.physicalDevice, &count, families.data());
    if (binding.queueFamilyIndex >= count || binding.queueIndex >= families[binding.queueFamilyIndex].queueCount) {
        return device_invalid("the device has no queue of that family and index");
    }
    if (!context.functions.load(context.instance_functions.GetDeviceProcAddr, binding.device)) {
        return device_invalid("the VkDevice lacks functions of Vulkan 1.0");
    }
    context.physical_device = binding.physicalDevice;
    context.device = binding.device;
    context.queue_family = binding.queueFamilyIndex;
    context.functions.GetDeviceQueue(binding.device, binding.queueFamilyIndex, binding.queueIndex, &context.queue);
    return context.queue ? Outcome() : device_invalid("the device was created without that queue");
}

}  // namespace

std::span<const FunctionEntry> vulkan_functions() { return entries; }

bool has_vulkan_binding(const void* chain) { return api::find_in_chain(chain, XR_TYPE_GRAPHICS_BINDING_VULKAN_KHR) != nullptr; }

Outcome make_vulkan_device(Instance& instance, const void* chain, std::unique_ptr<GraphicsDevice>& device) {
    const auto* binding = api::chained<XrGraphicsBindingVulkanKHR>(chain, XR_TYPE_GRAPHICS_BINDING_VULKAN_KHR);
    const bool enabled = instance.enabled(enable) || instance.enabled(enable2);
    if (!binding || !enabled) {
        return device_invalid("no graphics binding: enable XR_KHR_vulkan_enable2 and chain XrGraphicsBindingVulkan2KHR");
    }
    if (!instance.graphics_requirements_asked(GraphicsApi::vulkan)) {
        return error(XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING,
                     "call xrGetVulkanGraphicsRequirements2KHR (or KHR) before xrCreateSession");
    }
    auto context = std::make_shared<VulkanContext>();
    ENTOPTIC_XR_TRY(fill_context(instance, *binding, *context));
    device = std::make_unique<VulkanDevice>(std::move(context));
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
