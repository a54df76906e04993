#include "compositor/passes.h"

#include "compositor/eye_view.h"
#include "compositor/measured_panel_gpu.h"

#include "compositor/clear.comp.h"
#include "compositor/fused.comp.h"
#include "compositor/glance.comp.h"
#include "compositor/lens.comp.h"
#include "compositor/measured_panel.comp.h"
#include "compositor/panel.comp.h"
#include "compositor/seen.comp.h"
#include "compositor/warp.comp.h"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <iterator>

namespace entoptic::compositor {
namespace {

using gpu::BindingKind;

// Kernels are made for these numbers of layers: a slot costs its time used or not, a kernel costs its compilation.
constexpr std::array<std::uint32_t, 13> slot_counts{0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16};
constexpr std::uint32_t max_groups = 65535;

// Workgroup of the fused pass.
constexpr std::uint32_t fused_width = 32, fused_height = 8;

struct TilePush {
    std::uint32_t view, tiles;
};
struct FusedPush {
    std::uint32_t view, tiles;
    PanelCurve curve;
};
struct LensPush {
    std::uint32_t view, tiles, eye_width, eye_height;
    PanelCurve curve;
};
struct PanelPush {
    std::uint32_t pixels;
    PanelCurve curve;
};
struct SeenPush {
    std::uint32_t width, height;
    std::array<vec4, eye_count> fields;
    float black_cd_m2, white_cd_m2;
};

template <class T> Result<gpu::Buffer> upload_list(const gpu::Device& device, const std::vector<T>& list, const std::string& name) {
    ENTOPTIC_TRY(buffer, gpu::Buffer::create(device, std::max<std::size_t>(list.size(), 1) * sizeof(T), gpu::BufferKind::upload, name));
    std::copy(list.begin(), list.end(), buffer.template as<T>().begin());  // memcpy may not be given an empty list
    return buffer;
}

// `uniform` uniform buffers, then storage buffers.
std::vector<BindingKind> buffers(std::size_t uniform, std::size_t storage) {
    std::vector<BindingKind> kinds(uniform, BindingKind::uniform_buffer);
    kinds.insert(kinds.end(), storage, BindingKind::storage_buffer);
    return kinds;
}

template <class Push> std::span<const std::byte> bytes_of(const Push& push) { return std::as_bytes(std::span(&push, 1)); }

}  // namespace

gpu::Groups EyeGrids::Tiles::groups() const {
    if (count == 0) return {0, 0, 0};
    const std::uint32_t rows = gpu::groups_for(count, max_groups);
    return {gpu::groups_for(count, rows), rows, 1};
}

Result<EyeGrids> EyeGrids::create(const gpu::Device& device, const std::array<EyeGeometry, eye_count>& geometry, std::uint32_t tile_w,
                                  std::uint32_t tile_h, const std::string& name) {
    EyeGrids grids;
    grids.size_ = {geometry[0].width, geometry[0].height};
    ENTOPTIC_TRY(buffer, upload_list(device, std::vector(geometry.begin(), geometry.end()), name + " geometry"));
    grids.geometry_ = std::move(buffer);
    for (std::size_t eye = 0; eye < eye_count; ++eye) {
        const TileLists lists = tile_lists(geometry[eye], tile_w, tile_h);
        ENTOPTIC_TRY(shown, upload_list(device, lists.shown, name + " tiles"));
        ENTOPTIC_TRY(hidden, upload_list(device, lists.hidden, name + " hidden tiles"));
        grids.shown_[eye] = {std::move(shown), static_cast<std::uint32_t>(lists.shown.size())};
        grids.hidden_[eye] = {std::move(hidden), static_cast<std::uint32_t>(lists.hidden.size())};
    }
    return grids;
}

Result<LayerTable> LayerTable::create(gpu::Device& device) {
    LayerTable table;
    table.device_ = &device;
    ENTOPTIC_TRY(buffer, gpu::Buffer::create(device, eye_count * layer_slots * sizeof(LayerView), gpu::BufferKind::upload, "layers"));
    table.buffer_ = std::move(buffer);
    VkSamplerCreateInfo sampler{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    sampler.magFilter = sampler.minFilter = VK_FILTER_LINEAR;
    sampler.mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST;
    sampler.addressModeU = sampler.addressModeV = sampler.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    sampler.unnormalizedCoordinates = VK_TRUE;  // coordinates in texels: centres of texels are exact numbers
    ENTOPTIC_VK(vkCreateSampler(device.handle(), &sampler, nullptr, &table.sampler_));
    ENTOPTIC_CHECK(table.make_nothing());
    return table;
}

Result<void> LayerTable::make_nothing() {
    gpu::ImageInfo info;
    info.format = VK_FORMAT_R8G8B8A8_UNORM;
    info.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.name = "no layer";
    ENTOPTIC_TRY(image, gpu::Image::create(*device_, info));
    nothing_ = std::move(image);
    ENTOPTIC_TRY(view, nothing_.create_view(0, info.format, VK_IMAGE_ASPECT_COLOR_BIT));
    nothing_view_ = view;
    ENTOPTIC_TRY(commands, gpu::Commands::create(*device_, "no layer"));
    ENTOPTIC_CHECK(commands.begin());
    const VkImageSubresourceRange whole{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = nothing_.handle();
    barrier.subresourceRange = whole;
    vkCmdPipelineBarrier(commands.handle(), VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr, 1,
                         &barrier);
    const VkClearColorValue black{};
    vkCmdClearColorImage(commands.handle(), nothing_.handle(), VK_IMAGE_LAYOUT_GENERAL, &black, 1, &whole);
    commands.barrier();
    ENTOPTIC_CHECK(commands.submit());
    return commands.wait();
}

LayerTable::~LayerTable() {
    if (!device_) return;
    vkDestroyImageView(device_->handle(), nothing_view_, nullptr);
    vkDestroySampler(device_->handle(), sampler_, nullptr);
}

LayerTable& LayerTable::operator=(LayerTable&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(buffer_, other.buffer_);
    std::swap(sampler_, other.sampler_);
    std::swap(nothing_, other.nothing_);
    std::swap(nothing_view_, other.nothing_view_);
    std::swap(views_, other.views_);
    std::swap(images_, other.images_);
    std::swap(unique_, other.unique_);
    std::swap(has_float_, other.has_float_);
    std::swap(only_srgb8_, other.only_srgb8_);
    return *this;
}

void LayerTable::clear() {
    for (std::size_t eye = 0; eye < eye_count; ++eye) {
        views_[eye].clear();
        images_[eye].clear();
    }
    unique_.clear();
    has_float_ = false;
    only_srgb8_ = true;
}

bool LayerTable::within(const perception::DisplayRange& display) const {
    if (has_float_) return false;
    for (const auto& views : views_)
        for (const LayerView& view : views)
            if ((view.flags & layer_tinted) != 0 || !(view.offset_cd >= 0.999f * display.black_cd_m2 && view.cd_per_unit >= 0 &&
                                                      view.cd_per_unit + view.offset_cd <= 1.000001f * display.white_cd_m2))
                return false;
    return true;
}

bool LayerTable::is_special(int eye) const {
    const auto& views = views_[std::size_t(eye)];
    return std::any_of(views.begin(), views.end(), [](const LayerView& view) { return (view.flags & layer_special) != 0; });
}

bool LayerTable::add(int eye, const LayerView& view, const SampledImage& image) {
    auto& views = views_[std::size_t(eye)];
    if (views.size() >= layer_slots) return false;
    views.push_back(view);
    images_[std::size_t(eye)].push_back(image.view);
    has_float_ = has_float_ || image.is_float;
    only_srgb8_ = only_srgb8_ && image.is_srgb8;
    if (std::find(unique_.begin(), unique_.end(), image.image) == unique_.end()) unique_.push_back(image.image);
    return true;
}

void LayerTable::upload() {
    LayerView unseen{};
    unseen.low = vec2(1);  // above `high`: no texel is inside
    const auto slots = buffer_.as<LayerView>();
    std::fill(slots.begin(), slots.end(), unseen);
    for (std::size_t eye = 0; eye < eye_count; ++eye)
        std::copy(views_[eye].begin(), views_[eye].end(), slots.begin() + static_cast<std::ptrdiff_t>(eye * layer_slots));
}

void LayerTable::append_images(int eye, std::vector<gpu::Binding>& bindings) const {
    const auto& images = images_[std::size_t(eye)];
    for (std::size_t slot = 0; slot < layer_slots; ++slot)
        bindings.emplace_back(slot < images.size() ? images[slot] : nothing_view_, sampler_, VK_IMAGE_LAYOUT_GENERAL);
}

LayerKernels::LayerKernels(gpu::Device& device, std::string name, std::span<const std::uint32_t> spirv, std::uint32_t push_bytes,
                           bool achromatic, std::vector<std::uint32_t> more_constants, std::size_t more_buffers)
    : device_(&device),
      name_(std::move(name)),
      spirv_(spirv),
      push_bytes_(push_bytes),
      achromatic_(achromatic),
      more_constants_(std::move(more_constants)),
      more_buffers_(more_buffers) {}

Result<const gpu::Kernel*> LayerKernels::get(const LayerTable& layers, int eye) {
    const std::uint32_t slots = *std::lower_bound(slot_counts.begin(), slot_counts.end(), std::min(layers.count(eye), layer_slots));
    const bool clean_values = layers.has_float(), special = layers.is_special(eye);
    auto& kernel = kernels_[{slots, clean_values, special}];
    if (kernel) return &kernel;
    gpu::KernelInfo info;
    info.name = fmt::format("{} of {} layers{}{}", name_, slots, clean_values ? ", float" : "", special ? ", special" : "");
    info.spirv = spirv_;
    info.bindings = buffers(2, 3);
    info.bindings.insert(info.bindings.end(), layer_slots, BindingKind::sampled_image);
    info.bindings.insert(info.bindings.end(), more_buffers_, BindingKind::storage_buffer);
    info.push_constant_bytes = push_bytes_;
    info.specialization = {slots, clean_values, achromatic_, special};
    info.specialization.insert(info.specialization.end(), more_constants_.begin(), more_constants_.end());
    ENTOPTIC_TRY(created, gpu::Kernel::create(*device_, info));
    kernel = std::move(created);
    return &kernel;
}

Result<WarpPass> WarpPass::create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& geometry) {
    WarpPass pass;
    ENTOPTIC_TRY(grids, EyeGrids::create(device, geometry, tile_width, tile_height, "warp"));
    pass.grids_ = std::move(grids);
    pass.warp_ = LayerKernels(device, "warp", warp_comp_spv, sizeof(TilePush), false, {});
    ENTOPTIC_TRY(clear, gpu::Kernel::create(device, {"clear hidden tiles", clear_comp_spv, buffers(1, 2), sizeof(TilePush), {}}));
    pass.clear_ = std::move(clear);
    return pass;
}

Result<SceneImage> WarpPass::record(gpu::Commands& commands, const LayerTable& layers, const perception::Stage& stage) {
    for (int eye = 0; eye < eye_count; ++eye) {  // no barrier between the eyes: they may run at the same time
        ENTOPTIC_TRY(kernel, warp_.get(layers, eye));
        const auto& shown = grids_.shown(eye);
        std::vector<gpu::Binding> bindings{grids_.geometry(), layers.layers(), shown.list, stage.scene(),
                                           stage.scene()};  // binding 4 is the fused pass's
        layers.append_images(eye, bindings);
        commands.dispatch(*kernel, bindings, bytes_of(TilePush{std::uint32_t(eye), shown.count}), shown.groups());
        const auto& hidden = grids_.hidden(eye);
        commands.dispatch(clear_, {grids_.geometry(), hidden.list, stage.scene()}, TilePush{std::uint32_t(eye), hidden.count},
                          hidden.groups());
    }
    return SceneImage{&stage.scene(), grids_.size()};
}

Result<GlancePass> GlancePass::create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& geometry) {
    GlancePass pass;
    ENTOPTIC_TRY(grids, EyeGrids::create(device, geometry, tile_width, tile_height, "glance"));
    pass.grids_ = std::move(grids);
    pass.kernels_ = LayerKernels(device, "glance", glance_comp_spv, sizeof(TilePush), false, {}, 1);
    return pass;
}

Result<void> GlancePass::record(gpu::Commands& commands, const LayerTable& layers, const perception::Stage& stage) {
    const std::uint32_t tiles = stage.tiles_x() * stage.tiles_y();
    for (int eye = 0; eye < eye_count; ++eye) {
        ENTOPTIC_TRY(kernel, kernels_.get(layers, eye));
        std::vector<gpu::Binding> bindings{grids_.geometry(), layers.layers(), grids_.shown(eye).list, stage.tiles(), stage.solid_angle()};
        layers.append_images(eye, bindings);
        bindings.emplace_back(stage.scene());
        commands.dispatch(*kernel, bindings, bytes_of(TilePush{std::uint32_t(eye), tiles}), {gpu::groups_for(tiles, 64), 1, 1});
    }
    return {};
}

// Of 256 pixels each, in rows that no device finds too long.
gpu::Groups groups_of_pixels(std::uint32_t pixels) {
    const std::uint32_t groups = gpu::groups_for(pixels, 256), rows = gpu::groups_for(groups, max_groups);
    return {gpu::groups_for(groups, rows), rows, 1};
}

Result<LensPass> LensPass::create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& panel, PictureSize eye_size,
                                  LensFilter filter) {
    LensPass pass;
    pass.device_ = &device;
    ENTOPTIC_TRY(grids, EyeGrids::create(device, panel, tile_width, tile_height, "lens"));
    pass.grids_ = std::move(grids);
    const bool same_grid = eye_size.width == panel[0].width && eye_size.height == panel[0].height;
    const auto make = [&](bool to_codes) {
        return gpu::Kernel::create(
            device, {"lens", lens_comp_spv, buffers(1, 4), sizeof(LensPush), {filter == LensFilter::catmull_rom, same_grid, to_codes}});
    };
    ENTOPTIC_TRY(to_codes, make(true));
    ENTOPTIC_TRY(to_light, make(false));
    ENTOPTIC_TRY(panel_kernel, gpu::Kernel::create(device, {"panel", panel_comp_spv, buffers(0, 2), sizeof(PanelPush), {}}));
    pass.to_codes_ = std::move(to_codes);
    pass.to_light_ = std::move(to_light);
    pass.panel_ = std::move(panel_kernel);
    return pass;
}

void LensPass::dispatch(gpu::Commands& commands, const gpu::Kernel& kernel, SeenImage seen, const PanelCurve& curve,
                        const gpu::Buffer& codes) {
    const gpu::Buffer& light = light_ ? light_ : codes;  // a kernel writes only one of the two
    for (int eye = 0; eye < eye_count; ++eye) {
        const auto& shown = grids_.shown(eye);
        commands.dispatch(kernel, {grids_.geometry(), shown.list, *seen.pixels, light, codes},
                          LensPush{std::uint32_t(eye), shown.count, seen.size.width, seen.size.height, curve}, shown.groups());
    }
}

Result<void> LensPass::record_codes(gpu::Commands& commands, SeenImage seen, const PanelCurve& curve, PanelCodes out) {
    dispatch(commands, to_codes_, seen, curve, *out.codes);
    return {};
}

Result<PanelImage> LensPass::record_light(gpu::Commands& commands, SeenImage seen, const PanelCurve& curve) {
    const PictureSize size = grids_.size();
    if (!light_) {
        ENTOPTIC_TRY(light,
                     gpu::Buffer::create(*device_, eye_count * size.pixels() * sizeof(vec3), gpu::BufferKind::device, "panel light"));
        light_ = std::move(light);
        commands.fill(light_, 0);  // tiles that the lens hides are never written
        commands.barrier();
    }
    dispatch(commands, to_light_, seen, curve, light_);
    return PanelImage{&light_, size};
}

void LensPass::record_panel(gpu::Commands& commands, PanelImage light, const PanelCurve& curve, PanelCodes out) {
    const auto pixels = static_cast<std::uint32_t>(eye_count * out.size.pixels());
    commands.dispatch(panel_, {*light.light, *out.codes}, PanelPush{pixels, curve}, groups_of_pixels(pixels));
}

Result<MeasuredPanelPass> MeasuredPanelPass::create(gpu::Device& device, const std::array<MeasuredPanel, eye_count>& panels) {
    MeasuredPanelPass pass;
    ENTOPTIC_TRY(tables, gpu::Buffer::create(device, eye_count * sizeof(MeasuredPanelTable), gpu::BufferKind::upload, "measured panel"));
    for (std::size_t eye = 0; eye < eye_count; ++eye) {
        const MeasuredPanel& panel = panels[eye];
        if (!panel.has_three_primaries()) return failure("The measured primaries of the display are not three colours: one is a mixture of the others.");
        const glm::dmat3 shares = glm::inverse(glm::dmat3(panel.light[0], panel.light[1], panel.light[2]));
        MeasuredPanelTable& table = tables.as<MeasuredPanelTable>()[eye];
        for (int c = 0; c < 3; ++c) {
            const auto channel = static_cast<std::size_t>(c);
            std::copy(panel.curve[channel].begin(), panel.curve[channel].end(), table.share + 256 * channel);
            table.light[c] = panel.light[channel];
            table.share_of_light[c] = glm::dvec3(shares[0][c], shares[1][c], shares[2][c]);
        }
        table.black = panel.black;
    }
    ENTOPTIC_TRY(kernel, gpu::Kernel::create(device, {"measured panel", measured_panel_comp_spv, buffers(0, 3), sizeof(PanelPush), {}}));
    pass.tables_ = std::move(tables);
    pass.kernel_ = std::move(kernel);
    return pass;
}

void MeasuredPanelPass::record(gpu::Commands& commands, PanelImage light, const PanelCurve& curve, PanelCodes out) {
    const auto pixels = static_cast<std::uint32_t>(eye_count * out.size.pixels());
    commands.dispatch(kernel_, {tables_, *light.light, *out.codes}, PanelPush{pixels, curve}, groups_of_pixels(pixels));
}

Result<FusedPass> FusedPass::create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& panel) {
    FusedPass pass;
    ENTOPTIC_TRY(grids, EyeGrids::create(device, panel, fused_width, fused_height, "fused"));
    pass.grids_ = std::move(grids);
    const bool achromatic = is_achromatic(panel[0]) && is_achromatic(panel[1]);
    pass.kernels_ = LayerKernels(device, "fused", fused_comp_spv, sizeof(FusedPush), achromatic, {fused_width, fused_height});
    ENTOPTIC_TRY(cleaned, gpu::Buffer::create(device, eye_count * sizeof(std::uint32_t), gpu::BufferKind::device, "cleaned"));
    ENTOPTIC_TRY(readback, gpu::Buffer::create(device, eye_count * sizeof(std::uint32_t), gpu::BufferKind::readback, "cleaned readback"));
    pass.cleaned_ = std::move(cleaned);
    pass.cleaned_readback_ = std::move(readback);
    return pass;
}

Result<void> FusedPass::record(gpu::Commands& commands, const LayerTable& layers, const PanelCurve& curve, PanelCodes out) {
    commands.fill(cleaned_, 0);
    commands.barrier();
    for (int eye = 0; eye < eye_count; ++eye) {
        ENTOPTIC_TRY(kernel, kernels_.get(layers, eye));
        const auto& shown = grids_.shown(eye);
        std::vector<gpu::Binding> bindings{grids_.geometry(), layers.layers(), shown.list, *out.codes, cleaned_};
        layers.append_images(eye, bindings);
        commands.dispatch(*kernel, bindings, bytes_of(FusedPush{std::uint32_t(eye), shown.count, curve}), shown.groups());
    }
    commands.barrier();
    commands.copy(cleaned_, cleaned_readback_, cleaned_.size());
    return {};
}

std::array<std::uint32_t, eye_count> FusedPass::cleaned() const {
    const auto counts = cleaned_readback_.as<std::uint32_t>();
    return {counts[0], counts[1]};
}

Result<SeenThroughLensPass> SeenThroughLensPass::create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& panel,
                                                        PictureSize size, bool measured) {
    SeenThroughLensPass pass;
    pass.size_ = size;
    ENTOPTIC_TRY(grids, EyeGrids::create(device, panel, tile_width, tile_height, "seen"));
    ENTOPTIC_TRY(kernel, gpu::Kernel::create(device, {"seen through the lens", seen_comp_spv, buffers(1, 3), sizeof(SeenPush), {measured ? 1u : 0u}}));
    ENTOPTIC_TRY(picture,
                 gpu::Buffer::create(device, eye_count * size.pixels() * sizeof(std::uint32_t), gpu::BufferKind::device, "seen picture"));
    pass.grids_ = std::move(grids);
    pass.kernel_ = std::move(kernel);
    pass.picture_ = std::move(picture);
    for (std::size_t eye = 0; eye < eye_count; ++eye)
        pass.fields_[eye] = {panel[eye].tan_left, panel[eye].tan_right, panel[eye].tan_up, panel[eye].tan_down};
    return pass;
}

void SeenThroughLensPass::record(gpu::Commands& commands, PanelCodes codes, const gpu::Buffer& tables, perception::DisplayRange display) {
    commands.dispatch(kernel_, {grids_.geometry(), *codes.codes, picture_, tables},
                      SeenPush{size_.width, size_.height, fields_, display.black_cd_m2, display.white_cd_m2},
                      {gpu::groups_for(size_.width, 32), gpu::groups_for(size_.height, 8), eye_count});
}

}  // namespace entoptic::compositor
