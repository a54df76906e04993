#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The noise for each pixel of one view.

#include "perception/noise/rod_noise_math.glsl"
#include "perception/patch_noise.glsl"
#include "shaders/colour_math.glsl"
#include "shaders/geometry.glsl"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 2) readonly buffer Geometry { EyeGeometry geometry[]; };

layout(scalar, push_constant) uniform Push {
    RodNoiseParams params;
    vec3 gaze;
    float pupil_mm, black_cd_m2, tick_part;
    uint view, tick, seed;
} push;

void main() {
    const EyeGeometry g = geometry[push.view];
    const uint i = gl_GlobalInvocationID.x;
    if (i >= g.width * g.height) return;
    const uint at = push.view * g.width * g.height + i;
    const vec4 pixel = scene[at];
    if (!(pixel.w > 0.0)) return;
    const float dim = push.params.strength * dim_share(state[push.view].adaptation_cd_m2);
    const float y = max(luminance(pixel.rgb), 1e-6);
    BothEyes eyes = BothEyes(y, y);
    if (push.params.photographic < 0.5) eyes = above_black(y, ENTOPTIC_DISPLAYED_LUMINANCE(state[push.view].tone, y), push.black_cd_m2);
    const float contrast2 = dim * dim * added_contrast2(push.params, eyes, push.pupil_mm);
    if (!(contrast2 > 0.0)) return;
    const vec3 direction = geometry_direction(g, vec2(i % g.width, i / g.width) + 0.5);
    const float normal = patch_noise(push.seed, lattice_place(direction, push.gaze, push.params.grain_deg), push.tick, push.tick_part);
    scene[at] = vec4(pixel.rgb * factor(contrast2, normal), pixel.w);
}
