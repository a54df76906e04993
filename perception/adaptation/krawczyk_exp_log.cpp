#include "perception/adaptation/krawczyk_exp_log_math.glsl"
#include "perception/adaptation/adaptation_model.h"

#include "perception/adaptation/krawczyk_exp_log.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"sigma_gaze_deg", "deg", 0.5f, 30, 2.5f, "choice: the papers give no width", "how far around the gaze light drives adaptation"},
    {"wide_share", "1", 0, 0.3f, 0.08f, "Moon and Spencer 1945", "share of the whole field's mean; counts when retinal is 0"},
    {"floor_cd_m2", "cd/m²", 1e-6f, 100, 1e-6f, "Jacobs 2015 (100 in an office); 1e-6 is none", "the eye never adapts below this"},
    {"clip_over_median", "1", 10, 1e8f, 1e4f, "choice: a sun of 7x7 pixels must not own the mean", "brightest tile over the median tile that counts"},
    {"retinal", "bool", 0, 1, 1, "CIE 146:2002", "1: driven by the light on the fovea, with the straylight of the whole field; 0: by the scene's"},
    {"speed", "1", 0.05f, 20, 1, "choice: demonstrations", "multiplies time"},
    {"tau_rod_s", "s", 0.05f, 5, 0.4f, "Luidolt 2020, equation 3", "time constant of rod vision"},
    {"tau_cone_s", "s", 0.02f, 2, 0.1f, "Luidolt 2020, equation 3", "time constant of cone vision"},
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
