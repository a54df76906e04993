#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// One cell of the retina of one view: the light that falls on it, its states one step on, and what is seen of them.

#include "perception/afterimage/jacobs_gpu.h"
#include "perception/afterimage/jacobs_math.glsl"
#include "perception/tone_curve.glsl"
#include "shaders/geometry.glsl"

layout(local_size_x = 32, local_size_y = 4) in;

layout(scalar, binding = 0) readonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 1) readonly buffer Geometry { EyeGeometry geometry[]; };
layout(scalar, binding = 2) readonly buffer State { ObserverState state[]; };
layout(scalar, binding = 3) readonly buffer Before { Cell before[]; };
layout(scalar, binding = 4) writeonly buffer After { Cell after[]; };
layout(scalar, binding = 5) writeonly buffer Seen { Afterimage seen[]; };
layout(scalar, binding = 6) buffer Status { RetinaStatus status; };

layout(scalar, push_constant) uniform PushBlock { ObservePush push; };

// Of the tone curve, read once.
float exposure, straight_end;

// Displayed over scene light for luminance y. Curves rise: beyond the straight part they show at least what its end shows, where the table
// alone, between an entry below the end and one above, would show up to 3 % less.
float display_scale(float y) {
    if (y <= straight_end * rounded_up) return exposure;
    return max(ENTOPTIC_DISPLAYED_LUMINANCE(state[push.view].tone, y), exposure * straight_end) / max(y, min_scene_cd_m2);
}

// Under the residual law: light that the panel shows, and no darker than it is, drives nothing. Most pixels end here.
bool is_shown(vec3 light, float y) {
    return push.params.photographic < 0.5 && exposure >= 1.0 && y <= straight_end * rounded_up &&
           max(light.r, max(light.g, light.b)) * exposure <= push.white_cd_m2 * rounded_up;
}

Drive drive_of_light(vec3 light, vec3 lid) {
    const float y = luminance(light);
    if (is_shown(light, y)) return no_drive();
    return drive_of(push.params, light, display_scale(y), exposure, push.white_cd_m2, lid);
}

// Beyond the picture the scene is taken to go on with the luminance that the eye is adapted to; under the residual law nothing is missing.
Drive unseen_drive(vec3 lid) {
    return push.params.photographic > 0.5 ? drive_of_light(vec3(state[push.view].adaptation_cd_m2), lid) : no_drive();
}

// The mean over the block of pixels around the cell's direction.
Drive drive_at(vec2 at, vec3 lid) {
    const EyeGeometry g = geometry[push.view];
    const vec2 px = geometry_pixel(g, direction_of_retina(push.gaze, at));
    const ivec2 size = ivec2(g.width, g.height);
    const ivec2 first = ivec2(floor(clamp(px, vec2(-1e4), vec2(size) + 1e4) - 0.5 * float(push.samples) + 0.5));
    const ivec2 low = max(first, ivec2(0)), high = min(first + int(push.samples), size);
    Drive sum = no_drive();
    float count = 0.0;
    for (int y = low.y; y < high.y; ++y)
        for (int x = low.x; x < high.x; ++x) {
            const vec4 pixel = scene[(push.view * g.height + uint(y)) * g.width + uint(x)];
            if (!(pixel.w > 0.0)) continue;
            sum = added(sum, drive_of_light(pixel.rgb, lid));
            count += 1.0;
        }
    return count > 0.0 ? mean_drive(sum, count) : unseen_drive(lid);
}

Cell stored(ivec2 cell) {
    const ivec2 in_map = clamp(cell, ivec2(0), ivec2(push.map.size) - 1);
    return before[(push.view * push.map.size + uint(in_map.y)) * push.map.size + uint(in_map.x)];
}

// The stored states, a little blurred by the time that has passed.
Cell diffused(ivec2 cell) {
    if (status.rested == 1u) return rested();
    Cell c = stored(cell);
    const float share = diffusion_share(push.params, push.map.cell_rad, push.dt_s);
    if (!(share > 0.0)) return c;
    const Cell l = stored(cell - ivec2(1, 0)), r = stored(cell + ivec2(1, 0)), u = stored(cell - ivec2(0, 1)), d = stored(cell + ivec2(0, 1));
    c.bleached += share * (l.bleached + r.bleached + u.bleached + d.bleached - 4.0 * c.bleached);
    c.depleted += share * (l.depleted + r.depleted + u.depleted + d.depleted - 4.0 * c.depleted);
    return c;
}

Cell begun(ivec2 cell, Drive drive, vec3 lid) {
    if (push.begin == begin_steady) return steady(push.params, drive);
    if (push.begin == begin_adapted) return steady(push.params, unseen_drive(lid));
    return diffused(cell);
}

// Most cells add nothing to a maximum: they look before they take the lock.
void note(Cell cell, Afterimage a) {
    if (!is_rested(cell) && status.awake == 0u) atomicMax(status.awake, 1u);
    const uint added_bits = floatBitsToUint(max(a.added.x, max(a.added.y, a.added.z)));
    const uint common_bits = floatBitsToUint(abs(a.gain.x + a.gain.y + a.gain.z) / 3.0);
    const uint spread_bits = floatBitsToUint(max(a.gain.x, max(a.gain.y, a.gain.z)) - min(a.gain.x, min(a.gain.y, a.gain.z)));
    if (added_bits > status.added_bits) atomicMax(status.added_bits, added_bits);
    if (common_bits > status.common_bits) atomicMax(status.common_bits, common_bits);
    if (spread_bits > status.spread_bits) atomicMax(status.spread_bits, spread_bits);
}

void main() {
    const uvec2 id = gl_GlobalInvocationID.xy;
    if (id.x >= push.map.size || id.y >= push.map.size) return;
    const uint index = (push.view * push.map.size + id.y) * push.map.size + id.x;
    exposure = state[push.view].tone.exposure;
    straight_end = state[push.view].tone.straight_until_cd_m2;
    const vec2 at = (vec2(id) + 0.5 - 0.5 * float(push.map.size)) * push.map.cell_rad;
    const vec3 lid = lid_transmission(push.params, push.lid_open);
    const Drive drive = length(at) < push.map.reach ? drive_at(at, lid) : unseen_drive(lid);
    const Cell cell = advanced(push.params, begun(ivec2(id), drive, lid), drive, push.dt_s);
    const Afterimage a = afterimage_of(push.params, cell, drive, fall_off(push.params, at) * push.params.strength);
    after[index] = cell;
    seen[index] = a;
    note(cell, a);
}
