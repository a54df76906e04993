// Curves of the slot `afterimage`.
#include "perception/curves/curve_references.h"
#include "perception/curves/curve_table.h"
#include "perception/curves/jacobs_steps.glsl"

#include "perception/curves/afterimage_bleaching_jacobs.comp.h"
#include "perception/curves/afterimage_calcium_jacobs.comp.h"

namespace entoptic::perception {
namespace {

glm::dvec3 bleaching(const CurveInput& in, double t) { return jacobs::bleached_by_flash(in.as<JacobsParams>(), {in.own[0], in.own[1]}, t); }
double calcium(const CurveInput& in, double t) { return jacobs::calcium_after_step(in.as<JacobsParams>(), {in.own[0], in.own[1]}, t); }

}  // namespace

std::vector<Curve> afterimage_curves() {
    static const CurveKind flash{"afterimage.bleaching", "afterimage", "time since the flash began", "s", 0, 1e6, "bleached share", "1",
                                 {{"luminance", "cd/m²", 0, 1e8, 1e4, "of the white flash"}, {"flash_s", "s", 0, 1e6, 0.125, "how long it lasts"}},
                                 {"_L", "_M", "_S"}};
    static const CurveKind step{"afterimage.calcium", "afterimage", "time since the step", "s", 0, 1e6, "calcium C/Cmax", "1",
                                {{"from_response", "1", 0, 1, 0, "response until the step"}, {"to_response", "1", 0, 1, 0.5, "response from then on"}}};
    static const std::vector<CurveAlias> rates = {{"b1", {"b1_l", "b1_m", "b1_s"}}, {"b2", {"b2_l", "b2_m", "b2_s"}}};
    // The model takes a share below 1e-7 in the dark as none.
    return {{&flash, "jacobs", afterimage_bleaching_jacobs_comp_spv, &each<bleaching>, &each<curve_reference::jacobs_bleaching>, rates, {}, nullptr, 1e-4, 1.1e-3},
            {&step, "jacobs", afterimage_calcium_jacobs_comp_spv, &each<calcium>, &each<curve_reference::jacobs_calcium>, {{"c2", {"c2"}}}, {}, nullptr, 1e-4, 1e-2}};
}

}  // namespace entoptic::perception
