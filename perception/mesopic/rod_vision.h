// What the models of rod vision on scene light share: the gate, local means, their shares of the cones, and the operator for each pixel.
#pragma once

#include "perception/local_mean.h"
#include "perception/mesopic/mesopic.h"
#include "perception/mesopic/rod_vision_weights.h"

#include <functional>
#include <glm/glm.hpp>
#include <optional>

namespace entoptic::perception {

// The model's own kernels, made of rod_vision_gate.glsl, rod_vision_map.glsl and rod_vision_pixels.glsl.
struct RodVisionShaders {
    const char* name;
    std::span<const std::uint32_t> gate, map, pixels;
};

class RodVisionModel : public Model {
public:
    Result<void> make(const ModelContext& context, const RodVisionShaders& shaders);
    Result<void> record(StageIo& io) override;

protected:
    // Parameters as the shaders' struct, all floats, `parameter_count` of them.
    static constexpr std::size_t parameter_count = 7;
    float parameters_[parameter_count] = {};
    float local_mean_deg_ = 0;
    RodVision rods_{};

private:
    std::optional<LocalMean> mean_;
    gpu::Kernel gate_, map_, pixels_;
};

// The operator in double by its definition, with none of the shaders' code: for the references.
struct RodVisionLaw {
    glm::dvec3 scotopic{};                            // weights of linear BT.709
    double gain = 1, rod_lumen = 1;
    glm::dvec3 tint{};                                // any luminance
    double strength = 1, local_mean_deg = 2;
    bool photographic = false;
    std::function<double(double)> cone_share;         // of luminance, cd/m²
};
void apply_rod_vision(ReferenceFrame& frame, const RodVisionLaw& law);

}  // namespace entoptic::perception
