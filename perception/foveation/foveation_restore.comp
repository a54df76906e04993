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
layout(scalar, binding = 5) readonly buffer SolidAngle { float solid_angle[]; };       // of the view

layout(scalar, push_constant) uniform PushBlock { FoveationPush push; };

vec4 texel_at(uint view, ivec2 at) {
    const ivec2 inside = clamp(at, ivec2(0), ivec2(push.side) - 1);
    const vec4 texel = scene[(view * push.side + uint(inside.y)) * push.side + uint(inside.x)];
    return texel.w > 0.0 ? vec4(texel.rgb, 1.0) : vec4(0.0);
}

void main() {
    const uvec2 pixel = gl_GlobalInvocationID.xy;
    const uint view = gl_GlobalInvocationID.z;
    if (pixel.x >= push.width || pixel.y >= push.height) return;
    const uint index = (view * push.height + pixel.y) * push.width + pixel.x;
    const vec4 before = full[index];
    if (!(before.w > 0.0)) return;
    const FoveatedView axes = gaze_axes[view];
    const EyeGeometry f = foveated[view];
    const vec3 in_view = geometry_direction(geometry[view], vec2(pixel) + 0.5);
    const vec3 d = vec3(dot(in_view, axes.right), dot(in_view, axes.up), dot(in_view, axes.back));
    // As foveated_pixel(), whose radius also tells how many texels there are away from the gaze: nowhere fewer than around it.
    const float off_axis = max(length(d.xy), 1e-6), deg = max(atan(off_axis, -d.z) * 57.29577951308232, 1e-3);
    const float radius = foveated_radius_px(f, deg);
    const vec2 place = 0.5 * vec2(f.width, f.height) + vec2(d.x, -d.y) * (radius / off_axis);
    const float texels_a_deg = polar_density(deg) * f.foveal_ppd * f.foveal_ppd / (6.283185307179586 * radius);
    const float width = 0.017453292519943295 / max(sqrt(solid_angle[index]) * texels_a_deg, 1e-6);     // of a texel, pixels
    const float between = clamp((width - nearest_until_px) / (filtered_from_px - nearest_until_px), 0.0, 1.0);
    const vec2 position = place - 0.5, corner = floor(position);
    // A nearest texel is bilinear with its parts rounded.
    const vec2 part = mix(round(position - corner), position - corner, between);
    const ivec2 at = ivec2(corner);
    const vec4 sum = mix(mix(texel_at(view, at), texel_at(view, at + ivec2(1, 0)), part.x),
                         mix(texel_at(view, at + ivec2(0, 1)), texel_at(view, at + ivec2(1, 1)), part.x), part.y);
    if (sum.w > 0.0) full[index] = vec4(sum.rgb / sum.w, before.w);
}
