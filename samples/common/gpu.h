// A thin layer over vulkan.h: one device with one graphics queue, images, buffers, pipelines. Every object frees itself;
// the caller keeps the Gpu alive longer than what was made with it, and the queue idle when something is destroyed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <vulkan/vulkan.h>

namespace samples {

// Throws a Failure that names the call unless it succeeded.
void check_vk(VkResult result, const char* call);

// A Vulkan handle that belongs to a device and is destroyed with its owner.
template <typename Handle, auto Destroy> class Owned {
public:
    Owned() = default;
    Owned(VkDevice device, Handle handle) : device_(device), handle_(handle) {}
    Owned(Owned&& other) noexcept : device_(other.device_), handle_(std::exchange(other.handle_, VK_NULL_HANDLE)) {}
    Owned& operator=(Owned&& other) noexcept {
        std::swap(device_, other.device_);
        std::swap(handle_, other.handle_);
        return *this;
    }
    ~Owned() {
        if (handle_ != VK_NULL_HANDLE) { Destroy(device_, handle_, nullptr); }
    }
    Handle get() const { return handle_; }

private:
    VkDevice device_ = VK_NULL_HANDLE;
    Handle handle_ = VK_NULL_HANDLE;
};

using OwnedMemory = Owned<VkDeviceMemory, vkFreeMemory>;
using OwnedImage = Owned<VkImage, vkDestroyImage>;
using OwnedImageView = Owned<VkImageView, vkDestroyImageView>;
using OwnedBuffer = Owned<VkBuffer, vkDestroyBuffer>;
using OwnedSampler = Owned<VkSampler, vkDestroySampler>;
using OwnedFence = Owned<VkFence, vkDestroyFence>;
using OwnedQueryPool = Owned<VkQueryPool, vkDestroyQueryPool>;
using OwnedRenderPass = Owned<VkRenderPass, vkDestroyRenderPass>;
using OwnedFramebuffer = Owned<VkFramebuffer, vkDestroyFramebuffer>;
using OwnedPipeline = Owned<VkPipeline, vkDestroyPipeline>;
using OwnedPipelineLayout = Owned<VkPipelineLayout, vkDestroyPipelineLayout>;
using OwnedSetLayout = Owned<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout>;
using OwnedDescriptorPool = Owned<VkDescriptorPool, vkDestroyDescriptorPool>;

// Owns instance, device and command pool.
class Gpu {
public:
    // Who makes the instance and the device: Vulkan itself, or an OpenXR runtime through XR_KHR_vulkan_enable2.
    struct Factory {
        std::function<VkResult(const VkInstanceCreateInfo&, VkInstance*)> create_instance;
        std::function<VkPhysicalDevice(VkInstance)> choose_device;
        std::function<VkResult(VkPhysicalDevice, const VkDeviceCreateInfo&, VkDevice*)> create_device;
    };

    // Throws Failure (missing) when there is no Vulkan 1.2 device.
    Gpu(const std::string& application, const Factory& factory);
    Gpu(const Gpu&) = delete;
    Gpu& operator=(const Gpu&) = delete;
    ~Gpu();

    // A Gpu without OpenXR: the first discrete device, else the first of any kind.
    static std::unique_ptr<Gpu> standalone(const std::string& application);

    VkInstance instance() const { return instance_; }
    VkPhysicalDevice physical_device() const { return physical_device_; }
    VkDevice device() const { return device_; }
    VkQueue queue() const { return queue_; }
    std::uint32_t queue_family() const { return queue_family_; }
    bool has_timestamps() const { return has_timestamps_; }  // of its queue
    VkCommandPool command_pool() const { return command_pool_; }
    const VkPhysicalDeviceProperties& properties() const { return properties_; }

    // Index of a memory type allowed by `type_bits` that has all of `wanted`; throws when there is none.
    std::uint32_t memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags wanted) const;
    // Whether optimal-tiling images of `format` have all of `features`.
    bool supports(VkFormat format, VkFormatFeatureFlags features) const;
    // Records with `record`, submits, and waits until the device has done it.
    void submit_and_wait(const std::function<void(VkCommandBuffer)>& record) const;

private:
    void create_instance(const std::string& application, const Factory& factory);
    void create_device(const Factory& factory);

    VkInstance instance_ = VK_NULL_HANDLE;
    VkPhysicalDevice physical_device_ = VK_NULL_HANDLE;
    VkDevice device_ = VK_NULL_HANDLE;
    VkQueue queue_ = VK_NULL_HANDLE;
    std::uint32_t queue_family_ = 0;
    bool has_timestamps_ = false;
    VkCommandPool command_pool_ = VK_NULL_HANDLE;
    VkPhysicalDeviceProperties properties_{};
    VkPhysicalDeviceMemoryProperties memory_properties_{};
};

// A 2D image with its memory and one view of all mip levels.
struct Image {
    OwnedMemory memory;
    OwnedImage image;
    OwnedImageView view;
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent2D extent{};
    std::uint32_t mip_levels = 1;
};

struct ImageDescription {
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkExtent2D extent{};
    VkImageUsageFlags usage = 0;
    std::uint32_t mip_levels = 1;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
};

VkImageAspectFlags aspect_of(VkFormat format);
Image create_image(const Gpu& gpu, const ImageDescription& description);
OwnedImageView create_image_view(const Gpu& gpu, VkImage image, VkFormat format, std::uint32_t mip_levels);

// A buffer in host-visible, coherent memory, mapped while it lives.
struct Buffer {
    OwnedMemory memory;
    OwnedBuffer buffer;
    void* mapped = nullptr;
    VkDeviceSize size = 0;
};

Buffer create_buffer(const Gpu& gpu, VkDeviceSize size, VkBufferUsageFlags usage);
Buffer create_buffer_from(const Gpu& gpu, std::span<const std::byte> bytes, VkBufferUsageFlags usage);

// A sampled image whose mip levels are given tightly packed, largest first; left in SHADER_READ_ONLY_OPTIMAL.
Image create_texture(const Gpu& gpu, VkFormat format, VkExtent2D extent, std::span<const std::vector<std::byte>> levels);

// The pixels of mip 0 of an image in COLOR_ATTACHMENT_OPTIMAL, tightly packed; the image ends in that layout again.
std::vector<std::byte> read_back(const Gpu& gpu, VkImage image, VkExtent2D extent, std::size_t bytes_per_pixel);
// The same for a D32_SFLOAT image in DEPTH_STENCIL_ATTACHMENT_OPTIMAL.
std::vector<float> read_back_depth(const Gpu& gpu, VkImage image, VkExtent2D extent);

OwnedSampler create_sampler(const Gpu& gpu, VkFilter filter, VkSamplerAddressMode u, VkSamplerAddressMode v);

// Descriptor plumbing. A layout's bindings are numbered in order.
struct SetBinding {
    VkDescriptorType type;
    VkShaderStageFlags stages;
};
OwnedSetLayout create_set_layout(const Gpu& gpu, std::span<const SetBinding> bindings);
OwnedDescriptorPool create_descriptor_pool(const Gpu& gpu, std::uint32_t sets, std::uint32_t uniform_buffers, std::uint32_t images);
VkDescriptorSet allocate_set(const Gpu& gpu, VkDescriptorPool pool, VkDescriptorSetLayout layout);
void write_image(const Gpu& gpu, VkDescriptorSet set, std::uint32_t binding, VkImageView view, VkSampler sampler);
void write_uniform_buffer(const Gpu& gpu, VkDescriptorSet set, std::uint32_t binding, VkBuffer buffer, VkDeviceSize offset,
                          VkDeviceSize range);

enum class Blend { replace, add };

struct PipelineDescription {
    std::span<const std::uint32_t> vertex_spirv;
    std::span<const std::uint32_t> fragment_spirv;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkRenderPass render_pass = VK_NULL_HANDLE;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
    std::uint32_t vertex_stride = 0;  // 0: the vertex shader needs no buffer
    std::span<const VkVertexInputAttributeDescription> attributes;
    bool depth_test = false;
    bool depth_write = false;
    bool cull_back_faces = false;
    Blend blend = Blend::replace;
};

OwnedPipelineLayout create_pipeline_layout(const Gpu& gpu, std::span<const VkDescriptorSetLayout> sets,
                                           std::span<const VkPushConstantRange> push_constants);
OwnedPipeline create_pipeline(const Gpu& gpu, const PipelineDescription& description);

}  // namespace samples
