#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// out = C - leaves kept + arrives + near, with leaves and arrives interpolated between the nodes by splines; `kept` is the light that
// leaves its place when it is scattered. An invocation does the pixels of one column whose nearest row of nodes is the same.
#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"
#include "perception/observer_state.h"
#include "shaders/scene_statistics.h"

layout(local_size_x = 256) in;
layout(constant_id = 0) const uint step = 4;
layout(constant_id = 1) const uint kept = source_scene;
layout(constant_id = 2) const uint keep_drawn = 0;      // 1: what changes in the panel's light is kept for a last convolution
layout(constant_id = 3) const uint sigmoid = 0;         // 1: what arrives is laid over the picture by Kakimoto's tone curve, and nothing leaves

layout(scalar, binding = 0) buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer Exchange { vec3 exchange[]; };     // node: arrives, leaves
layout(scalar, binding = 2) buffer NearLight { vec3 near_light[]; };           // from the pass "near"; then what is drawn
layout(scalar, binding = 3) readonly buffer Flags { uint flags[]; };
layout(scalar, binding = 4) readonly buffer State { ObserverState state[]; };

layout(scalar, push_constant) uniform PushBlock { LatticePush push; };

// What a veil of this light, cd/m2, adds, with W the panel's white in scene units: the curve gives 255 for it. No light, no veil.
float laid_over(float veil, float white) { return (tumblin_sigmoid(max(veil, 0.0)) - tumblin_sigmoid(0.0)) * white / 255.0; }

void main() {
    const uint x = gl_GlobalInvocationID.x, segment = gl_WorkGroupID.y, view = gl_WorkGroupID.z;
    if (x >= push.width) return;
    // Node n stands on pixel step (n - 1): with the nearest node `column + 1`, the three are column, column + 1, column + 2.
    const uint column = (x + step / 2) / step;
    const vec3 across = spline_weights((float(x) - float(column * step)) / float(step));
    vec3 arrives[3], leaves[3];
    for (uint j = 0; j < 3; ++j) {
        const uint at = 2 * ((view * push.nodes_y + segment + j) * push.nodes_x + column);
        arrives[j] = across.x * exchange[at] + across.y * exchange[at + 2] + across.z * exchange[at + 4];
        leaves[j] = across.x * exchange[at + 1] + across.y * exchange[at + 3] + across.z * exchange[at + 5];
    }
    const float white = state[view].tone.scene_white_cd_m2;
    for (uint k = 0; k < step; ++k) {
        const int y = int(segment * step + k) - int(step / 2);
        if (y < 0 || y >= int(push.height)) continue;
        const vec3 down = spline_weights((float(k) - float(step / 2)) / float(step));
        const uint at = (view * push.height + uint(y)) * push.width + x;
        const vec4 pixel = scene[at];
        vec3 light = pixel.rgb + (down.x * arrives[0] + down.y * arrives[1] + down.z * arrives[2]);
        if (kept != source_excess && sigmoid == 0) {
            const vec3 from = kept == source_scene ? pixel.rgb : kept == source_displayed ? min(pixel.rgb, vec3(white)) : near_light[at];
            light -= from * (down.x * leaves[0] + down.y * leaves[1] + down.z * leaves[2]);
        }
        if (kept != source_drawn && push.near != 0 && flags[(view * push.tiles_y + uint(y) / tile_height) * push.tiles_x + x / tile_width] != 0) light += near_light[at];
        if (sigmoid != 0) {
            const vec3 veil = light - pixel.rgb;
            light = pixel.rgb + vec3(laid_over(veil.r, white), laid_over(veil.g, white), laid_over(veil.b, white));
        }
        // The maximum also turns NaN into 0.
        light = max(light, vec3(0.0));
        if (keep_drawn != 0) near_light[at] = pixel.w > 0.0 ? min(light, vec3(white)) - min(pixel.rgb, vec3(white)) : vec3(0.0);
        scene[at] = pixel.w > 0.0 ? vec4(light, pixel.w) : pixel;
    }
}
