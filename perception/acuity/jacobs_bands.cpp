#include "perception/acuity/jacobs_bands_params.h"
#include "perception/acuity/local_blur.h"

#include "perception/acuity/jacobs_bands_gate.comp.h"
#include "perception/acuity/jacobs_bands_map.comp.h"

#include <algorithm>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "multiplies the width of the blur; 0 switches it off"},
    {"photographic", "bool", 0, 1, 0, "choice: residual law", "1 shows all that an eye in the scene loses, 0 what the wearer's own eye does not lose"},
    {"range", "1", 0, 2, 0, "CIE 191:2010; Jacobs 2015, appendix A; section 2.3", "mesopic range: 0 is 0.005..5, 1 is 0.01..1, 2 is 0.001..10 cd/m²"},
    {"local_mean_deg", "°", 0.5f, 10, 2, "choice: as larson_increment", "window of the local luminance"},
    {"randomness", "1", 0, 0.5f, 0.25f, "Jacobs 2015, equation 15 and appendix A (g)", "acuity comes and goes in patches; 0: steady"},
    {"cell_deg", "°", 0.2f, 3, 0.7f, "choice: Jacobs 2015 gives no numbers", "size of those patches"},
    {"rate_hz", "Hz", 1, 20, 6, "choice: Jacobs 2015 gives no numbers", "how often they change"},
    {"eccentricity_per_deg", "1/°", 0, 1, 0, "choice: the wearer's own periphery does it; 0.3 is the eye's (Strasburger 2011)", "the blur widens with the angle from the gaze"},
};

class JacobsBands final : public LocalBlurModel {
public:
    static_assert(sizeof(JacobsBandsParams) == sizeof(float) * std::size(parameters) && std::size(parameters) <= parameter_count);
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<JacobsBands>();
        ENTOPTIC_CHECK(model->make(context, {"jacobs_bands", jacobs_bands_gate_comp_spv, jacobs_bands_map_comp_spv}));
        return model;
    }
    void set_parameters(std::span<const float> v) override {
        std::copy_n(v.begin(), std::size(parameters), parameters_);
        local_mean_deg_ = v[3];
        rate_hz_ = v[6];
    }
    bool is_identity() const override { return parameters_[0] == 0; }
    bool obeys_residual_law() const override { return parameters_[1] == 0 && parameters_[4] == 0 && parameters_[7] == 0; }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_jacobs_bands_reference();

extern const ModelEntry jacobs_bands_entry;
const ModelEntry jacobs_bands_entry{"acuity",   "jacobs_bands",       "Fine detail comes and goes in patches, the finest first (Jacobs 2015, equations 13-15)",
                                        parameters, &JacobsBands::create, &make_jacobs_bands_reference};

}  // namespace entoptic::perception
