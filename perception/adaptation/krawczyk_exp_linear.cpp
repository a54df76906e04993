#include "perception/adaptation/krawczyk_exp_linear_math.glsl"
#include "perception/adaptation/adaptation_model.h"

#include "perception/adaptation/krawczyk_exp_linear.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"sigma_gaze_deg", "deg", 0.5f, 30, 2.5f, "choice: Luidolt 2020, section 4.1 gives no width",
     "how far around the gaze light drives adaptation"},
    {"wide_share", "1", 0, 0.3f, 0.08f, "Moon and Spencer 1945", "share of the whole field's mean, which veils the fovea"},
    {"tau_rod_s", "s", 0.05f, 5, 0.4f, "Luidolt 2020, equation 3", "time constant of rod vision"},
    {"tau_cone_s", "s", 0.02f, 2, 0.1f, "Luidolt 2020, equation 3", "time constant of cone vision"},
    {"speed", "1", 0.05f, 20, 1, "choice: demonstrations", "multiplies time"},
    {"floor_cd_m2", "cd/m²", 1e-6f, 100, 1e-6f, "Jacobs 2015 (100 in an office); 1e-6 is none", "the eye never adapts below this"},
    {"clip_over_median", "1", 10, 1e8f, 1e4f, "choice: a sun of 7x7 pixels must not own the mean",
     "brightest tile over the median tile that counts"},
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
