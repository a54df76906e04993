// For tests and benches: a device, headsets with simple and with real lenses, and layers made from pictures in memory.
#pragma once

#include "compositor/frame.h"
#include "compositor/images.h"
#include "gpu/commands.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <unistd.h>
#include <vector>

namespace entoptic::compositor::testing {

inline gpu::Device& test_device() {
    static const std::unique_ptr<gpu::Device> device = [] {
        gpu::DeviceOptions options;
        const char* validation = std::getenv("ENTOPTIC_TEST_VALIDATION");
        options.validation = validation && std::string_view(validation) == "1";
        auto made = gpu::Device::create(options);
        if (!made) {
            std::fprintf(stderr, "%s\n", made.error().message.c_str());
            std::abort();
        }
        return std::move(*made);
    }();
    return *device;
}

template <class T> T must(Result<T> result) {
    if (!result) {
        std::fprintf(stderr, "%s\n", result.error().message.c_str());
        std::abort();
    }
    return std::move(*result);
}
inline void must(Result<void> result) {
    if (!result) {
        std::fprintf(stderr, "%s\n", result.error().message.c_str());
        std::abort();
    }
}

// A lens that does nothing: the panel is a flat picture of ±tan_x, ±tan_y, all of it visible.
inline EyeOptics flat_optics(float tan_x, float tan_y, float head_x) {
    EyeOptics optics;
    optics.lens.aspect = 1;
    optics.lens.r2_cutoff = 100;
    optics.lens.focal = {1 / tan_x, 1 / tan_y};
    optics.lens.principal_point = {0, 0};
    optics.fov = {-std::atan(tan_x), std::atan(tan_x), std::atan(tan_y), -std::atan(tan_y)};
    optics.head_from_eye.position = {head_x, 0, 0};
    return optics;
}
inline std::array<EyeOptics, 2> flat_eyes(float tan_x = 1, float tan_y = 1) {
    return {flat_optics(tan_x, tan_y, -0.0315f), flat_optics(tan_x, tan_y, 0.0315f)};
}

// The Vive Pro example of facts/devices.md 1.4; the right eye mirrored.
inline std::array<EyeOptics, 2> vive_pro_eyes() {
    std::array<EyeOptics, 2> eyes;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        const float side = eye == 0 ? 1.0f : -1.0f;
        Lens& lens = eyes[eye].lens;
        lens.aspect = 0.9f;
        lens.grow_for_undistort = 0.6f;
        lens.r2_cutoff = 1.11f;
        lens.focal = {1.2f, 1.08f};
        lens.principal_point = {-0.081f * side, -0.0021f};
        lens.channels[0] = {{0.0807f * side, 0.0018f}, {-0.1598f, -0.0435f, -0.0218f}};
        lens.channels[1] = {{0.081f * side, 0.0021f}, {-0.1912f, -0.0274f, -0.0431f}};
        lens.channels[2] = {{0.0814f * side, 0.0024f}, {-0.2231f, -0.0105f, -0.0662f}};
        const float border = 1.6f;
        eyes[eye].fov = {
            std::atan((lens.principal_point.x - border) / lens.focal.x), std::atan((lens.principal_point.x + border) / lens.focal.x),
            std::atan((lens.principal_point.y + border) / lens.focal.y), std::atan((lens.principal_point.y - border) / lens.focal.y)};
        eyes[eye].head_from_eye.position = {-0.0315f * side, 0, 0};
    }
    return eyes;
}

struct Texture {
    std::uint64_t swapchain = 0;
    int width = 0, height = 0;
};

inline void image_barrier(gpu::Commands& commands, VkImage image, VkImageLayout from, VkImageLayout to, std::uint32_t from_family,
                          std::uint32_t to_family, VkAccessFlags source, VkAccessFlags destination,
                          VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT) {
    VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.srcAccessMask = source;
    barrier.dstAccessMask = destination;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = from_family;
    barrier.dstQueueFamilyIndex = to_family;
    barrier.image = image;
    barrier.subresourceRange = {aspect, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
    vkCmdPipelineBarrier(commands.handle(), VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0,
                         nullptr, 1, &barrier);
}

// An application's part: writes `texels` (tightly packed, array slices one after another) into an image and hands it over.
inline void write_image(gpu::Device& device, VkImage image, std::uint32_t width, std::uint32_t height, std::uint32_t slices,
                        std::span<const std::byte> texels, VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT) {
    auto staging = must(gpu::Buffer::create(device, texels.size(), gpu::BufferKind::upload, "staging"));
    std::memcpy(staging.bytes().data(), texels.data(), texels.size());
    auto commands = must(gpu::Commands::create(device, "application"));
    must(commands.begin());
    image_barrier(commands, image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_QUEUE_FAMILY_IGNORED,
                  VK_QUEUE_FAMILY_IGNORED, 0, VK_ACCESS_TRANSFER_WRITE_BIT, aspect);
    VkBufferImageCopy region{};
    region.imageSubresource = {aspect, 0, 0, slices};
    region.imageExtent = {width, height, 1};
    vkCmdCopyBufferToImage(commands.handle(), staging.handle(), image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
    image_barrier(commands, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL, device.queue_family(),
                  VK_QUEUE_FAMILY_EXTERNAL, VK_ACCESS_TRANSFER_WRITE_BIT, 0, aspect);
    must(commands.submit());
    must(commands.wait());
}

inline void write_image(gpu::Device& device, SwapchainPool& pool, std::uint64_t swapchain, std::uint32_t image_index, std::uint32_t width,
                        std::uint32_t height, std::uint32_t slices, std::span<const std::byte> texels) {
    Layer layer;
    layer.kind = LayerKind::quad;
    layer.views[0].image = {swapchain, image_index, 0, 0, 0, int(width), int(height)};
    const ImageUse use = pool.use({layer});
    write_image(device, must(use.find(layer.views[0].image)).image, width, height, slices, texels);
}

// An application's image in memory that came over a file descriptor, imported the way interfaces/image_memory.h says. Takes the fd over.
class ImportedImage {
public:
    ImportedImage(gpu::Device& device, const ImageMemory& memory) : device_(device) {
        VkExternalMemoryImageCreateInfo external{VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_IMAGE_CREATE_INFO};
        external.handleTypes = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
        VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO, &external};
        info.flags = memory.vk_create_flags;
        info.imageType = VK_IMAGE_TYPE_2D;
        info.format = static_cast<VkFormat>(memory.vk_format);
        info.extent = {memory.width, memory.height, 1};
        info.mipLevels = memory.mip_levels;
        info.arrayLayers = memory.array_layers;
        info.samples = static_cast<VkSampleCountFlagBits>(memory.samples);
        info.usage = memory.vk_usage;
        if (vkCreateImage(device.handle(), &info, nullptr, &image_) != VK_SUCCESS) std::abort();
        VkMemoryDedicatedAllocateInfo dedicated{VK_STRUCTURE_TYPE_MEMORY_DEDICATED_ALLOCATE_INFO};
        dedicated.image = image_;
        VkImportMemoryFdInfoKHR import{VK_STRUCTURE_TYPE_IMPORT_MEMORY_FD_INFO_KHR, &dedicated};
        import.handleType = VK_EXTERNAL_MEMORY_HANDLE_TYPE_OPAQUE_FD_BIT;
        import.fd = memory.fd;
        VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, &import};
        allocate.allocationSize = memory.size;
        allocate.memoryTypeIndex = must(device.memory_type(memory.memory_type_bits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT));
        if (vkAllocateMemory(device.handle(), &allocate, nullptr, &memory_) != VK_SUCCESS) std::abort();
        if (vkBindImageMemory(device.handle(), image_, memory_, 0) != VK_SUCCESS) std::abort();
    }
    ~ImportedImage() {
        vkDestroyImage(device_.handle(), image_, nullptr);
        vkFreeMemory(device_.handle(), memory_, nullptr);
    }
    ImportedImage(const ImportedImage&) = delete;
    ImportedImage& operator=(const ImportedImage&) = delete;
    VkImage image() const { return image_; }

private:
    gpu::Device& device_;
    VkImage image_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
};

inline std::uint64_t make_swapchain(SwapchainPool& pool, VkFormat format, std::uint32_t width, std::uint32_t height,
                                    std::uint32_t slices = 1, bool is_static = true) {
    SwapchainRequest request;
    request.vk_format = format;
    request.width = width;
    request.height = height;
    request.array_layers = slices;
    request.vk_usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    request.is_static = is_static;
    const SwapchainAllocation allocation = must(pool.create(request));
    for (const ImageMemory& memory : allocation.images) close(memory.fd);
    return allocation.id;
}

// 8-bit texels, RGBA; `colour(x, y)` gives codes.
using Codes = std::array<std::uint8_t, 4>;
inline Texture make_texture(gpu::Device& device, SwapchainPool& pool, int width, int height, const std::function<Codes(int, int)>& colour,
                            VkFormat format = VK_FORMAT_R8G8B8A8_SRGB) {
    std::vector<Codes> texels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) texels.push_back(colour(x, y));
    const Texture texture{make_swapchain(pool, format, std::uint32_t(width), std::uint32_t(height)), width, height};
    write_image(device, pool, texture.swapchain, 0, std::uint32_t(width), std::uint32_t(height), 1, std::as_bytes(std::span(texels)));
    return texture;
}

using Linear = std::array<float, 4>;
inline Texture make_float_texture(gpu::Device& device, SwapchainPool& pool, int width, int height,
                                  const std::function<Linear(int, int)>& colour) {
    std::vector<Linear> texels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) texels.push_back(colour(x, y));
    const Texture texture{make_swapchain(pool, VK_FORMAT_R32G32B32A32_SFLOAT, std::uint32_t(width), std::uint32_t(height)), width, height};
    write_image(device, pool, texture.swapchain, 0, std::uint32_t(width), std::uint32_t(height), 1, std::as_bytes(std::span(texels)));
    return texture;
}

inline SubImage whole(const Texture& texture) { return {texture.swapchain, 0, 0, 0, 0, texture.width, texture.height}; }

// An SDR projection layer of one texture for both eyes, drawn for a head at the origin.
inline Layer projection_layer(const Texture& texture, const std::array<EyeOptics, 2>& eyes, const perception::DisplayRange& display = {}) {
    Layer layer;
    layer.luminance = {display.white_cd_m2 - display.black_cd_m2, display.black_cd_m2, LuminanceSource::default_sdr};
    for (std::size_t eye = 0; eye < 2; ++eye) {
        layer.views[eye].space_from_view = eyes[eye].head_from_eye;
        layer.views[eye].fov = eyes[eye].fov;
        layer.views[eye].image = whole(texture);
    }
    return layer;
}

inline Layer quad_layer(const Texture& texture, glm::vec3 centre, float width_m, float height_m,
                        const perception::DisplayRange& display = {}) {
    Layer layer;
    layer.kind = LayerKind::quad;
    layer.luminance = {display.white_cd_m2 - display.black_cd_m2, display.black_cd_m2, LuminanceSource::default_sdr};
    layer.views[0].image = whole(texture);
    layer.space_from_quad.position = centre;
    layer.quad_width_m = width_m;
    layer.quad_height_m = height_m;
    return layer;
}

inline FrameDescription description(std::vector<Layer> layers, const std::array<EyeOptics, 2>& eyes, std::uint64_t index = 0) {
    FrameDescription frame;
    frame.index = index;
    frame.layers = std::move(layers);
    for (std::size_t eye = 0; eye < 2; ++eye) frame.head_from_eye[eye] = eyes[eye].head_from_eye;
    frame.perception.eyes.resize(2);
    frame.perception.snap = index == 0;
    frame.perception.index = index;
    return frame;
}

}  // namespace entoptic::compositor::testing
