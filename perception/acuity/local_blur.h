// What the acuity models that go by local means share: the gate, local means, variances of a blur at their nodes, and the blur of the tiles
// that need it.
#pragma once

#include "perception/acuity/acuity.h"
#include "perception/local_mean.h"

#include <functional>
#include <optional>

namespace entoptic::perception {

// The model's own kernels, made of local_blur_gate.glsl and local_blur_map.glsl.
struct LocalBlurShaders {
    const char* name;
    std::span<const std::uint32_t> gate, map;
};

class LocalBlurModel : public Model {
public:
    Result<void> make(const ModelContext& context, const LocalBlurShaders& shaders);
    Result<void> record(StageIo& io) override;
    void take_over(gpu::Commands&, Model& from) override { ticks_ = static_cast<LocalBlurModel&>(from).ticks_; }

protected:
    static constexpr std::size_t parameter_count = 8;
    float parameters_[parameter_count] = {};   // as the shaders' struct, at most that many
    float local_mean_deg_ = 2, rate_hz_ = 6;

private:
    void record_blur(StageIo& io);

    std::optional<LocalMean> mean_;
    gpu::Buffer widest_;    // px², a float a tile
    gpu::Buffer lists_;     // of tiles, and their lengths
    gpu::Buffer plane_;     // vec4 a pixel: the picture's rows blurred, and the share that was visible
    gpu::Kernel gate_, map_, tiles_, plan_, rows_, columns_;
    float largest_ppd_ = 0;
    std::uint32_t seed_ = 0;
    double ticks_ = 0;      // of the noise's clock
};

// The blur in double by its definition, with none of the shaders' code: one 2-D sum a pixel, the width from the pixel's own local mean.
struct LocalBlurLaw {
    double local_mean_deg = 2, cell_deg = 0.7, ticks = 0;
    bool noisy = false;
    // Variance to add, arcmin²: of luminance in the scene and on the panel (cd/m²), noise, eccentricity (°), pixels per degree.
    std::function<double(double scene, double panel, double noise, double eccentricity_deg, double ppd)> added_variance;
};
void apply_local_blur(ReferenceFrame& frame, const LocalBlurLaw& law);

}  // namespace entoptic::perception
