#include "compositor/depth_pass.h"

#include "compositor/depth.comp.h"

#include <algorithm>
#include <bit>

namespace entoptic::compositor {
namespace {

struct DepthPush {
    std::uint32_t view, tiles, slot;
};

}  // namespace

Result<DepthPass> DepthPass::create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& geometry) {
    using enum gpu::BindingKind;
    DepthPass pass;
    pass.device_ = &device;
    ENTOPTIC_TRY(grids, EyeGrids::create(device, geometry, tile_width, tile_height, "depth"));
    ENTOPTIC_TRY(
        kernel, gpu::Kernel::create(device, {"depth of a layer",
                                             depth_comp_spv,
                                             {uniform_buffer, uniform_buffer, storage_buffer, storage_buffer, sampled_image, sampled_image},
                                             sizeof(DepthPush),
                                             {}}));
    ENTOPTIC_TRY(buffer,
                 gpu::Buffer::create(device, eye_count * layer_slots * sizeof(DepthLayer), gpu::BufferKind::upload, "depth layers"));
    pass.grids_ = std::move(grids);
    pass.kernel_ = std::move(kernel);
    pass.buffer_ = std::move(buffer);
    // Only texels are fetched; but a sampled image comes with a sampler.
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    sampler.addressModeU = sampler.addressModeV = sampler.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    ENTOPTIC_VK(vkCreateSampler(device.handle(), &sampler, nullptr, &pass.sampler_));
    return pass;
}

DepthPass::~DepthPass() {
    if (device_) vkDestroySampler(device_->handle(), sampler_, nullptr);
}

DepthPass& DepthPass::operator=(DepthPass&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(grids_, other.grids_);
    std::swap(kernel_, other.kernel_);
    std::swap(buffer_, other.buffer_);
    std::swap(sampler_, other.sampler_);
    std::swap(layers_, other.layers_);
    std::swap(views_, other.views_);
    std::swap(unique_, other.unique_);
    return *this;
}

void DepthPass::clear() {
    for (std::size_t eye = 0; eye < eye_count; ++eye) {
        layers_[eye].clear();
        views_[eye].clear();
    }
    unique_.clear();
}

void DepthPass::add(int eye, const DepthLayer& layer, const SampledImage& colour, const SampledImage* depth) {
    auto& layers = layers_[std::size_t(eye)];
    if (layers.size() >= layer_slots) return;
    layers.push_back(layer);
    views_[std::size_t(eye)].push_back({colour.view, depth ? depth->view : colour.view});
    const auto same = [&](const SampledImage& image) { return image.image == depth->image; };
    if (depth && std::ranges::none_of(unique_, same)) unique_.push_back(*depth);
}

void DepthPass::record(gpu::Commands& commands, perception::Stage& stage) {
    const auto known = [](const DepthLayer& layer) { return (layer.flags & depth_known) != 0; };
    if (std::ranges::none_of(layers_[0], known) && std::ranges::none_of(layers_[1], known)) return;
    for (std::size_t eye = 0; eye < eye_count; ++eye)
        std::ranges::copy(layers_[eye], buffer_.as<DepthLayer>().begin() + static_cast<std::ptrdiff_t>(eye * layer_slots));
    for (std::size_t slot = 0; slot < std::max(layers_[0].size(), layers_[1].size()); ++slot) {
        if (slot > 0) commands.barrier();
        for (int eye = 0; eye < eye_count; ++eye) {
            if (slot >= layers_[std::size_t(eye)].size()) continue;
            const auto& shown = grids_.shown(eye);
            const Views& views = views_[std::size_t(eye)][slot];
            commands.dispatch(kernel_,
                              {grids_.geometry(),
                               buffer_,
                               shown.list,
                               stage.depth(),
                               {views.colour, sampler_, VK_IMAGE_LAYOUT_GENERAL},
                               {views.depth, sampler_, VK_IMAGE_LAYOUT_GENERAL}},
                              DepthPush{std::uint32_t(eye), shown.count, std::uint32_t(slot)}, shown.groups());
        }
    }
    // An eye that sees no layer at all sees nothing known.
    for (int eye = 0; eye < eye_count; ++eye)
        if (layers_[std::size_t(eye)].empty())
            commands.fill(stage.depth(), std::bit_cast<std::uint32_t>(unknown_dioptre), std::size_t(eye) * stage.view_bytes() / 4,
                          stage.view_bytes() / 4);
    stage.depth_written();
}

}  // namespace entoptic::compositor
