#include "perception/adaptation/jacobs_ramp_math.glsl"
#include "perception/adaptation/adaptation_model.h"

#include "perception/adaptation/jacobs_ramp.comp.h"

namespace entoptic::perception {
namespace {

using namespace adaptation_parameters;

constexpr ParameterInfo parameters[] = {
    sigma_gaze_deg,
    wide_share,
    floor_cd_m2,
    clip_over_median,
    retinal(0),
    speed,
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
