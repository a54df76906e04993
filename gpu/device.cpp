#include "gpu/device.h"

#include "base/log.h"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <string_view>

namespace entoptic::gpu {
namespace {

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";

std::vector<VkExtensionProperties> instance_extensions() {
    std::uint32_t count = 0;
    vkEnumerateInstanceExtensionProperties(nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> list(count);
    vkEnumerateInstanceExtensionProperties(nullptr, &count, list.data());
    return list;
}

std::vector<VkExtensionProperties> device_extensions(VkPhysicalDevice physical) {
    std::uint32_t count = 0;
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
    std::vector<VkExtensionProperties> list(count);
    vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, list.data());
    return list;
}

bool contains(const std::vector<VkExtensionProperties>& list, std::string_view name) {
    return std::any_of(list.begin(), list.end(), [&](const auto& e) { return name == e.extensionName; });
}

bool has_layer(std::string_view name) {
    std::uint32_t count = 0;
    vkEnumerateInstanceLayerProperties(&count, nullptr);
    std::vector<VkLayerProperties> list(count);
    vkEnumerateInstanceLayerProperties(&count, list.data());
    return std::any_of(list.begin(), list.end(), [&](const auto& e) { return name == e.layerName; });
}

int preference(VkPhysicalDeviceType type) {
    switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU: return 4;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU: return 3;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU: return 2;
    case VK_PHYSICAL_DEVICE_TYPE_CPU: return 1;
    default: return 0;
    }
}

}  // namespace

Error vulkan_error(const char* call, VkResult result) {
    std::string name(call);
    name = name.substr(0, name.find('('));
    const char* meaning = "error";
    switch (result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY: meaning = "out of host memory"; break;
    case VK_ERROR_OUT_OF_DEVICE_MEMORY: meaning = "out of device memory; try a smaller --panel or --eye-scale"; break;
    case VK_ERROR_DEVICE_LOST: meaning = "the device was lost; look for driver messages in the kernel log"; break;
    case VK_ERROR_INITIALIZATION_FAILED: meaning = "initialisation failed"; break;
    case VK_ERROR_EXTENSION_NOT_PRESENT: meaning = "an extension is not present"; break;
    case VK_ERROR_FEATURE_NOT_PRESENT: meaning = "a feature is not present"; break;
    case VK_ERROR_INCOMPATIBLE_DRIVER: meaning = "no compatible Vulkan driver"; break;
    default: break;
    }
    return Error{ErrorKind::failed, fmt::format("{} failed: {} (VkResult {})", name, meaning, static_cast<int>(result))};
}

Result<std::unique_ptr<Device>> Device::create(const DeviceOptions& options) {
    std::unique_ptr<Device> device(new Device());
    ENTOPTIC_CHECK(device->create_instance(options));
    ENTOPTIC_CHECK(device->choose_physical(options));
    ENTOPTIC_CHECK(device->create_device(options));
    return device;
}

Result<void> Device::create_instance(const DeviceOptions& options) {
    std::vector<const char*> extensions, layers;
    const auto available = instance_extensions();
    bool validation = options.validation;
    if (validation && !has_layer(validation_layer))
        return missing("The Vulkan validation layer is not installed. Install the package vulkan-validationlayers.");
    debug_utils_ = validation || contains(available, VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    if (debug_utils_) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
    if (validation) layers.push_back(validation_layer);
    if (options.windows && contains(available, "VK_KHR_surface") && contains(available, "VK_KHR_xcb_surface")) {
        windows_ = true;
        extensions.push_back("VK_KHR_surface");
        extensions.push_back("VK_KHR_xcb_surface");
    }
    VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    application.pApplicationName = "Entoptic";
    application.pEngineName = "Entoptic";
    application.apiVersion = VK_API_VERSION_1_2;

    const VkValidationFeatureEnableEXT synchronization = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
    features.enabledValidationFeatureCount = 1;
    features.pEnabledValidationFeatures = &synchronization;
    VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    messenger.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = &Device::on_message;
    messenger.pUserData = this;

    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    info.pApplicationInfo = &application;
    info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    info.enabledLayerCount = static_cast<std::uint32_t>(layers.size());
    info.ppEnabledLayerNames = layers.data();
    if (validation) info.pNext = &features;
    const VkResult result = vkCreateInstance(&info, nullptr, &instance_);
    if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
        return missing("No Vulkan driver was found. Install mesa-vulkan-drivers, or your GPU's own driver.");
    if (result != VK_SUCCESS) return forward_error(vulkan_error("vkCreateInstance", result));
    if (validation) {
        const auto create = reinterpret_cast<PFN_vkCreateDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(instance_, "vkCreateDebugUtilsMessengerEXT"));
        if (create) create(instance_, &messenger, nullptr, &messenger_);
    }
    return {};
}

Result<void> Device::choose_physical(const DeviceOptions& options) {
    std::uint32_t count = 0;
    vkEnumeratePhysicalDevices(instance_, &count, nullptr);
    std::vector<VkPhysicalDevice> list(count);
    vkEnumeratePhysicalDevices(instance_, &count, list.data());
    int best = -1;
    for (VkPhysicalDevice candidate : list) {
        VkPhysicalDeviceProperties properties{};
        vkGetPhysicalDeviceProperties(candidate, &properties);
        if (properties.apiVersion < VK_API_VERSION_1_2) continue;
        int rank = preference(properties.deviceType);
        if (!options.prefer_device.empty() && std::string_view(properties.deviceName).find(options.prefer_device) != std::string_view::npos) rank += 100;
        if (rank > best) {
            best = rank;
            physical_ = candidate;
        }
    }
    if (physical_ == VK_NULL_HANDLE)
        return missing("No Vulkan 1.2 device was found. Install mesa-vulkan-drivers (its lavapipe needs no GPU), or your GPU's own driver.");

    VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
    VkPhysicalDeviceIDProperties id{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES, &driver};
    VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &id};
    vkGetPhysicalDeviceProperties2(physical_, &properties);
    name_ = properties.properties.deviceName;
    driver_ = fmt::format("{} {}", driver.driverName, driver.driverInfo);
    software_ = properties.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    std::memcpy(device_uuid_.data(), id.deviceUUID, 16);
    std::memcpy(driver_uuid_.data(), id.driverUUID, 16);
    if (properties.properties.limits.maxComputeSharedMemorySize < 32768)  // the near field of glare holds a tile's surroundings there
        return missing(fmt::format("The device {} has {} bytes of shared memory for compute, and 32768 are needed.", properties.properties.deviceName,
                                   properties.properties.limits.maxComputeSharedMemorySize));
    timestamp_period_ns_ = static_cast<double>(properties.properties.limits.timestampPeriod);
    vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);

    std::uint32_t families = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &families, nullptr);
    std::vector<VkQueueFamilyProperties> queues(families);
    vkGetPhysicalDeviceQueueFamilyProperties(physical_, &families, queues.data());
    const VkQueueFlags wanted = VK_QUEUE_COMPUTE_BIT | (windows_ ? VkQueueFlags{VK_QUEUE_GRAPHICS_BIT} : 0u);   // blits to a window need graphics
    const auto family = std::find_if(queues.begin(), queues.end(), [&](const auto& q) { return (q.queueFlags & wanted) == wanted; });
    if (family == queues.end()) return missing(fmt::format("The device {} has no compute queue.", name_));
    queue_family_ = static_cast<std::uint32_t>(family - queues.begin());
    if (family->timestampValidBits == 0) timestamp_period_ns_ = 0;
    return {};
}

Result<void> Device::create_device(const DeviceOptions&) {
    const auto available = device_extensions(physical_);
    std::vector<const char*> extensions;
    external_memory_ = contains(available, VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME);
    if (external_memory_) extensions.push_back(VK_KHR_EXTERNAL_MEMORY_FD_EXTENSION_NAME);
    for (const char* optional : {VK_EXT_EXTERNAL_MEMORY_DMA_BUF_EXTENSION_NAME, VK_EXT_EXTERNAL_MEMORY_HOST_EXTENSION_NAME})
        if (external_memory_ && contains(available, optional)) extensions.push_back(optional);  // gpu/external_buffer.h
    windows_ = windows_ && contains(available, "VK_KHR_swapchain");
    if (windows_) extensions.push_back("VK_KHR_swapchain");

    VkPhysicalDeviceVulkan12Features has12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceFeatures2 has{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &has12};
    vkGetPhysicalDeviceFeatures2(physical_, &has);
    if (!has12.scalarBlockLayout) return missing(fmt::format("The device {} lacks scalarBlockLayout. Update its driver.", name_));
    VkPhysicalDeviceVulkan12Features want12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    want12.scalarBlockLayout = VK_TRUE;
    want12.timelineSemaphore = has12.timelineSemaphore;
    VkPhysicalDeviceFeatures2 want{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &want12};

    const float priority = 1;
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueFamilyIndex = queue_family_;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &want};
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
    info.ppEnabledExtensionNames = extensions.data();
    ENTOPTIC_VK(vkCreateDevice(physical_, &info, nullptr, &device_));
    vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
    if (debug_utils_) set_object_name_ = reinterpret_cast<PFN_vkSetDebugUtilsObjectNameEXT>(vkGetDeviceProcAddr(device_, "vkSetDebugUtilsObjectNameEXT"));
    log::debug("Vulkan device {}, driver {}", name_, driver_);
    return {};
}

Device::~Device() {
    if (device_) {
        vkDeviceWaitIdle(device_);
        vkDestroyDevice(device_, nullptr);
    }
    if (messenger_) {
        const auto destroy = reinterpret_cast<PFN_vkDestroyDebugUtilsMessengerEXT>(vkGetInstanceProcAddr(instance_, "vkDestroyDebugUtilsMessengerEXT"));
        if (destroy) destroy(instance_, messenger_, nullptr);
    }
    if (instance_) vkDestroyInstance(instance_, nullptr);
}

Result<std::uint32_t> Device::memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags wanted) const {
    for (std::uint32_t i = 0; i < memory_.memoryTypeCount; ++i)
        if ((type_bits >> i & 1u) && (memory_.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    return failure(fmt::format("The device {} has no memory type with flags {:#x}.", name_, wanted));
}

void Device::set_name(VkObjectType type, std::uint64_t handle, const std::string& name) const {
    if (!set_object_name_ || name.empty()) return;
    VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
    info.objectType = type;
    info.objectHandle = handle;
    info.pObjectName = name.c_str();
    set_object_name_(device_, &info);
}

VkBool32 VKAPI_PTR Device::on_message(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                      const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) {
    static_cast<Device*>(user)->validation_messages_++;
    log::error("Vulkan validation: {}", data->pMessage);
    return VK_FALSE;
}

}  // namespace entoptic::gpu
