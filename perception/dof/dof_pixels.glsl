// Body of <model>_pixels.comp: depth and disc of every pixel, for the gathering. Define before: DOF_PARAMS, blur_radii_px() and
// DOF_ROWS(params), whether rows of the kernel are coloured.
#include "perception/dof/dof_gpu.h"
#include "perception/dof/dof_math.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) readonly buffer Dioptre { float dioptre[]; };
layout(scalar, binding = 1) readonly buffer SolidAngle { float solid_angle[]; };
layout(scalar, binding = 2) readonly buffer Eyes { DofEye eyes[]; };
layout(scalar, binding = 3) readonly buffer Focus { DofFocus focus; };
layout(scalar, binding = 4) writeonly buffer Pixels { DofPixel pixels[]; };

layout(scalar, push_constant) uniform Push {
    DOF_PARAMS params;
    uint width, height;
} push;

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    const uint view = gl_GlobalInvocationID.z;
    if (at.x >= push.width || at.y >= push.height) return;
    const uint index = (view * push.height + at.y) * push.width + at.x;
    const float d = dioptre[index], sr = solid_angle[index];
    DofPixel pixel = DofPixel(focus.dioptre, vec3(0.0));
    if (d >= 0.0) pixel = DofPixel(d, blur_radii_px(push.params, d, focus.dioptre, eyes[view].pupil_mm, sqrt(sr)));
    if (DOF_ROWS(push.params)) pixel.radius_px.yz = vec2(sign(d - focus.dioptre), 0.0);
    if (!(sr > 0.0)) pixel = DofPixel(unknown_dioptre, vec3(0.0));   // behind everything, and without any light to give
    pixels[index] = pixel;
}
