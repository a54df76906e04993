#include "perception/mesopic/mes2_math.glsl"
#include "perception/mesopic/rod_vision.h"

#include "perception/mesopic/mes2.comp.h"
#include "perception/mesopic/mes2_gate.comp.h"
#include "perception/mesopic/mes2_map.comp.h"

#include <algorithm>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "how much of rod vision is shown; 0 switches it off"},
    {"photographic", "bool", 0, 1, 0, "choice: residual law", "1 shows all that an eye in the scene sees, 0 what the wearer's own eye does not do"},
    {"sp_ratio", "1", 0.25f, 4, 2.4645f, "CIE 191:2010; D65 by CIE 1951 V'", "scotopic over photopic luminance of the light that the eye is adapted to"},
    {"local_mean_deg", "°", 0, 10, 2, "choice: size of the field that CIE 191 calls the adaptation field", "window of the local luminance; 0: each pixel by itself"},
    {"tint_r", "1", 0, 3, 1.05f, "Luidolt 2020, equation 14, after Krawczyk 2005", "red of the colour of rod vision"},
    {"tint_g", "1", 0, 3, 0.97f, "Luidolt 2020, equation 14, after Krawczyk 2005", "green of the colour of rod vision"},
    {"tint_b", "1", 0, 3, 1.27f, "Luidolt 2020, equation 14, after Krawczyk 2005", "blue of the colour of rod vision"},
};
static_assert(sizeof(Mes2Params) == sizeof(float) * std::size(parameters));

class Mes2 final : public RodVisionModel {
public:
    static_assert(parameter_count == std::size(parameters));
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<Mes2>();
        ENTOPTIC_CHECK(model->make(context, {"mes2", mes2_gate_comp_spv, mes2_map_comp_spv, mes2_comp_spv}));
        return model;
    }
    void set_parameters(std::span<const float> v) override {
        std::copy_n(v.begin(), parameter_count, parameters_);
        const Mes2Params params{v[0], v[1], v[2], v[3], v[4], v[5], v[6]};
        local_mean_deg_ = params.local_mean_deg;
        rods_ = mes2::rods(params);
    }
    bool is_identity() const override { return parameters_[0] == 0; }
    bool obeys_residual_law() const override { return parameters_[1] == 0; }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_mes2_reference();

extern const ModelEntry mes2_entry;
const ModelEntry mes2_entry{"mesopic",  "mes2",       "Rod vision by mesopic photometry (CIE 191:2010, Gao 2017), with a purple tint",
                                      parameters, &Mes2::create, &make_mes2_reference};

}  // namespace entoptic::perception
