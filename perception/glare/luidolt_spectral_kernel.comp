#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The far kernel of one pupil diameter on the glare grid, per sr, averaged over each texel: the far part of the smooth profile, and what the
// texture of the particles adds to it or takes from it, which the near field does not have. Grid 0: red + i green, grid 1: blue.
#include "perception/glare/luidolt_spectral_gpu.h"
#include "perception/glare/glare_math.glsl"

layout(local_size_x = 64) in;

layout(scalar, binding = 0) readonly buffer Spectrum { SpectralTable spectrum; };
layout(scalar, binding = 1) readonly buffer Profile { RadialEntry profile[]; };
layout(scalar, binding = 2) readonly buffer Structure { float structure[]; };
layout(scalar, binding = 3) writeonly buffer Grid { vec2 grid[]; };

layout(scalar, push_constant) uniform PushBlock { TexturedKernelPush push; };

#include "perception/glare/glare_radial.glsl"

// Bins of the transform beyond which its texture fades into the smooth halo: from 1/3 to 0.4 of the sampling frequency.
const float fade_from = 170.0, fade_to = 205.0;

float structure_at(vec2 bin) {
    const vec2 at = bin * 0.5 + float(structure_n / 2);
    const uvec2 i = uvec2(clamp(at, vec2(0.0), vec2(float(structure_n - 2))));
    const vec2 f = at - vec2(i);
    const uint base = i.y * structure_n + i.x;
    return mix(mix(structure[base], structure[base + 1], f.x), mix(structure[base + structure_n], structure[base + structure_n + 1], f.x), f.y);
}

// What the texture adds to the smooth halo or takes from it.
vec3 halo_texture(vec2 sines) {
    const float sine = length(sines);
    vec3 sum = vec3(0.0);
    for (uint i = 0; i < spectrum.count; ++i) {
        const float lambda = spectrum.lambda_um[i];
        const vec2 bin = sines * (push.patch_um / lambda);
        const float share = 1.0 - smoothstep(fade_from, fade_to, length(bin));
        if (share > 0.0) sum += spectrum.weight[i] * (disc_scatter(push.particle_um, lambda, sine) * share * (structure_at(bin) - 1.0));
    }
    return sum;
}

vec3 kernel(vec2 offset) {
    const float theta = length(offset), sine = sin(min(theta / push.angle_scale, 1.5707963));
    const float texture_end = fade_to * spectrum.lambda_um[spectrum.count - 1] / push.patch_um;
    vec3 light = radial_kernel(theta, push.profile, push.weights);
    if (push.texture_on != 0 && sine < texture_end)
        light += halo_texture(offset * (sine / theta)) * (push.halo * (1.0 - near_share(theta, push.near)) * radius_share(theta, push.radius));
    return max(light, vec3(0.0));
}

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    const uint n = gl_NumWorkGroups.y;       // texels of a side
    const ivec2 texel = ivec2(at) - ivec2(greaterThanEqual(at, uvec2(n / 2))) * int(n);
    const int far = max(abs(texel.x), abs(texel.y));
    const int samples = far <= 4 ? 8 : far <= 16 ? 4 : far <= 64 ? 2 : 1;
    vec3 sum = vec3(0.0);
    for (int j = 0; j < samples; ++j)
        for (int i = 0; i < samples; ++i) sum += kernel((vec2(texel) + (vec2(i, j) + 0.5) / float(samples) - 0.5) * push.pitch);
    sum /= float(samples * samples);
    const uint to = at.y * glare_row + at.x;
    grid[to] = sum.rg;
    grid[to + glare_plane] = vec2(sum.b, 0.0);
}
