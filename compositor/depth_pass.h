// Layers → how far away each pixel of the scene image is, for models that ask (perception::Stage::wants_depth). Recorded only then.
#pragma once

#include "compositor/depth_layer.h"
#include "compositor/passes.h"

namespace entoptic::compositor {

class DepthPass {
public:
    static Result<DepthPass> create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& geometry);
    DepthPass() = default;
    ~DepthPass();
    DepthPass(DepthPass&& other) noexcept { *this = std::move(other); }
    DepthPass& operator=(DepthPass&& other) noexcept;

    void clear();
    // Adds the next layer of one eye, over those before. `depth` is null for layers without a depth image.
    void add(int eye, const DepthLayer& layer, const SampledImage& colour, const SampledImage* depth);
    // Depth images of the frame, each once.
    const std::vector<SampledImage>& images() const { return unique_; }
    // Writes stage.depth() and says so, unless no layer knows its distance. Call when the batch before was waited for.
    void record(gpu::Commands& commands, perception::Stage& stage);

private:
    struct Views {
        VkImageView colour, depth;
    };
    gpu::Device* device_ = nullptr;
    EyeGrids grids_;
    gpu::Kernel kernel_;
    gpu::Buffer buffer_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    std::array<std::vector<DepthLayer>, eye_count> layers_;
    std::array<std::vector<Views>, eye_count> views_;
    std::vector<SampledImage> unique_;
};

}  // namespace entoptic::compositor
