// The compositor's compute passes. Each owns its kernels and the buffers it writes; FramePath puts them in order and between them the
// barriers. Buffers hold both eyes, left first.
#pragma once

#include "compositor/images.h"
#include "compositor/layer_view.h"
#include "compositor/panel_curve.h"
#include "interfaces/headset.h"
#include "compositor/pictures.h"
#include "gpu/commands.h"
#include "interfaces/headset.h"
#include "interfaces/layers.h"
#include "perception/stage.h"
#include "shaders/eye_geometry.h"

#include <array>
#include <map>
#include <vector>

namespace entoptic::compositor {

// Geometry and tiles of both eyes on one grid, on the GPU.
class EyeGrids {
public:
    static Result<EyeGrids> create(const gpu::Device& device, const std::array<EyeGeometry, eye_count>& geometry, std::uint32_t tile_w,
                                   std::uint32_t tile_h, const std::string& name);

    struct Tiles {
        gpu::Buffer list;
        std::uint32_t count = 0;
        gpu::Groups groups() const;
    };
    const gpu::Buffer& geometry() const { return geometry_; }
    const Tiles& shown(int eye) const { return shown_[std::size_t(eye)]; }
    const Tiles& hidden(int eye) const { return hidden_[std::size_t(eye)]; }
    PictureSize size() const { return size_; }

private:
    gpu::Buffer geometry_;
    std::array<Tiles, eye_count> shown_, hidden_;
    PictureSize size_;
};

// The layers of one frame as the shaders read them: up to layer_slots views of layers an eye, and their images.
class LayerTable {
public:
    static Result<LayerTable> create(gpu::Device& device);
    LayerTable() = default;
    ~LayerTable();
    LayerTable(LayerTable&& other) noexcept { *this = std::move(other); }
    LayerTable& operator=(LayerTable&& other) noexcept;

    void clear();
    // Adds the next layer of one eye, over those before.
    // False when all slots are taken: the layer is left out.
    bool add(int eye, const LayerView& view, const SampledImage& image);
    // Writes what add() collected to the GPU's memory; call once a frame when the batch before was waited for.
    void upload();

    std::uint32_t count(int eye) const { return static_cast<std::uint32_t>(images_[std::size_t(eye)].size()); }
    bool has_float() const { return has_float_; }
    // Some layer of the eye needs the kernels that curve, average, tint and replace.
    bool is_special(int eye) const;
    // All layers are 8-bit codes of the panel's own curve: what is between two codes is a product of resampling only.
    bool only_srgb8() const { return only_srgb8_; }
    // The formats and scales of all layers keep their light within the panel's range: no pixel has to be looked at to know.
    bool within(const perception::DisplayRange& display) const;
    const std::vector<VkImage>& images() const { return unique_; }  // each once
    // Bindings 1 and 5..20 of layers.glsl.
    gpu::Binding layers() const { return buffer_; }
    void append_images(int eye, std::vector<gpu::Binding>& bindings) const;

private:
    Result<void> make_nothing();

    gpu::Device* device_ = nullptr;
    gpu::Buffer buffer_;
    VkSampler sampler_ = VK_NULL_HANDLE;
    gpu::Image nothing_;  // stands in unused slots
    VkImageView nothing_view_ = VK_NULL_HANDLE;
    std::array<std::vector<LayerView>, eye_count> views_;
    std::array<std::vector<VkImageView>, eye_count> images_;
    std::vector<VkImage> unique_;
    bool has_float_ = false, only_srgb8_ = true;
};

// Kernels of one shader that includes layers.glsl, specialised for the number of layers; made when first wanted.
class LayerKernels {
public:
    LayerKernels() = default;
    // `more_buffers`: storage buffers after the images.
    LayerKernels(gpu::Device& device, std::string name, std::span<const std::uint32_t> spirv, std::uint32_t push_bytes, bool achromatic,
                 std::vector<std::uint32_t> more_constants, std::size_t more_buffers = 0);
    // For the layers of one eye.
    Result<const gpu::Kernel*> get(const LayerTable& layers, int eye);

private:
    gpu::Device* device_ = nullptr;
    std::string name_;
    std::span<const std::uint32_t> spirv_;
    std::uint32_t push_bytes_ = 0;
    bool achromatic_ = false;
    std::vector<std::uint32_t> more_constants_;
    std::size_t more_buffers_ = 0;
    std::map<std::tuple<std::uint32_t, bool, bool>, gpu::Kernel> kernels_;  // slots, clean values, special
};

// Layers → SceneImage.
class WarpPass {
public:
    static Result<WarpPass> create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& geometry);
    // Writes stage.scene(), on the grid of `geometry`, which the stage was made with too.
    Result<SceneImage> record(gpu::Commands& commands, const LayerTable& layers, const perception::Stage& stage);

private:
    EyeGrids grids_;
    LayerKernels warp_;
    gpu::Kernel clear_;
};

// Layers → statistics of the scene's tiles, from a few points of each: what an eye that is shown the layers as they are adapts to.
class GlancePass {
public:
    static Result<GlancePass> create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& geometry);
    // Writes stage.tiles(), and the glanced points of stage.scene(), on the grid of `geometry`, which the stage was made with too.
    Result<void> record(gpu::Commands& commands, const LayerTable& layers, const perception::Stage& stage);

private:
    EyeGrids grids_;
    LayerKernels kernels_;
};

using MeasuredPanels = std::shared_ptr<const std::array<MeasuredPanel, eye_count>>;

// PanelImage → PanelCodes of a display that was measured.
class MeasuredPanelPass {
public:
    // Fails where a channel of `panels` sends no light of its own, so that no codes could be found.
    static Result<MeasuredPanelPass> create(gpu::Device& device, const std::array<MeasuredPanel, eye_count>& panels);
    void record(gpu::Commands& commands, PanelImage light, const PanelCurve& curve, PanelCodes out);
    const gpu::Buffer& tables() const { return tables_; }

private:
    gpu::Buffer tables_;
    gpu::Kernel kernel_;
};

enum class LensFilter { bilinear, catmull_rom };

// SeenImage → PanelImage, or straight to PanelCodes.
class LensPass {
public:
    static Result<LensPass> create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& panel, PictureSize eye_size,
                                   LensFilter filter);
    Result<void> record_codes(gpu::Commands& commands, SeenImage seen, const PanelCurve& curve, PanelCodes out);
    // The light buffer is made when first wanted.
    Result<PanelImage> record_light(gpu::Commands& commands, SeenImage seen, const PanelCurve& curve);
    // The second half on its own.
    void record_panel(gpu::Commands& commands, PanelImage light, const PanelCurve& curve, PanelCodes out);

private:
    void dispatch(gpu::Commands& commands, const gpu::Kernel& kernel, SeenImage seen, const PanelCurve& curve, const gpu::Buffer& codes);

    gpu::Device* device_ = nullptr;
    EyeGrids grids_;
    gpu::Kernel to_codes_, to_light_, panel_;
    gpu::Buffer light_;
};

// Layers → PanelCodes in one pass.
class FusedPass {
public:
    static Result<FusedPass> create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& panel);
    Result<void> record(gpu::Commands& commands, const LayerTable& layers, const PanelCurve& curve, PanelCodes out);
    // Pixels of each eye that were not finite or negative, of the batch waited for last.
    std::array<std::uint32_t, eye_count> cleaned() const;

private:
    EyeGrids grids_;
    LayerKernels kernels_;
    gpu::Buffer cleaned_, cleaned_readback_;
};

// PanelCodes → what each eye sees through its lens, in a flat view of its field; packed 8-bit sRGB relative to the panel's white.
class SeenThroughLensPass {
public:
    static Result<SeenThroughLensPass> create(gpu::Device& device, const std::array<EyeGeometry, eye_count>& panel, PictureSize size, bool measured = false);
    // `tables`: of a measured panel; any buffer else.
    void record(gpu::Commands& commands, PanelCodes codes, const gpu::Buffer& tables, perception::DisplayRange display);
    const gpu::Buffer& picture() const { return picture_; }
    PictureSize size() const { return size_; }

private:
    EyeGrids grids_;
    gpu::Kernel kernel_;
    gpu::Buffer picture_;
    std::array<vec4, eye_count> fields_{};
    PictureSize size_;
};

}  // namespace entoptic::compositor
