// Curves of the slot `acuity`.
#include "perception/acuity/larson_increment_math.glsl"
#include "perception/curves/curve_references.h"
#include "perception/curves/curve_table.h"
#include "perception/curves/jacobs_bands_cutoff.glsl"
#include "perception/curves/krawczyk_larson_angle.glsl"
#include "perception/curves/luidolt_eq12_angle.glsl"

#include "perception/curves/acuity_cutoff_jacobs_bands.comp.h"
#include "perception/curves/acuity_cutoff_krawczyk_larson.comp.h"
#include "perception/curves/acuity_cutoff_larson_increment.comp.h"
#include "perception/curves/acuity_cutoff_luidolt_eq12.comp.h"
#include "perception/curves/acuity_sigma_jacobs_bands.comp.h"
#include "perception/curves/acuity_sigma_krawczyk_larson.comp.h"
#include "perception/curves/acuity_sigma_larson_increment.comp.h"
#include "perception/curves/acuity_sigma_luidolt_eq12.comp.h"

#include <cmath>

namespace entoptic::perception {
namespace {

double eq12_sigma(const CurveInput& in, double y) { return luidolt_eq12::sigma_arcmin(in.as<LuidoltEq12Params>(), y); }
double eq12_cutoff(const CurveInput& in, double y) { return luidolt_eq12::cutoff_cpd(in.as<LuidoltEq12Params>(), y); }

// As acuity_sigma_larson_increment.comp.
double increment_sigma(const CurveInput& in, double y) {
    auto p = in.as<LarsonIncrementParams>();
    p.photographic = in.own[0] > 0 ? 0 : 1;
    return std::sqrt(larson_increment::added_variance(p, {y, in.own[0]}, {0, 0, in.own[1] > 0 ? in.own[1] : 1e9}));
}
double larson_cutoff(const CurveInput&, double y) { return larson_increment::resolved_cpd(y); }

double krawczyk_sigma(const CurveInput& in, double y) { return krawczyk_larson::blur_arcmin(in.as<KrawczykLarsonParams>(), y, in.own[1]); }

double bands_sigma(const CurveInput& in, double y) {
    auto p = in.as<JacobsBandsParams>();
    p.photographic = in.own[0] > 0 ? 0 : 1;
    return std::sqrt(jacobs_bands::added_variance(p, {y, in.own[0]}, {0, 0, 1e9}));
}
double bands_cutoff(const CurveInput& in, double y) { return jacobs_bands::cutoff_cpd(in.as<JacobsBandsParams>(), y); }

}  // namespace

std::vector<Curve> acuity_curves() {
    static const CurveKind cutoff{"acuity.cutoff", "acuity", "luminance", "cd/m²", 0, 1e9, "highest frequency resolved", "cycles/degree", {}};
    static const CurveKind sigma{"acuity.sigma", "acuity", "luminance", "cd/m²", 0, 1e9, "standard deviation of the blur", "arcmin",
                                 {{"displayed", "cd/m²", 1e-6, 1e8, 0, "what the panel shows, which the wearer's own eye blurs; left out: the whole blur", true},
                                  {"ppd", "px/degree", 0.1, 1e6, 0, "pixels of the panel, whose box counts as blur; left out: none", true}}};
    static const std::vector<CurveAlias> strength = {{"strength", {"strength"}}};
    using namespace curve_reference;
    static const std::vector<CurveAlias> range = {{"range", {"range"}}};
    std::vector<CurveAlias> bands = strength;
    bands.push_back(range[0]);
    return {{&cutoff, "larson_increment", acuity_cutoff_larson_increment_comp_spv, &each<larson_cutoff>, &each<larson_cutoff_cpd>, {}, {}},
            {&cutoff, "krawczyk_larson", acuity_cutoff_krawczyk_larson_comp_spv, &each<larson_cutoff>, &each<larson_cutoff_cpd>, {}, {}},
            {&cutoff, "jacobs_bands", acuity_cutoff_jacobs_bands_comp_spv, &each<bands_cutoff>, &each<jacobs_bands_cutoff>, range, {}},
            {&cutoff, "luidolt_eq12", acuity_cutoff_luidolt_eq12_comp_spv, &each<eq12_cutoff>, &each<luidolt_eq12_cutoff>, strength, {}},
            {&sigma, "larson_increment", acuity_sigma_larson_increment_comp_spv, &each<increment_sigma>, &each<larson_sigma>,
             strength, {}, nullptr, 1e-4, 1e-2},
            {&sigma, "krawczyk_larson", acuity_sigma_krawczyk_larson_comp_spv, &each<krawczyk_sigma>, &each<krawczyk_larson_sigma>,
             strength, {"displayed"}, nullptr, 1e-3, 1e-2},
            {&sigma, "jacobs_bands", acuity_sigma_jacobs_bands_comp_spv, &each<bands_sigma>, &each<jacobs_bands_sigma>,
             bands, {"ppd"}, nullptr, 1e-3, 1e-2},
            {&sigma, "luidolt_eq12", acuity_sigma_luidolt_eq12_comp_spv, &each<eq12_sigma>, &each<luidolt_eq12_sigma>,
             strength, {"displayed", "ppd"}, nullptr, 1e-4, 1e-2}};
}

}  // namespace entoptic::perception
