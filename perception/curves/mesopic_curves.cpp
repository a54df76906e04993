// Curves of the slot `mesopic`.
#include "perception/curves/curve_references.h"
#include "perception/curves/curve_table.h"
#include "perception/mesopic/jacobs_mesopic_math.glsl"
#include "perception/mesopic/krawczyk_tint_math.glsl"
#include "perception/mesopic/luidolt_tint_math.glsl"
#include "perception/mesopic/mes2_math.glsl"

#include "perception/curves/mesopic_cone_share_jacobs_mesopic.comp.h"
#include "perception/curves/mesopic_cone_share_krawczyk_tint.comp.h"
#include "perception/curves/mesopic_cone_share_luidolt_tint.comp.h"
#include "perception/curves/mesopic_cone_share_mes2.comp.h"

#include <algorithm>

namespace entoptic::perception {
namespace {

double jacobs_share(const CurveInput& in, double y) { return jacobs_mesopic::cone_share(in.as<JacobsMesopicParams>(), std::max(y, 1e-9)); }
double krawczyk_share(const CurveInput&, double y) { return krawczyk_tint::cone_share(y); }
double luidolt_share(const CurveInput& in, double y) { return 1 - luidolt_tint::rod_share(in.as<LuidoltTintParams>(), y); }
double mes2_share(const CurveInput& in, double y) { return mes2::cone_share(in.as<Mes2Params>(), std::max(y, 1e-9)); }

}  // namespace

std::vector<Curve> mesopic_curves() {
    static const CurveKind kind{"mesopic.cone_share", "mesopic", "luminance (luidolt_tint: of adaptation)", "cd/m²", 0, 1e9, "cones' share", "1", {}};
    using namespace curve_reference;
    return {{&kind, "jacobs_mesopic", mesopic_cone_share_jacobs_mesopic_comp_spv, &each<jacobs_share>, &each<jacobs_mesopic_cone_share>,
             {{"range", {"range"}}}, {}, nullptr, 1e-4, 1e-2},
            {&kind, "krawczyk_tint", mesopic_cone_share_krawczyk_tint_comp_spv, &each<krawczyk_share>, &each<krawczyk_tint_cone_share>, {}, {}},
            {&kind, "luidolt_tint", mesopic_cone_share_luidolt_tint_comp_spv, &each<luidolt_share>, &each<luidolt_tint_cone_share>,
             {{"strength", {"strength"}}, {"cut_cd_m2", {"cut_cd_m2"}}}, {}, nullptr, 1e-4, 1e-2},
            {&kind, "mes2", mesopic_cone_share_mes2_comp_spv, &each<mes2_share>, &each<mes2_cone_share>,
             {{"sp_ratio", {"sp_ratio"}}}, {}, nullptr, 1e-4, 1e-2}};
}

}  // namespace entoptic::perception
