// The passes that the models of the slot `dof` share; a model brings its own two kernels, which say how wide each pixel's disc is.
#pragma once

#include "perception/dof/dof_gpu.h"
#include "perception/model.h"

#include <string>

namespace entoptic::perception {

// What a model asks of the passes in a frame.
struct DofSettings {
    float focus_dioptre = -1;    // fixed focus; negative: what the eyes look at
    bool use_vergence = false;   // if it is measured
    float focus_tau_s = 0.3f;
    uint colours = dof_colours_alike;
    bool roulette = false;
};

class DofPasses {
public:
    // `range` and `pixels`: <model>_range.comp and <model>_pixels.comp, with push constants of `params_bytes` and the picture's size.
    static Result<DofPasses> create(const ModelContext& context, const std::string& name, std::span<const std::uint32_t> range,
                                    std::span<const std::uint32_t> pixels, std::uint32_t params_bytes);
    // `params`: the model's parameter struct.
    Result<void> record(StageIo& io, const DofSettings& settings, std::span<const std::byte> params);
    // As Model::take_over().
    void take_over(gpu::Commands& commands, const DofPasses& from) { commands.copy(from.focus_, focus_, focus_.size()); }

private:
    struct Gathering {
        gpu::Kernel gather;
        uint colours;
        bool roulette;
    };
    Result<void> make_buffers();
    Result<const gpu::Kernel*> gathering(const DofSettings& settings);
    void write_eyes(const FrameInput& input);
    void record_focus(StageIo& io, const DofSettings& settings);

    gpu::Device* device_ = nullptr;
    std::vector<EyeGeometry> views_;
    std::string name_;
    gpu::Kernel focus_kernel_, range_, pixels_kernel_, plan_, resolve_, resolve_smooth_;
    std::vector<Gathering> gatherings_;      // made when first wanted
    gpu::Buffer eyes_, focus_;               // DofEye a view; DofFocus
    gpu::Buffer tile_radius_, reach_, list_; // float a tile; float a tile; see dof_list.glsl
    gpu::Buffer pixels_, blurred_;           // DofPixel and vec4 a pixel
};

}  // namespace entoptic::perception
