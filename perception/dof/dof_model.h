// The C++ side of the models of the slot `dof` whose kernels are dof_passes.h's, and the parameters that they share.
#pragma once

#include "perception/dof/dof.h"
#include "perception/dof/dof_passes.h"

#include <cstring>

namespace entoptic::perception {

namespace dof_parameters {
inline constexpr ParameterInfo strength{"strength", "1", 0, 1, 1, "choice: taste", "multiplies the width of the blur; 0 switches it off"};
inline constexpr ParameterInfo focus_dioptre{
    "focus_dioptre", "1/m", -1, 20, -1, "choice: negative is the eye's own", "fixed focus; negative: the eyes focus on what they look at"};
inline constexpr ParameterInfo use_vergence{
    "use_vergence", "bool", 0, 1, 0, "choice: 1 degree of error is 0.28 dioptre", "1 focuses where the lines of sight meet, when measured"};
inline constexpr ParameterInfo focus_tau_s{
    "focus_tau_s", "s", 0.01f, 5, 0.3f, "choice: accommodation takes 0.3 to 1 s", "time constant with which the focus follows"};
inline constexpr ParameterInfo roulette{
    "roulette", "bool", 0, 1, 0, "Liu 2021, equations 10 and 11", "1 samples wide discs: faster, with some noise"};
}  // namespace dof_parameters

// `Params` is the model's parameter struct, which has the parameters above and `lca`; `coloured` what its `lca` colours.
template <class Params, uint coloured> class DofModel final : public Model, public NeedsDepth {
public:
    // As DofPasses::create().
    static Result<std::unique_ptr<Model>> create(const ModelContext& context, const std::string& name, std::span<const std::uint32_t> range,
                                                 std::span<const std::uint32_t> pixels) {
        auto model = std::make_unique<DofModel>();
        ENTOPTIC_TRY(passes, DofPasses::create(context, name, range, pixels, sizeof(Params)));
        model->passes_ = std::move(passes);
        return model;
    }
    void set_parameters(std::span<const float> values) override { std::memcpy(&params_, values.data(), sizeof params_); }
    bool is_identity() const override { return params_.strength == 0; }
    void take_over(gpu::Commands& commands, Model& from) override { passes_.take_over(commands, static_cast<DofModel&>(from).passes_); }
    Result<void> record(StageIo& io) override {
        const DofSettings settings{params_.focus_dioptre, params_.use_vergence > 0.5f, params_.focus_tau_s,
                                   params_.lca > 0.5f ? coloured : dof_colours_alike, params_.roulette > 0.5f};
        return passes_.record(io, settings, std::as_bytes(std::span(&params_, 1)));
    }

private:
    DofPasses passes_;
    Params params_{};
};

}  // namespace entoptic::perception
