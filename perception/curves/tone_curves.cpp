// Curves of the slot `tone`.
#include "perception/curves/curve_references.h"
#include "perception/curves/curve_table.h"
#include "perception/curves/display_identity_scene.glsl"
#include "perception/tone/key_reinhard_math.glsl"
#include "perception/tone/naka_rushton_math.glsl"

#include "perception/curves/tone_response_display_identity.comp.h"
#include "perception/curves/tone_response_key_reinhard.comp.h"
#include "perception/curves/tone_response_naka_rushton.comp.h"

namespace entoptic::perception {
namespace {

double identity_response(const CurveInput& in, double y) {
    const curve_settings::ToneResponse scene{in.own[0], in.own[1], in.own[2], in.own[3]};
    return display_identity::shown_of_scene(in.as<DisplayIdentityParams>(), scene, y, 130, 0.04) / 130;
}
double reinhard_response(const CurveInput& in, double y) { return key_reinhard::response(in.as<KeyReinhardParams>(), y, in.own[0]); }
double receptor_response(const CurveInput& in, double y) {
    const auto p = in.as<NakaRushtonParams>();
    return naka_rushton::response(p, y, naka_rushton::log2_half_saturation(p, in.own[0]));
}

}  // namespace

std::vector<Curve> tone_curves() {
    static const CurveKind kind{"tone.response", "tone", "pixel luminance", "cd/m²", 0, 1e9, "response (tone curves without one: displayed luminance over peak)", "1",
                                {{"adapted_to", "cd/m²", 1e-6, 1e8, 100, "adaptation luminance"},
                                 {"bright", "cd/m²", 1e-6, 1e8, 0, "99.9th percentile of the scene; left out: 8 times adapted_to", true},
                                 {"dark_share", "1", 0, 1, -1, "share of the field below the panel's black; left out: 1 where adapted_to is, else 0", true},
                                 {"peak", "cd/m²", 1e-6, 1e8, 0, "brightest channel of the scene; left out: as bright", true}}};
    static const std::vector<std::string_view> without_scene = {"bright", "dark_share", "peak"};
    using namespace curve_reference;
    return {{&kind, "display_identity", tone_response_display_identity_comp_spv, &each<identity_response>, &each<display_identity_response>,
             {{"night_exponent", {"night_exponent"}}, {"day_cd_m2", {"day_cd_m2"}}, {"day_exponent", {"day_exponent"}}, {"knee", {"knee"}}}, {}},
            {&kind, "key_reinhard", tone_response_key_reinhard_comp_spv, &each<reinhard_response>, &each<key_reinhard_response>,
             {{"key_scale", {"key_scale"}}, {"as_printed", {"as_printed"}}}, without_scene},
            {&kind, "naka_rushton", tone_response_naka_rushton_comp_spv, &each<receptor_response>, &each<naka_rushton_response>,
             {{"n", {"exponent"}}, {"plateau_scale", {"plateau_scale"}}, {"plateau", {"plateau"}}}, without_scene}};
}

}  // namespace entoptic::perception
