#include "perception/adaptation/pattanaik_slow_math.glsl"
#include "perception/adaptation/adaptation_model.h"
#include "perception/adaptation/pattanaik_slow_memory.h"

#include "perception/adaptation/pattanaik_slow.comp.h"

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
    {"time_lapse", "1", 1, 100, 1, "choice: demonstrations", "multiplies time for the pigments only: dark adaptation in a minute"},
};
static_assert(sizeof(PattanaikSlowParams) == sizeof(float) * std::size(parameters));

Result<std::unique_ptr<Model>> create(const ModelContext& context) {
    return AdaptationModel<PattanaikSlowParams>::create(context, "adaptation.pattanaik_slow", pattanaik_slow_comp_spv, &pattanaik_slow::gaze_of,
                                                 sizeof(PattanaikSlowMemory));
}

}  // namespace

std::unique_ptr<ReferenceModel> make_pattanaik_slow_reference();

extern const ModelEntry pattanaik_slow_entry;
const ModelEntry pattanaik_slow_entry{"adaptation", "pattanaik_slow", "Fast adaptation that waits for bleached pigment: minutes of dark adaptation (Pattanaik 2000)", parameters, &create, &make_pattanaik_slow_reference};

}  // namespace entoptic::perception
