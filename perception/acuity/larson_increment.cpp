#include "perception/acuity/larson_increment_params.h"
#include "perception/acuity/local_blur.h"

#include "perception/acuity/larson_increment_gate.comp.h"
#include "perception/acuity/larson_increment_map.comp.h"

#include <algorithm>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "multiplies the width of the blur; 0 switches it off"},
    {"photographic", "bool", 0, 1, 0, "choice: residual law", "1 shows all that an eye in the scene loses, 0 what the wearer's own eye does not lose"},
    {"local_mean_deg", "°", 0.5f, 10, 2, "choice: Larson 1997 samples foveal adaptation over 1°", "window of the local luminance"},
    {"randomness", "1", 0, 0.5f, 0, "Jacobs 2015, equation 15 (g); his value is 0.25", "acuity comes and goes in patches; 0: steady"},
    {"cell_deg", "°", 0.2f, 3, 0.7f, "choice: Jacobs 2015 gives no numbers", "size of those patches"},
    {"rate_hz", "Hz", 1, 20, 6, "choice: Jacobs 2015 gives no numbers", "how often they change"},
};

class LarsonIncrement final : public LocalBlurModel {
public:
    static_assert(sizeof(LarsonIncrementParams) == sizeof(float) * std::size(parameters) && std::size(parameters) <= parameter_count);
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<LarsonIncrement>();
        ENTOPTIC_CHECK(model->make(context, {"larson_increment", larson_increment_gate_comp_spv, larson_increment_map_comp_spv}));
        return model;
    }
    void set_parameters(std::span<const float> v) override {
        std::copy_n(v.begin(), std::size(parameters), parameters_);
        local_mean_deg_ = v[2];
        rate_hz_ = v[5];
    }
    bool is_identity() const override { return parameters_[0] == 0; }
    bool obeys_residual_law() const override { return parameters_[1] == 0 && parameters_[3] == 0; }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_larson_increment_reference();

extern const ModelEntry larson_increment_entry;
const ModelEntry larson_increment_entry{"acuity",   "larson_increment",       "Blur that takes the wearer's acuity at the panel to that in the scene (Larson 1997)",
                                        parameters, &LarsonIncrement::create, &make_larson_increment_reference};

}  // namespace entoptic::perception
