#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The foveated image back to the view's pixels: bilinear where texels are wider than pixels; the texel that a pixel's middle lies in where
// they are finer, which is the one that was taken from this pixel.

#include "perception/foveation/foveation_gpu.h"
#include "shaders/geometry.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) readonly buffer Geometry { EyeGeometry geometry[]; };      // of the views
layout(scalar, binding = 1) readonly buffer Foveated { EyeGeometry foveated[]; };
layout(scalar, binding = 2) readonly buffer Views { FoveatedView gaze_axes[]; };
layout(scalar, binding = 3) readonly buffer Scene { vec4 scene[]; };                   // foveated
layout(scalar, binding = 4) buffer Full { vec4 full[]; };

layout(scalar, push_constant) uniform PushBlock { FoveationPush push; };

vec4 texel_at(uint view, ivec2 at) {
    const ivec2 inside = clamp(at, ivec2(0), ivec2(push.side) - 1);
    const vec4 texel = scene[(view * push.side + uint(inside.y)) * push.side + uint(inside.x)];
    return texel.w > 0.0 ? vec4(texel.rgb, 1.0) : vec4(0.0);
}

// Texels a radian away from the gaze, where they are fewer than around it.
float texels_a_rad(EyeGeometry f, vec3 direction, vec3 back) {
    const float deg = max(57.29577951308232 * acos(clamp(-dot(direction, back), -1.0, 1.0)), 0.1);
    return 57.29577951308232 * polar_density(deg) * f.foveal_ppd * f.foveal_ppd / (6.283185307179586 * foveated_radius_px(f, deg));
}

void main() {
    const uvec2 pixel = gl_GlobalInvocationID.xy;
    const uint view = gl_GlobalInvocationID.z;
    if (pixel.x >= push.width || pixel.y >= push.height) return;
    const uint index = (view * push.height + pixel.y) * push.width + pixel.x;
    const vec4 before = full[index];
    if (!(before.w > 0.0)) return;
    const EyeGeometry g = geometry[view];
    const FoveatedView axes = gaze_axes[view];
    const vec2 px = vec2(pixel) + 0.5;
    const vec3 d = geometry_direction(g, px);
    const vec2 place = foveated_pixel(foveated[view], vec3(dot(d, axes.right), dot(d, axes.up), dot(d, axes.back)));
    const float step_rad = min(length(geometry_direction(g, px + vec2(1, 0)) - d), length(geometry_direction(g, px + vec2(0, 1)) - d));
    const float width = 1.0 / max(step_rad * texels_a_rad(foveated[view], d, axes.back), 1e-3);     // of a texel, pixels
    const float between = clamp((width - nearest_until_px) / (filtered_from_px - nearest_until_px), 0.0, 1.0);
    const vec2 position = place - 0.5, corner = floor(position);
    // A nearest texel is bilinear with its parts rounded.
    const vec2 part = mix(round(position - corner), position - corner, between);
    const ivec2 at = ivec2(corner);
    const vec4 sum = mix(mix(texel_at(view, at), texel_at(view, at + ivec2(1, 0)), part.x),
                         mix(texel_at(view, at + ivec2(0, 1)), texel_at(view, at + ivec2(1, 1)), part.x), part.y);
    if (sum.w > 0.0) full[index] = vec4(sum.rgb / sum.w, before.w);
}
