// The C++ side of every adaptation model: one workgroup a view, always recorded.
#pragma once

#include "perception/adaptation/adaptation.h"
#include "perception/adaptation/gaze_luminance.glsl"

#include <algorithm>
#include <cstring>

namespace entoptic::perception {

// The parameters that the models share.
namespace adaptation_parameters {
inline constexpr ParameterInfo sigma_gaze_deg{
    "sigma_gaze_deg", "deg", 0.5f, 30, 2.5f, "choice: the papers give no width", "how far around the gaze light drives adaptation"};
inline constexpr ParameterInfo wide_share{
    "wide_share", "1", 0, 0.3f, 0.08f, "Moon and Spencer 1945", "share of the whole field's mean; counts when retinal is 0"};
inline constexpr ParameterInfo floor_cd_m2{
    "floor_cd_m2", "cd/m²", 1e-6f, 100, 1e-6f, "Jacobs 2015 (100 in an office); 1e-6 is none", "the eye never adapts below this"};
inline constexpr ParameterInfo clip_over_median{"clip_over_median", "1", 10, 1e8f, 1e4f, "choice: a sun of 7x7 pixels must not own the mean",
                                                "brightest tile over the median tile that counts"};
constexpr ParameterInfo retinal(float by_default) {
    return {"retinal", "bool", 0, 1, by_default, "CIE 146:2002",
            "1: driven by the light on the fovea, with the straylight of the whole field; 0: by the scene's"};
}
inline constexpr ParameterInfo speed{"speed", "1", 0.05f, 20, 1, "choice: demonstrations", "multiplies time"};
inline constexpr ParameterInfo tau_rod_s{"tau_rod_s", "s", 0.05f, 5, 0.4f, "Luidolt 2020, equation 3", "time constant of rod vision"};
inline constexpr ParameterInfo tau_cone_s{"tau_cone_s", "s", 0.02f, 2, 0.1f, "Luidolt 2020, equation 3", "time constant of cone vision"};
}  // namespace adaptation_parameters

// `Params` is the model's parameter struct, `gaze_of` its GazeParams. `memory_bytes` of state a view that the model keeps for itself, zeroed
// at creation, come as binding 6.
template <class Params> class AdaptationModel final : public Model {
public:
    using GazeOf = GazeParams (*)(Params);
    static Result<std::unique_ptr<Model>> create(const ModelContext& context, const char* name, std::span<const std::uint32_t> spirv, GazeOf gaze_of,
                                                 std::size_t memory_bytes = 0) {
        auto model = std::make_unique<AdaptationModel>();
        std::vector<gpu::BindingKind> bindings(memory_bytes > 0 ? 7 : 6, gpu::BindingKind::storage_buffer);
        ENTOPTIC_TRY(kernel, gpu::Kernel::create(context.device, {name, spirv, bindings, sizeof(Push), {}}));
        model->kernel_ = std::move(kernel);
        model->views_ = context.views;
        model->gaze_of_ = gaze_of;
        if (memory_bytes == 0) return model;
        ENTOPTIC_TRY(memory, gpu::Buffer::create(context.device, memory_bytes * context.views.size(), gpu::BufferKind::upload, name));
        std::memset(memory.bytes().data(), 0, memory.size());
        model->memory_ = std::move(memory);
        return model;
    }
    void set_parameters(std::span<const float> values) override { std::memcpy(&params_, values.data(), sizeof params_); }
    bool obeys_residual_law() const override { return true; }
    void take_over(gpu::Commands& commands, Model& from) override {
        if (memory_) commands.copy(static_cast<AdaptationModel&>(from).memory_, memory_, memory_.size());
    }
    Result<void> record(StageIo& io) override {
        // No step for dt <= 0 and NaN. An infinite one would be 0 times infinity in the series.
        const float dt_s = io.input.dt_s > 0 ? static_cast<float>(std::min(io.input.dt_s, 1e6)) : 0.0f;
        for (std::uint32_t view = 0; view < io.views; ++view) {
            const EyeInput& eye = io.input.eyes[view];
            const vec3 gaze(gaze::gaze_in_view(views_[view], glm::dvec3(eye.gaze_direction)));
            const Push push{params_, gaze, dt_s, view, io.tiles_x, io.tiles_y, io.input.snap ? 1u : 0u, !(eye.eyelid_open >= lid_counts_as_closed),
                            gaze_of_(params_).retinal > 0.5f, io.input.glanced};
            if (memory_)
                io.commands.dispatch(kernel_, {io.tiles, io.geometry, io.statistics, io.state, io.scene, io.solid_angle, memory_}, push, {1, 1, 1});
            else
                io.commands.dispatch(kernel_, {io.tiles, io.geometry, io.statistics, io.state, io.scene, io.solid_angle}, push, {1, 1, 1});
        }
        return {};
    }

private:
    struct Push {
        Params params;
        vec3 gaze;
        float dt_s;
        uint view, tiles_x, tiles_y, snap, lid_closed, veil, glanced;
    };
    static constexpr float lid_counts_as_closed = 0.5f;

    gpu::Kernel kernel_;
    gpu::Buffer memory_;
    Params params_{};
    GazeOf gaze_of_ = nullptr;
    std::vector<EyeGeometry> views_;
};

}  // namespace entoptic::perception
