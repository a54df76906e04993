// Curves of the slot `pupil`, and those that belong to no slot: the eye's chromatic aberration, the foveated polar map.
#include "perception/curves/curve_references.h"
#include "perception/curves/curve_settings.h"
#include "perception/curves/curve_table.h"
#include "perception/dof/dof_math.glsl"
#include "perception/foveation/visual_polar_math.glsl"
#include "perception/pupil/watson_yellott_math.glsl"

#include "perception/curves/foveation_eccentricity_exact.comp.h"
#include "perception/curves/foveation_eccentricity_fitted.comp.h"
#include "perception/curves/lca_defocus_thibos.comp.h"
#include "perception/curves/pupil_diameter_watson_yellott.comp.h"

#include <algorithm>

namespace entoptic::perception {
namespace {

double pupil_diameter(const CurveInput& in, double x) {
    const double one_eye = in.own[2] < 1.5 ? 0.1 : 1.0;
    return std::clamp(watson_yellott::diameter_mm(x * in.own[1] * one_eye, in.own[0]), 1.5, 9.0);
}
double defocus(const CurveInput&, double x) { return dof::chromatic_dioptre(1e-3 * x); }
double exact_deg(const CurveInput& in, double x) { return visual_polar::eccentricity_of_radial(x, in.own[0]); }
double fitted_deg(const CurveInput& in, double x) { return visual_polar::fitted_eccentricity_of_radial(x, in.own[0]); }

}  // namespace

std::vector<Curve> pupil_curves() {
    static const CurveKind diameter{"pupil.diameter", "pupil", "scene luminance", "cd/m²", 0, 1e9, "pupil diameter", "mm",
                                    {{"age", "years", 20, 83, 30, "age of the eye"},
                                     {"area_deg2", "deg²", 0.01, 41253, 8495, "area of the adapting field; 8495: a disc of 104 degrees"},
                                     {"eyes", "1", 1, 2, 2, "eyes that see the light"}}};
    static const CurveKind lca{"lca.defocus", "", "wavelength", "nm", 380, 780, "refraction relative to 580 nm", "dioptre", {}};
    return {{&diameter, "watson_yellott", pupil_diameter_watson_yellott_comp_spv, &each<pupil_diameter>, &each<curve_reference::pupil_diameter>, {}, {}},
            {&lca, "thibos", lca_defocus_thibos_comp_spv, &each<defocus>, &each<curve_reference::thibos_defocus>, {}, {}, nullptr, 1e-4, 1e-2}};
}

std::vector<Curve> foveation_curves() {
    static const CurveKind kind{"foveation.eccentricity", "", "radius of the polar map", "1", 0, 1, "eccentricity", "degrees",
                                {{"max_deg", "degrees", 10, 180, 80, "eccentricity at the map's rim"}}};
    return {{&kind, "exact", foveation_eccentricity_exact_comp_spv, &each<exact_deg>, &each<curve_reference::exact_eccentricity>, {}, {}},
            {&kind, "fitted", foveation_eccentricity_fitted_comp_spv, &each<fitted_deg>, &each<curve_reference::fitted_eccentricity>, {}, {}}};
}

}  // namespace entoptic::perception
