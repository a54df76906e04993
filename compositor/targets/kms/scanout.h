// Pictures that the GPU draws and a card scans out, with as few copies between as both drivers allow.
#pragma once

#include "compositor/pictures.h"
#include "compositor/targets/kms/drm_card.h"
#include "gpu/commands.h"
#include "gpu/external_buffer.h"
#include "gpu/memory.h"
#include "interfaces/layers.h"

namespace entoptic::compositor::kms {

enum class ScanoutPath {
    shared,    // the GPU's own memory, given to the card as a dma-buf
    imported,  // the card's memory, which Vulkan draws into
    copied,    // the GPU draws into memory of its own, the CPU copies it to the card's
};

// One picture of both eyes side by side. `card` and `device` outlive it.
class ScanoutBuffer {
public:
    // Tries the paths in the order above, from `first` on. Errors: the card refuses a framebuffer of that size.
    static Result<ScanoutBuffer> create(gpu::Device& device, DrmCard& card, PictureSize eye, ScanoutPath first);
    ScanoutBuffer() = default;
    ~ScanoutBuffer();
    ScanoutBuffer(ScanoutBuffer&& other) noexcept { *this = std::move(other); }
    ScanoutBuffer& operator=(ScanoutBuffer&& other) noexcept;

    std::uint32_t framebuffer() const { return framebuffer_.id; }
    std::uint32_t pitch() const { return framebuffer_.pitch; }  // bytes
    gpu::Binding pixels() const;                                // where the GPU draws
    // After the GPU has drawn: brings the picture to where the card reads it.
    void finish();
    ScanoutPath path() const { return path_; }

private:
    bool share(gpu::Device& device, PictureSize eye);
    bool import(gpu::Device& device);
    Result<void> make_copy(gpu::Device& device);

    DrmCard* card_ = nullptr;
    Framebuffer framebuffer_;
    gpu::ExternalBuffer pixels_;  // shared, imported
    gpu::Buffer copy_;            // copied
    ScanoutPath path_ = ScanoutPath::copied;
};

// Draws a frame's codes into a ScanoutBuffer.
class ScanoutPass {
public:
    static Result<ScanoutPass> create(const gpu::Device& device);
    void record(gpu::Commands& commands, const gpu::Buffer& codes, PictureSize eye, const ScanoutBuffer& into) const;

private:
    gpu::Kernel kernel_;
};

}  // namespace entoptic::compositor::kms
