// Curves: a quantity of a model over one variable, as the shader computes it, as the same text computes it in double, and as an independent
// implementation of the published equation has it. So people can check and plot the models: `entoptic curve`, docs/curves.md.
#pragma once

#include "base/result.h"
#include "gpu/device.h"
#include "perception/model.h"

#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace entoptic::perception {

// A setting of a curve that is no parameter of the model.
struct CurveSetting {
    const char* name;
    const char* unit;
    double min, max, default_value;
    const char* meaning;
    bool optional = false;   // may be left out, which default_value (outside min..max) then says
};

// What all curves of one name share.
struct CurveKind {
    std::string_view name;
    std::string_view slot;                   // empty: of no slot
    const char *x_name, *x_unit;
    double x_min, x_max;
    const char *y_name, *y_unit;
    std::vector<CurveSetting> settings;
    std::vector<const char*> parts = {""};   // of a value: suffixes of the columns
};

// What a curve is computed from.
struct CurveInput {
    std::vector<double> own;          // in the order of CurveKind::settings
    std::vector<float> parameters;    // all of the model's, in its order
    std::vector<float> table;         // what Curve::table made of them

    template <class P> P as() const {
        P p;
        std::memcpy(&p, parameters.data(), sizeof p);
        return p;
    }
};

// Values of all xs, the parts of a value next to each other.
using CurveFunction = std::vector<double> (*)(const CurveInput&, std::span<const double> xs);

// The name under which a curve takes a parameter, or several as a vector: `n` for `exponent`, `b1` for `b1_l`, `b1_m` and `b1_s`.
struct CurveAlias {
    const char* name;
    std::vector<const char*> parameters;
    std::optional<float> default_value = {};   // where it is not the model's
};

struct Curve {
    const CurveKind* kind;
    std::string_view model;
    std::span<const std::uint32_t> spirv;      // see curve_pass.glsl
    CurveFunction exact;                       // the shader's text in double
    CurveFunction reference;                   // independent
    std::vector<CurveAlias> parameters;        // of the model, that the curve depends on
    std::vector<std::string_view> without;     // settings of the kind that it does not depend on
    std::vector<float> (*table)(const CurveInput&) = nullptr;   // for the shader and its text: spectra, sums
    double reference_tolerance = 1e-4;         // relative, over at least `floor`: what the test asserts of gpu and double against the reference
    double floor = 1e-12;                      // in the curve's unit
};

// All curves; those of one name stand together, the first is the default where the preset `combined` has no model in the slot.
std::span<const Curve> curves();

// The curve of this name; of the model of the preset `combined` when `model` is empty. Errors name what there is: usage for a name or model
// that does not exist, failure for a model that has no such quantity.
Result<const Curve*> find_curve(std::string_view name, std::string_view model);

// One curve with its settings.
class CurveRequest {
public:
    explicit CurveRequest(const Curve& curve);
    const Curve& curve() const { return curve_; }

    // True when the curve depends on it, false when only the curve of the same name of another model does. Errors (usage) name settings and ranges.
    Result<bool> set(std::string_view name, std::span<const double> values);
    // Name and values of all settings; no value: left out.
    struct Setting {
        std::string name, unit;
        std::vector<double> values;
    };
    std::vector<Setting> settings() const;

    // Usage error for an x out of range.
    Result<void> check(std::span<const double> xs) const;
    // Rows of x, then gpu, double and reference, each with all parts.
    Result<std::vector<std::vector<double>>> rows(gpu::Device& device, std::span<const double> xs) const;
    // "x", "gpu", "double", "reference", with the parts' suffixes.
    std::vector<std::string> columns() const;

private:
    const ParameterInfo* parameter(std::string_view name, std::size_t& at) const;
    Result<void> set_parameter(std::string_view alias, std::string_view name, double value);
    Result<std::vector<float>> on_gpu(gpu::Device& device, const CurveInput& input, std::span<const double> xs) const;
    std::string all_settings() const;

    const Curve& curve_;
    const ModelEntry* entry_;      // null: of no slot
    CurveInput input_;
};

}  // namespace entoptic::perception
