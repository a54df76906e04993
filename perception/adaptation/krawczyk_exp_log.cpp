#include "perception/adaptation/krawczyk_exp_log_math.glsl"
#include "perception/adaptation/adaptation_model.h"

#include "perception/adaptation/krawczyk_exp_log.comp.h"

namespace entoptic::perception {
namespace {

using namespace adaptation_parameters;

constexpr ParameterInfo parameters[] = {
    sigma_gaze_deg,
    wide_share,
    floor_cd_m2,
    clip_over_median,
    retinal(1),
    speed,
    tau_rod_s,
    tau_cone_s,
};
static_assert(sizeof(KrawczykExpLogParams) == sizeof(float) * std::size(parameters));

Result<std::unique_ptr<Model>> create(const ModelContext& context) {
    return AdaptationModel<KrawczykExpLogParams>::create(context, "adaptation.krawczyk_exp_log", krawczyk_exp_log_comp_spv, &krawczyk_exp_log::gaze_of);
}

}  // namespace

std::unique_ptr<ReferenceModel> make_krawczyk_exp_log_reference();

extern const ModelEntry krawczyk_exp_log_entry;
const ModelEntry krawczyk_exp_log_entry{"adaptation", "krawczyk_exp_log", "Exponential adaptation of the logarithm of luminance around the gaze", parameters, &create, &make_krawczyk_exp_log_reference};

}  // namespace entoptic::perception
