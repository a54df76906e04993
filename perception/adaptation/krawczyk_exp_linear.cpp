#include "perception/adaptation/krawczyk_exp_linear_math.glsl"
#include "perception/adaptation/adaptation_model.h"

#include "perception/adaptation/krawczyk_exp_linear.comp.h"

namespace entoptic::perception {
namespace {

using namespace adaptation_parameters;

constexpr ParameterInfo parameters[] = {
    sigma_gaze_deg,
    {"wide_share", "1", 0, 0.3f, 0.08f, "Moon and Spencer 1945", "share of the whole field's mean, which veils the fovea"},
    tau_rod_s,
    tau_cone_s,
    speed,
    floor_cd_m2,
    clip_over_median,
    {"as_printed", "bool", 0, 1, 0, "Luidolt 2020, section 4.1", "1 does not normalise the gaze weights (trap L2)"},
};
static_assert(sizeof(KrawczykExpLinearParams) == sizeof(float) * std::size(parameters));

Result<std::unique_ptr<Model>> create(const ModelContext& context) {
    return AdaptationModel<KrawczykExpLinearParams>::create(context, "adaptation.krawczyk_exp_linear", krawczyk_exp_linear_comp_spv,
                                                            &krawczyk_exp_linear::gaze_of);
}

}  // namespace

std::unique_ptr<ReferenceModel> make_krawczyk_exp_linear_reference();

extern const ModelEntry krawczyk_exp_linear_entry;
const ModelEntry krawczyk_exp_linear_entry{
    "adaptation", "krawczyk_exp_linear",      "Exponential adaptation to the luminance around the gaze (Krawczyk 2005)",
    parameters,   &create, &make_krawczyk_exp_linear_reference};

}  // namespace entoptic::perception
