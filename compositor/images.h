// Swapchain images: made here, exported to the application, sampled by the warp. Counts who still reads which image.
#pragma once

#include "base/result.h"
#include "gpu/memory.h"
#include "interfaces/frame_service.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace entoptic::compositor {

struct SwapchainImages;  // one swapchain's images and views
struct PoolState;

// An image that the warp reads.
struct SampledImage {
    VkImage image = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;  // of one array layer, mip 0
    bool is_float = false;              // can hold NaN, infinities and negatives
    bool is_srgb8 = false;              // holds 8-bit codes of the panel's own curve
    VkImageAspectFlags aspects = VK_IMAGE_ASPECT_COLOR_BIT;  // of the image; the view of a depth image shows depth
};

// The images that a frame's layers name, held as long as this lives: wait_idle() waits for it, and destroyed swapchains stay.
class ImageUse {
public:
    ImageUse() = default;
    ~ImageUse() { release(); }
    ImageUse(ImageUse&& other) noexcept { *this = std::move(other); }
    ImageUse& operator=(ImageUse&& other) noexcept;
    void release();
    // Errors: the frame does not hold that image.
    Result<SampledImage> find(const SubImage& image) const;
    // The same for a depth image.
    Result<SampledImage> find_depth(const SubImage& image) const;

private:
    friend class SwapchainPool;
    Result<SampledImage> find(const SubImage& wanted, bool depth) const;
    struct Held {
        std::shared_ptr<SwapchainImages> swapchain;
        std::uint32_t index = 0;
    };
    std::shared_ptr<PoolState> state_;
    std::vector<Held> held_;
};

// Thread-safe. Must outlive no ImageUse's Vulkan work: the device outlives both.
//
// Layouts and ownership: an image is handed over in layout GENERAL, owned by VK_QUEUE_FAMILY_EXTERNAL. Its first contents are undefined:
// the application starts from UNDEFINED, and releases to EXTERNAL in GENERAL. The compositor acquires and gives back the same way.
class SwapchainPool {
public:
    explicit SwapchainPool(gpu::Device& device);

    // Formats that the device can sample with linear filtering (colour) or use as depth; preferred first.
    std::vector<std::int64_t> formats() const;
    Result<SwapchainAllocation> create(const SwapchainRequest& request);
    void destroy(std::uint64_t id);
    // Takes hold of all images of `layers`. Layers whose swapchain is not there are left out (find() will say so).
    ImageUse use(const std::vector<Layer>& layers);
    // False when `timeout` passed before the image was free. A swapchain that is not there is free.
    bool wait_idle(std::uint64_t id, std::uint32_t image_index, DurationNs timeout);
    std::size_t swapchains() const;

private:
    gpu::Device& device_;
    std::shared_ptr<PoolState> state_;
    std::vector<std::int64_t> formats_;
};

}  // namespace entoptic::compositor
