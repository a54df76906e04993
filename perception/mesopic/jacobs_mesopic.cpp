#include "perception/mesopic/jacobs_mesopic_math.glsl"
#include "perception/mesopic/rod_vision.h"

#include "perception/mesopic/jacobs_mesopic.comp.h"
#include "perception/mesopic/jacobs_mesopic_gate.comp.h"
#include "perception/mesopic/jacobs_mesopic_map.comp.h"

#include <algorithm>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "how much of rod vision is shown; 0 switches it off"},
    {"photographic", "bool", 0, 1, 0, "choice: residual law", "1 shows all that an eye in the scene sees, 0 what the wearer's own eye does not do"},
    {"range", "1", 0, 2, 0, "CIE 191:2010; Jacobs 2015, appendix A; section 2.3", "mesopic range: 0 is 0.005..5, 1 is 0.01..1, 2 is 0.001..10 cd/m²"},
    {"local_mean_deg", "°", 0, 10, 2, "choice: size of the field that CIE 191 calls the adaptation field", "window of the local luminance; 0: each pixel by itself"},
    {"tint_r", "1", 0, 3, 1.05f, "Luidolt 2020, equation 14, after Krawczyk 2005; Jacobs gives no numbers", "red of the colour of rod vision"},
    {"tint_g", "1", 0, 3, 0.97f, "Luidolt 2020, equation 14, after Krawczyk 2005; Jacobs gives no numbers", "green of the colour of rod vision"},
    {"tint_b", "1", 0, 3, 1.27f, "Luidolt 2020, equation 14, after Krawczyk 2005; Jacobs gives no numbers", "blue of the colour of rod vision"},
};
static_assert(sizeof(JacobsMesopicParams) == sizeof(float) * std::size(parameters));

class JacobsMesopic final : public RodVisionModel {
public:
    static_assert(parameter_count == std::size(parameters));
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<JacobsMesopic>();
        ENTOPTIC_CHECK(model->make(context, {"jacobs_mesopic", jacobs_mesopic_gate_comp_spv, jacobs_mesopic_map_comp_spv, jacobs_mesopic_comp_spv}));
        return model;
    }
    void set_parameters(std::span<const float> v) override {
        std::copy_n(v.begin(), parameter_count, parameters_);
        const JacobsMesopicParams params{v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
        local_mean_deg_ = params.local_mean_deg;
        rods_ = jacobs_mesopic::rods(params);
    }
    bool is_identity() const override { return parameters_[0] == 0; }
    bool obeys_residual_law() const override { return parameters_[1] == 0; }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_jacobs_mesopic_reference();

extern const ModelEntry jacobs_mesopic_entry;
const ModelEntry jacobs_mesopic_entry{"mesopic",  "jacobs_mesopic",       "Rod vision: Purkinje shift, purple tint, loss of colour (Jacobs 2015, section 2.3)",
                                      parameters, &JacobsMesopic::create, &make_jacobs_mesopic_reference};

}  // namespace entoptic::perception
