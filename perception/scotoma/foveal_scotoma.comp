#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The scotoma for each pixel of a rectangle around the gaze, of one view.

#include "perception/scotoma/foveal_scotoma_math.glsl"
#include "shaders/colour_math.glsl"
#include "shaders/geometry.glsl"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 2) readonly buffer Geometry { EyeGeometry geometry[]; };

layout(scalar, push_constant) uniform Push {
    FovealScotomaParams params;
    vec3 gaze;
    float black_cd_m2;
    uint view, left, top, width, height;
} push;

void main() {
    const EyeGeometry g = geometry[push.view];
    // A stride, because the gate knows one number of workgroups for all views.
    for (uint i = gl_GlobalInvocationID.x; i < push.width * push.height; i += gl_NumWorkGroups.x * gl_WorkGroupSize.x) {
        const uvec2 px = uvec2(push.left + i % push.width, push.top + i / push.width);
        const uint at = push.view * g.width * g.height + px.y * g.width + px.x;
        const vec4 pixel = scene[at];
        if (!(pixel.w > 0.0)) continue;
        // By the chord, which is exact for small angles.
        const float eccentricity_deg = 114.59155902616465 * asin(min(0.5 * length(geometry_direction(g, vec2(px) + 0.5) - push.gaze), 1.0));
        const float adaptation = state[push.view].adaptation_cd_m2;
        const float y = max(max(luminance(pixel.rgb), adaptation), 1e-6);
        BothEyes eyes = BothEyes(y, y);
        if (push.params.photographic < 0.5) eyes = above_black(y, ENTOPTIC_DISPLAYED_LUMINANCE(state[push.view].tone, y), push.black_cd_m2);
        scene[at] = vec4(pixel.rgb * factor(push.params, eyes, eccentricity_deg, adaptation), pixel.w);
    }
}
