// A direction pad made of a thumbstick or a trackpad (XR_EXT_dpad_binding).
#pragma once

#include "runtime/objects/interaction_profiles.h"

namespace entoptic::runtime {

// Members and defaults of XrInteractionProfileDpadBindingEXT, as the specification gives them.
struct DpadSettings {
    float force_threshold = 0.5f, force_threshold_released = 0.4f;  // of a pad's press, 0..1
    float center_region = 0.5f;                                     // radius, 0..1
    float wedge_angle = 1.5707963f;                                 // radians
    bool sticky = false;                                            // what was pressed stays so until the release, wherever the thumb goes
};

// Whether the part of the pad that `source` names is pressed. `thumb` is the position, -1..1; `press` the force of a pad or 1 for a stick;
// `was_pressed` the answer before.
bool dpad_pressed(Source source, ComponentValue thumb, float press, const DpadSettings& settings, bool was_pressed);

// "/input/thumbstick" or "/input/trackpad": what the direction pad is made of. Empty for another source.
std::string_view dpad_parent(Source source);

}  // namespace entoptic::runtime
