// Curves of the slot `acuity`.
#include "perception/curves/curve_references.h"
#include "perception/curves/curve_table.h"
#include "perception/curves/luidolt_eq12_angle.glsl"

#include "perception/curves/acuity_cutoff_luidolt_eq12.comp.h"
#include "perception/curves/acuity_sigma_luidolt_eq12.comp.h"

namespace entoptic::perception {
namespace {

double eq12_sigma(const CurveInput& in, double y) { return luidolt_eq12::sigma_arcmin(in.as<LuidoltEq12Params>(), y); }
double eq12_cutoff(const CurveInput& in, double y) { return luidolt_eq12::cutoff_cpd(in.as<LuidoltEq12Params>(), y); }

}  // namespace

std::vector<Curve> acuity_curves() {
    static const CurveKind cutoff{"acuity.cutoff", "acuity", "luminance", "cd/m²", 0, 1e9, "highest frequency resolved", "cycles/degree", {}};
    static const CurveKind sigma{"acuity.sigma", "acuity", "luminance", "cd/m²", 0, 1e9, "standard deviation of the blur", "arcmin",
                                 {{"displayed", "cd/m²", 1e-6, 1e8, 0, "what the panel shows, which the wearer's own eye blurs; left out: the whole blur", true},
                                  {"ppd", "px/degree", 0.1, 1e6, 0, "pixels of the panel, whose box counts as blur; left out: none", true}}};
    static const std::vector<CurveAlias> strength = {{"strength", {"strength"}}};
    using namespace curve_reference;
    return {{&cutoff, "luidolt_eq12", acuity_cutoff_luidolt_eq12_comp_spv, &each<eq12_cutoff>, &each<luidolt_eq12_cutoff>, strength, {}},
            {&sigma, "luidolt_eq12", acuity_sigma_luidolt_eq12_comp_spv, &each<eq12_sigma>, &each<luidolt_eq12_sigma>, strength, {"displayed", "ppd"}, nullptr, 1e-4, 1e-2}};
}

}  // namespace entoptic::perception
