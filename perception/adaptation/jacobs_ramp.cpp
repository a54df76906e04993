#include "perception/adaptation/jacobs_ramp_math.glsl"
#include "perception/adaptation/adaptation_model.h"

#include "perception/adaptation/jacobs_ramp.comp.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"sigma_gaze_deg", "deg", 0.5f, 30, 2.5f, "choice: the papers give no width", "how far around the gaze light drives adaptation"},
    {"wide_share", "1", 0, 0.3f, 0.08f, "Moon and Spencer 1945", "share of the whole field's mean; counts when retinal is 0"},
    {"floor_cd_m2", "cd/m²", 1e-6f, 100, 1e-6f, "Jacobs 2015 (100 in an office); 1e-6 is none", "the eye never adapts below this"},
    {"clip_over_median", "1", 10, 1e8f, 1e4f, "choice: a sun of 7x7 pixels must not own the mean", "brightest tile over the median tile that counts"},
    {"retinal", "bool", 0, 1, 0, "CIE 146:2002", "1: driven by the light on the fovea, with the straylight of the whole field; 0: by the scene's"},
    {"speed", "1", 0.05f, 20, 1, "choice: demonstrations", "multiplies time"},
    {"up_log10_per_s", "1/s", 0.05f, 10, 0.75f, "Jacobs 2015, equation 3 (a1)", "log10 units a second towards brighter light"},
    {"down_log10_per_s", "1/s", 0.05f, 10, 0.2f, "Jacobs 2015, equation 3 (a2)", "log10 units a second into the dark"},
};
static_assert(sizeof(JacobsRampParams) == sizeof(float) * std::size(parameters));

Result<std::unique_ptr<Model>> create(const ModelContext& context) {
    return AdaptationModel<JacobsRampParams>::create(context, "adaptation.jacobs_ramp", jacobs_ramp_comp_spv, &jacobs_ramp::gaze_of);
}

}  // namespace

std::unique_ptr<ReferenceModel> make_jacobs_ramp_reference();

extern const ModelEntry jacobs_ramp_entry;
const ModelEntry jacobs_ramp_entry{"adaptation", "jacobs_ramp", "Adaptation at constant speed in log luminance (Jacobs 2015)", parameters, &create, &make_jacobs_ramp_reference};

}  // namespace entoptic::perception
