// Buffers and images with memory of their own. Move-only; the owner sees to it that the GPU has finished with them.
#pragma once

#include "gpu/device.h"

#include <cstddef>
#include <span>
#include <string>

namespace entoptic::gpu {

enum class BufferKind {
    device,    // storage, indirect, transfer both ways; fastest for the GPU; contents undefined at first
    upload,    // host-visible and coherent, the CPU writes, the GPU reads (storage, transfer source)
    readback,  // host-visible, coherent and cached if there is such memory: the GPU writes, the CPU reads
};

class Buffer {
public:
    Buffer() = default;
    static Result<Buffer> create(const Device& device, std::size_t bytes, BufferKind kind, const std::string& name);
    ~Buffer();
    Buffer(Buffer&& other) noexcept { *this = std::move(other); }
    Buffer& operator=(Buffer&& other) noexcept;

    VkBuffer handle() const { return buffer_; }
    std::size_t size() const { return size_; }
    explicit operator bool() const { return buffer_ != VK_NULL_HANDLE; }
    // Mapped for the whole life of upload and readback buffers, else empty.
    std::span<std::byte> bytes() const { return {static_cast<std::byte*>(mapped_), mapped_ ? size_ : 0}; }
    template <class T> std::span<T> as() const { return {static_cast<T*>(mapped_), mapped_ ? size_ / sizeof(T) : 0}; }

private:
    const Device* device_ = nullptr;
    VkBuffer buffer_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    void* mapped_ = nullptr;
    std::size_t size_ = 0;
};

struct ImageInfo {
    VkFormat format = VK_FORMAT_UNDEFINED;
    std::uint32_t width = 1, height = 1, layers = 1, mips = 1;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
    VkImageUsageFlags usage = VK_IMAGE_USAGE_SAMPLED_BIT;
    VkImageCreateFlags flags = 0;
    bool exportable = false;   // dedicated memory that export_fd() can give away
    std::string name;
};

class Image {
public:
    Image() = default;
    static Result<Image> create(const Device& device, const ImageInfo& info);
    ~Image();
    Image(Image&& other) noexcept { *this = std::move(other); }
    Image& operator=(Image&& other) noexcept;

    VkImage handle() const { return image_; }
    const ImageInfo& info() const { return info_; }
    VkDeviceSize memory_size() const { return memory_size_; }
    std::uint32_t memory_type_bits() const { return memory_type_bits_; }
    explicit operator bool() const { return image_ != VK_NULL_HANDLE; }
    // A new opaque file descriptor of the memory; the caller owns it. Only for exportable images.
    Result<int> export_fd() const;
    // A 2D view of one layer (mip 0), the caller destroys it.
    Result<VkImageView> create_view(std::uint32_t layer, VkFormat format, VkImageAspectFlags aspect) const;

private:
    const Device* device_ = nullptr;
    ImageInfo info_;
    VkImage image_ = VK_NULL_HANDLE;
    VkDeviceMemory memory_ = VK_NULL_HANDLE;
    VkDeviceSize memory_size_ = 0;
    std::uint32_t memory_type_bits_ = 0;
};

}  // namespace entoptic::gpu
