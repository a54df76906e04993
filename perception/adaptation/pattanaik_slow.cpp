#include "perception/adaptation/pattanaik_slow_math.glsl"
#include "perception/adaptation/adaptation_model.h"
#include "perception/adaptation/pattanaik_slow_memory.h"

#include "perception/adaptation/pattanaik_slow.comp.h"

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
