#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// One value a node, times the share of its direction in a zone of the view.
#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"
#include "shaders/geometry.glsl"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) buffer Values { vec3 values[]; };      // view, node
layout(scalar, binding = 1) readonly buffer Geometry { EyeGeometry geometry[]; };

layout(scalar, push_constant) uniform PushBlock { ZonePush push; };

void main() {
    const uint view = gl_WorkGroupID.z, i = gl_GlobalInvocationID.x, per_view = push.nodes_x * push.nodes_y;
    if (i >= per_view) return;
    const vec2 px = (vec2(i % push.nodes_x, i / push.nodes_x) - 1.0) * float(push.step) + 0.5;
    values[push.first + view * per_view + i] *= zone_share(zone_place(geometry_direction(geometry[view], px), push.zones), push.zone);
}
