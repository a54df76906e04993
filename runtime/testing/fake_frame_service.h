// A FrameService for tests: real exportable Vulkan images on the first GPU, frames only counted and kept. Header-only, not in the library.
// Every image is idle unless a test says that the compositor still reads it (block_image).
#pragma once

#include "base/time.h"
#include "interfaces/frame_service.h"

#include <vulkan/vulkan_core.h>

#include <condition_variable>
#include <chrono>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <vector>

extern "C" VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL vkGetInstanceProcAddr(VkInstance instance, const char* name);

namespace entoptic::runtime::testing {

// The compositor's own device, as the real one has: images are made here and exported.
class ExportDevice {
public:
    ExportDevice() {
        VkApplicationInfo application{VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "fake compositor", 0, "", 0, VK_API_VERSION_1_1};
        VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, nullptr, 0, &application, 0, nullptr, 0, nullptr};
        check(get<PFN_vkCreateInstance>("vkCreateInstance")(&info, nullptr, &instance_), "vkCreateInstance");
        std::uint32_t count = 1;
        const VkResult found = get<PFN_vkEnumeratePhysicalDevices>("vkEnumeratePhysicalDevices")(instance_, &count, &physical_);
        if ((found != VK_SUCCESS && found != VK_INCOMPLETE) || count == 0) throw std::runtime_error("no Vulkan device");
        VkPhysicalDeviceIDProperties id{};
        id.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES;
        VkPhysicalDeviceProperties2 properties{};
        properties.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2;
        properties.pNext = &id;
        get<PFN_vkGetPhysicalDeviceProperties2>("vkGetPhysicalDeviceProperties2")(physical_, &properties);
        std::memcpy(device_uuid.data(), id.deviceUUID, 16);
        std::memcpy(driver_uuid.data(), id.driverUUID, 16);
        const float priority = 1;
        VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, 0, 1, &priority};
        const char* extensions[] = {"VK_KHR_external_memory_fd"};
        VkDeviceCreateInfo device{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, nullptr, 0, 1, &queue, 0, nullptr, 1, extensions, nullptr};
        check(get<PFN_vkCreateDevice>("vkCreateDevice")(physical_, &device, nullptr, &device_), "vkCreateDevice");
    }
    ~ExportDevice() {
        if (device_) get<PFN_vkDestroyDevice>("vkDestroyDevice")(device_, nullptr);
        if (instance_) get<PFN_vkDestroyInstance>("vkDestroyInstance")(instance_, nullptr);
    }
    ExportDevice(const ExportDevice&) = delete;
    ExportDevice& operator=(const ExportDevice&) = delete;

    ImageMemory make_image(const SwapchainRequest& request) {
        VkExternalMemoryImageCreateInfo external{};
        external.sType = VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_IMAGE_CREATE_INFO;
        external.handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
        VkImageCreateInfo info{};
        info.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO;
        info.pNext = &external;
        info.flags = request.vk_create_flags;
        info.imageType = VK_IMAGE_TYPE_2D;
        info.format = static_cast<VkFormat>(request.vk_format);
        info.extent = {request.width, request.height, 1};
        info.mipLevels = request.mip_levels;
        info.arrayLayers = request.array_layers;
        info.samples = VK_SAMPLE_COUNT_1_BIT;
        info.usage = request.vk_usage | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
        VkImage image = VK_NULL_HANDLE;
        check(get<PFN_vkCreateImage>("vkCreateImage")(device_, &info, nullptr, &image), "vkCreateImage");
        VkMemoryRequirements requirements{};
        get<PFN_vkGetImageMemoryRequirements>("vkGetImageMemoryRequirements")(device_, image, &requirements);
        std::uint32_t type = 0;
        while ((requirements.memoryTypeBits & (1u << type)) == 0) ++type;
        VkMemoryDedicatedAllocateInfo dedicated{VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO, nullptr, image, VK_NULL_HANDLE};
        VkExportMemoryAllocateInfo exported{VK_STRUCTURE_TYPE_EXPORT_MEMORY_ALLOCATE_INFO, &dedicated,
                                            VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
        VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, &exported, requirements.size, type};
        VkDeviceMemory memory = VK_NULL_HANDLE;
        check(get<PFN_vkAllocateMemory>("vkAllocateMemory")(device_, &allocate, nullptr, &memory), "vkAllocateMemory");
        VkMemoryGetFdInfoKHR fd_info{VK_STRUCTURE_TYPE_MEMORY_GET_FD_INFO_KHR, nullptr, memory,
                                     VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT};
        ImageMemory result;
        check(get<PFN_vkGetMemoryFdKHR>("vkGetMemoryFdKHR")(device_, &fd_info, &result.fd), "vkGetMemoryFdKHR");
        // The file descriptor keeps the memory alive; this side never reads it.
        get<PFN_vkDestroyImage>("vkDestroyImage")(device_, image, nullptr);
        get<PFN_vkFreeMemory>("vkFreeMemory")(device_, memory, nullptr);
        result.size = requirements.size;
        result.vk_format = request.vk_format;
        result.vk_usage = info.usage;
        result.vk_create_flags = request.vk_create_flags;
        result.width = request.width;
        result.height = request.height;
        result.array_layers = request.array_layers;
        result.mip_levels = request.mip_levels;
        result.memory_type_bits = 1u << type;
        result.device_uuid = device_uuid;
        result.driver_uuid = driver_uuid;
        return result;
    }

    std::array<std::uint8_t, 16> device_uuid{}, driver_uuid{};

private:
    template <class Function> Function get(const char* name) { return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance_, name)); }
    static void check(VkResult result, const char* what) {
        if (result != VK_SUCCESS) throw std::runtime_error(std::string(what) + " failed: " + std::to_string(result));
    }

    VkInstance instance_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
};

class FakeFrameService final : public FrameService {
public:
    explicit FakeFrameService(Clock& clock) : clock_(clock) {}

    std::array<std::uint8_t, 16> device_uuid() const override { return device().device_uuid; }
    std::array<std::uint8_t, 16> driver_uuid() const override { return told_driver_uuid.value_or(device().driver_uuid); }
    std::vector<std::int64_t> swapchain_formats() const override {
        return {VK_FORMAT_R8G8B8A8_SRGB,
                VK_FORMAT_B8G8R8A8_SRGB,
                VK_FORMAT_R16G16B16A16_SFLOAT,
                VK_FORMAT_R32G32B32A32_SFLOAT,
                VK_FORMAT_A2B10G10R10_UNORM_PACK32,
                VK_FORMAT_D32_SFLOAT,
                VK_FORMAT_D16_UNORM};
    }
    Result<SwapchainAllocation> create_swapchain(const SwapchainRequest& request) override {
        std::lock_guard lock(mutex_);
        SwapchainAllocation allocation;
        allocation.id = ++last_swapchain_;
        for (int i = 0; i < (request.is_static ? 1 : 3); ++i) allocation.images.push_back(device().make_image(request));
        living_.insert(allocation.id);
        last_request = request;
        return allocation;
    }
    void destroy_swapchain(std::uint64_t id) override {
        std::lock_guard lock(mutex_);
        living_.erase(id);
    }
    bool wait_image_idle(std::uint64_t swapchain, std::uint32_t index, DurationNs timeout) override {
        std::unique_lock lock(mutex_);
        const auto idle = [&] { return !blocked_.contains({swapchain, index}); };
        if (timeout <= 0) return idle();
        const auto most = std::chrono::nanoseconds(std::min<DurationNs>(timeout, 10 * ns_per_s));
        return unblocked_.wait_for(lock, most, idle);
    }

    void begin_session() override { count(sessions_begun); }
    void end_session() override { count(sessions_ended); }
    FrameTiming wait_frame() override {
        TimeNs next = 0;
        FrameTiming timing;
        {
            std::lock_guard lock(mutex_);
            next = next_vsync_ = std::max(next_vsync_ + period, clock_.now());
            timing.frame_id = ++last_frame_;
        }
        clock_.sleep_until(next);
        timing.predicted_display_time = next + 2 * period;
        timing.period = period;
        timing.should_render = true;
        return timing;
    }
    void begin_frame(std::uint64_t frame) override {
        std::lock_guard lock(mutex_);
        begun.push_back(frame);
    }
    void submit_frame(FrameSubmission frame) override {
        std::lock_guard lock(mutex_);
        ++submitted_count;
        submitted.push_back(std::move(frame));
        if (submitted.size() > 64) submitted.erase(submitted.begin());
    }
    void discard_frame(std::uint64_t frame) override {
        std::lock_guard lock(mutex_);
        discarded.push_back(frame);
    }
    bool exit_wanted() const override {
        std::lock_guard lock(mutex_);
        return exit_after >= 0 && submitted_count >= exit_after;
    }
    std::optional<std::array<float, 2>> adaptation_cd_m2() const override { return adaptation; }
    std::vector<PresentationRecord> presentation_records(std::size_t) const override { return records; }

    // For tests.
    void block_image(std::uint64_t swapchain, std::uint32_t index, bool block) {
        std::lock_guard lock(mutex_);
        if (block)
            blocked_.insert({swapchain, index});
        else
            blocked_.erase({swapchain, index});
        unblocked_.notify_all();
    }
    std::size_t living_swapchains() const {
        std::lock_guard lock(mutex_);
        return living_.size();
    }
    FrameSubmission last_submission() const {
        std::lock_guard lock(mutex_);
        return submitted.empty() ? FrameSubmission{} : submitted.back();
    }
    void set_exit_after(int frames) {
        std::lock_guard lock(mutex_);
        exit_after = frames;
    }

    DurationNs period = ns_per_s / 90;
    std::optional<std::array<std::uint8_t, 16>> told_driver_uuid;  // another driver's: nothing can be shared with it
    std::optional<std::array<float, 2>> adaptation;
    std::vector<PresentationRecord> records;
    SwapchainRequest last_request;
    std::vector<FrameSubmission> submitted;  // the last 64
    std::vector<std::uint64_t> begun, discarded;
    int submitted_count = 0, sessions_begun = 0, sessions_ended = 0;

private:
    ExportDevice& device() const {
        std::lock_guard lock(device_mutex_);
        if (!device_) device_ = std::make_unique<ExportDevice>();
        return *device_;
    }
    void count(int& counter) {
        std::lock_guard lock(mutex_);
        ++counter;
    }

    Clock& clock_;
    mutable std::mutex mutex_, device_mutex_;
    mutable std::unique_ptr<ExportDevice> device_;
    std::condition_variable unblocked_;
    std::set<std::pair<std::uint64_t, std::uint32_t>> blocked_;
    std::set<std::uint64_t> living_;
    std::uint64_t last_swapchain_ = 0, last_frame_ = 0;
    TimeNs next_vsync_ = 0;
    int exit_after = -1;
};

}  // namespace entoptic::runtime::testing
