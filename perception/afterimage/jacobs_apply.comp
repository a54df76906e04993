#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// One pixel of one view: the afterimage of its place on the retina, between the four nearest cells.

#include "perception/afterimage/jacobs_gpu.h"
#include "perception/afterimage/jacobs_math.glsl"
#include "shaders/geometry.glsl"

layout(local_size_x = 32, local_size_y = 8) in;   // a tile

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 2) readonly buffer Seen { Afterimage seen[]; };

layout(scalar, binding = 3) readonly buffer Flags { uint flags[]; };

layout(scalar, push_constant) uniform PushBlock { ApplyPush push; };

Afterimage seen_at(vec2 at) {
    const vec2 place = at / push.map.cell_rad + 0.5 * float(push.map.size) - 0.5;
    const uvec2 cell = uvec2(clamp(place, vec2(0.0), vec2(push.map.size - 2u)));
    const vec2 part = clamp(place - vec2(cell), 0.0, 1.0);
    const uint first = (push.view * push.map.size + cell.y) * push.map.size + cell.x, below = first + push.map.size;
    const vec4 weights = vec4((1.0 - part.x) * (1.0 - part.y), part.x * (1.0 - part.y), (1.0 - part.x) * part.y, part.x * part.y);
    const Afterimage a = seen[first], b = seen[first + 1u], c = seen[below], d = seen[below + 1u];
    return Afterimage(weights.x * a.gain + weights.y * b.gain + weights.z * c.gain + weights.w * d.gain,
                      weights.x * a.added + weights.y * b.added + weights.z * c.added + weights.w * d.added);
}

void main() {
    if (flags[(push.view * push.tiles_y + gl_WorkGroupID.y) * push.tiles_x + gl_WorkGroupID.x] == 0u) return;
    const EyeGeometry g = geometry[push.view];
    const uvec2 id = gl_GlobalInvocationID.xy;
    if (id.x >= g.width || id.y >= g.height) return;
    const uint index = (push.view * g.height + id.y) * g.width + id.x;
    const vec4 pixel = scene[index];
    const vec2 at = retina_of_direction(push.gaze, geometry_direction(g, vec2(id) + 0.5));
    if (!(pixel.w > 0.0) || !(length(at) < push.map.reach)) return;
    scene[index] = vec4(with_afterimage(pixel.rgb, seen_at(at), push.black_cd_m2, push.white_cd_m2), pixel.w);
}
