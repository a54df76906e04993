// Curves of the slot `adaptation`.
#include "perception/adaptation/jacobs_ramp_math.glsl"
#include "perception/adaptation/krawczyk_exp_linear_math.glsl"
#include "perception/adaptation/krawczyk_exp_log_math.glsl"
#include "perception/curves/curve_references.h"
#include "perception/curves/curve_table.h"
#include "perception/curves/pattanaik_step.glsl"

#include "perception/curves/adaptation_step_jacobs_ramp.comp.h"
#include "perception/curves/adaptation_step_krawczyk_exp_linear.comp.h"
#include "perception/curves/adaptation_step_krawczyk_exp_log.comp.h"
#include "perception/curves/adaptation_step_pattanaik_slow.comp.h"

namespace entoptic::perception {
namespace {

double linear_step(const CurveInput& in, double t) { return krawczyk_exp_linear::adapted(in.as<KrawczykExpLinearParams>(), in.own[0], in.own[1], t); }
double log_step(const CurveInput& in, double t) { return krawczyk_exp_log::adapted(in.as<KrawczykExpLogParams>(), in.own[0], in.own[1], t); }
double ramp_step(const CurveInput& in, double t) { return jacobs_ramp::adapted(in.as<JacobsRampParams>(), in.own[0], in.own[1], t); }
double slow_step(const CurveInput& in, double t) { return pattanaik_slow::pigment_step(in.as<PattanaikSlowParams>(), in.own[0], in.own[1], t); }

}  // namespace

std::vector<Curve> adaptation_curves() {
    static const CurveKind kind{"adaptation.step", "adaptation", "time since the step", "s", 0, 1e6, "adaptation luminance", "cd/m²",
                                {{"from", "cd/m²", 1e-6, 1e8, 100, "what the eye was adapted to"}, {"to", "cd/m²", 1e-6, 1e8, 0.01, "light from then on"}}};
    static const std::vector<CurveAlias> taus = {{"speed", {"speed"}}, {"tau_rod_s", {"tau_rod_s"}}, {"tau_cone_s", {"tau_cone_s"}}, {"floor_cd_m2", {"floor_cd_m2"}}};
    static const std::vector<CurveAlias> ramps = {
        {"speed", {"speed"}}, {"up_log10_per_s", {"up_log10_per_s"}}, {"down_log10_per_s", {"down_log10_per_s"}}, {"floor_cd_m2", {"floor_cd_m2"}}};
    std::vector<CurveAlias> slow = taus;
    slow.push_back({"time_lapse", {"time_lapse"}});
    using namespace curve_reference;
    return {{&kind, "krawczyk_exp_log", adaptation_step_krawczyk_exp_log_comp_spv, &each<log_step>, &each<krawczyk_exp_log_step>, taus, {}},
            {&kind, "krawczyk_exp_linear", adaptation_step_krawczyk_exp_linear_comp_spv, &each<linear_step>, &each<krawczyk_exp_linear_step>, taus, {}},
            {&kind, "jacobs_ramp", adaptation_step_jacobs_ramp_comp_spv, &each<ramp_step>, &each<jacobs_ramp_step>, ramps, {}},
            {&kind, "pattanaik_slow", adaptation_step_pattanaik_slow_comp_spv, &each<slow_step>, &each<pattanaik_slow_step>, slow, {}}};
}

}  // namespace entoptic::perception
