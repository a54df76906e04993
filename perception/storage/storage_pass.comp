#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// A picture goes into its storage, is read and written there by a pass that does nothing else, and comes out again.

#include "perception/storage/storage_formats.glsl"

layout(local_size_x = 256) in;

layout(constant_id = 0) const uint format = 0;  // StorageFormat

layout(scalar, binding = 0) buffer Stored { uint stored[]; };
layout(scalar, binding = 1) buffer Picture { vec4 picture[]; };

layout(scalar, push_constant) uniform Push {
    uint pixels;
    uint action;  // 0 into storage, 1 the pass, 2 out of it
    float scale;  // of stored values over the picture's
} push;

const uint fp32 = 0u, fp16 = 1u, r11g11b10 = 2u, rgb9e5 = 3u;
const float largest_half = 65504.0;

vec4 load(uint i) {
    if (format == fp32)
        return vec4(uintBitsToFloat(stored[4u * i]), uintBitsToFloat(stored[4u * i + 1u]), uintBitsToFloat(stored[4u * i + 2u]),
                    uintBitsToFloat(stored[4u * i + 3u]));
    if (format == fp16) return vec4(unpackHalf2x16(stored[2u * i]), unpackHalf2x16(stored[2u * i + 1u]));
    return vec4(format == r11g11b10 ? unpack_r11g11b10(stored[i]) : unpack_rgb9e5(stored[i]), 1.0);
}

void store(uint i, vec4 v) {
    if (format == fp32) {
        for (uint c = 0u; c < 4u; ++c) stored[4u * i + c] = floatBitsToUint(v[c]);
    } else if (format == fp16) {
        const vec4 held = min(v, vec4(largest_half));
        stored[2u * i] = packHalf2x16(held.xy);
        stored[2u * i + 1u] = packHalf2x16(held.zw);
    } else {
        stored[i] = format == r11g11b10 ? pack_r11g11b10(v.rgb) : pack_rgb9e5(v.rgb);
    }
}

void main() {
    const uint i = gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * 256u) + gl_GlobalInvocationID.x;
    if (i >= push.pixels) return;
    if (push.action == 0u)
        store(i, picture[i] * push.scale);
    else if (push.action == 1u)
        store(i, load(i));
    else
        picture[i] = load(i) / push.scale;
}
