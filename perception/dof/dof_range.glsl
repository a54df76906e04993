// Body of <model>_range.comp: the widest disc of each tile. Define before: DOF_PARAMS, the parameters' struct, and blur_radii_px().
// The radius grows with the distance from the focus on either side, so that a tile's nearest and farthest points bound it.
#include "perception/dof/dof_gpu.h"
#include "perception/dof/dof_math.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Dioptre { float dioptre[]; };
layout(scalar, binding = 1) readonly buffer SolidAngle { float solid_angle[]; };
layout(scalar, binding = 2) readonly buffer Eyes { DofEye eyes[]; };
layout(scalar, binding = 3) readonly buffer Focus { DofFocus focus; };
layout(scalar, binding = 4) writeonly buffer Radii { float tile_radius_px[]; };

layout(scalar, push_constant) uniform Push {
    DOF_PARAMS params;
    uint width, height;
} push;

void main() {
    const uint across = (push.width + tile_width - 1u) / tile_width, down = (push.height + tile_height - 1u) / tile_height;
    const uint t = gl_GlobalInvocationID.x, view = gl_GlobalInvocationID.z;
    if (t >= across * down) return;
    const uint left = t % across * tile_width, top = t / across * tile_height;
    const uint columns = min(tile_width, push.width - left), rows = min(tile_height, push.height - top);
    float nearest = -1.0, farthest = 3e38, finest_sr = 3e38;
    for (uint y = 0u; y < rows; ++y) {
        const uint row = (view * push.height + top + y) * push.width + left;
        for (uint x = 0u; x < columns; ++x) {
            const float d = dioptre[row + x], sr = solid_angle[row + x];
            const bool known = d >= 0.0 && sr > 0.0;
            nearest = known ? max(nearest, d) : nearest;
            farthest = known ? min(farthest, d) : farthest;
            finest_sr = known ? min(finest_sr, sr) : finest_sr;
        }
    }
    float radius = 0.0;
    if (nearest >= 0.0 && focus.dioptre >= 0.0) {
        const float pixel_rad = sqrt(finest_sr);
        const vec3 near = blur_radii_px(push.params, nearest, focus.dioptre, eyes[view].pupil_mm, pixel_rad);
        const vec3 far = blur_radii_px(push.params, farthest, focus.dioptre, eyes[view].pupil_mm, pixel_rad);
        radius = max(max(near.x, max(near.y, near.z)), max(far.x, max(far.y, far.z)));
    }
    tile_radius_px[view * across * down + t] = radius;
}
