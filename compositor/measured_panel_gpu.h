// A measured panel as the GPU has it. One struct for C++ and GLSL (scalar layout).
#ifndef ENTOPTIC_COMPOSITOR_MEASURED_PANEL_GPU_H
#define ENTOPTIC_COMPOSITOR_MEASURED_PANEL_GPU_H

#include "shaders/shared_types.h"

#ifdef __cplusplus
namespace entoptic::compositor {
#endif

struct MeasuredPanelTable {
    float share[768];          // channel, code: share of the channel's light at code 255
    vec3 light[3];             // of the channels at code 255 less the black: linear BT.709, cd/m²
    vec3 share_of_light[3];    // rows of the inverse: channel c sends dot(share_of_light[c], light - black)
    vec3 black;                // linear BT.709, cd/m²
};

#ifdef __cplusplus
static_assert(sizeof(MeasuredPanelTable) == 4 * (768 + 21), "scalar layout: the GLSL side must agree");
}  // namespace entoptic::compositor
#endif

#endif
