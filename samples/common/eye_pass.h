// What it takes to draw into the images of one eye: render pass, own depth and multisample images, framebuffers, a command
// buffer and a fence. Knows nothing of OpenXR: the images may be a swapchain's or our own.
#pragma once

#include <optional>
#include <vector>

#include "samples/common/gpu.h"

namespace samples {

// A render pass into one colour image that is left in COLOR_ATTACHMENT_OPTIMAL, the layout in which OpenXR takes it back.
// With samples > 1 it draws into a multisample image and resolves; the mean is taken of linear light, as a camera would. Depth that is kept
// is then the first sample's: a mean would lie where there is nothing.
struct PassFormat {
    VkFormat colour = VK_FORMAT_UNDEFINED;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
    bool depth = false;
    bool keep_depth = false;  // into images that the caller gives, left in DEPTH_STENCIL_ATTACHMENT_OPTIMAL
    bool over = false;        // draws over a part of a picture: outside of draw()'s area the images stay as an earlier pass left them
};

OwnedRenderPass create_render_pass(const Gpu& gpu, const PassFormat& format);

class EyePass {
public:
    // `images` (colour attachments of `format.colour` and `extent`) and `depth_images` (D32_SFLOAT, if `format.keep_depth`) stay the caller's.
    EyePass(const Gpu& gpu, const PassFormat& format, VkRenderPass render_pass, VkExtent2D extent, const std::vector<VkImage>& images,
            const std::vector<VkImage>& depth_images = {});
    EyePass(EyePass&&) = default;

    // Waits until the previous picture of this eye is done, so that what `record` reads may be rewritten.
    void wait() const;
    // Records a render pass over `area` of image number `index` and depth image number `depth`, cleared to black and depth 1, and submits it
    // without waiting.
    void draw(std::uint32_t index, std::uint32_t depth, const VkRect2D& area, const std::function<void(VkCommandBuffer)>& record) const;

    // GPU time of the picture that was drawn and waited for last, ms; none on devices without timestamps. Not to be called before draw().
    std::optional<double> milliseconds() const;

    VkExtent2D extent() const { return extent_; }
    VkRect2D whole() const { return {{0, 0}, extent_}; }

private:
    const Gpu* gpu_;
    PassFormat format_;
    VkRenderPass render_pass_;
    VkExtent2D extent_;
    Image multisample_;
    Image depth_;
    std::vector<OwnedImageView> views_, depth_views_;
    std::vector<OwnedFramebuffer> framebuffers_;  // for each image, one for each kept depth image, or one
    VkCommandBuffer commands_ = VK_NULL_HANDLE;   // freed with the Gpu's command pool
    OwnedFence done_;
    OwnedQueryPool times_;  // of begin and end; none on devices without timestamps
};

}  // namespace samples
