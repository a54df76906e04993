// Layers, composed for one position on the panel: included by warp.comp and fused.comp, so that both paths are the same text.
// Bindings 0..2 and 5..20 are declared here; 3 and 4 belong to the includer.
#ifndef ENTOPTIC_COMPOSITOR_LAYERS_GLSL
#define ENTOPTIC_COMPOSITOR_LAYERS_GLSL

#include "compositor/layer_view.h"
#include "shaders/geometry.glsl"
#include "shaders/tile_statistics.glsl"

layout(constant_id = 0) const uint used_slots = 16;      // layers of this eye, rounded up; the rest of the code is not compiled
layout(constant_id = 1) const bool clean_values = true;  // some layer has a float format
layout(constant_id = 2) const bool achromatic = false;   // all colours have the same distortion: one look serves for three

// Uniform, not storage buffers: see gpu/commands.h, BindingKind.
layout(scalar, binding = 0) uniform Geometry { EyeGeometry geometry[2]; };             // of each eye
layout(scalar, binding = 1) uniform Layers { LayerView layers[2 * layer_slots]; };     // layer_slots an eye
layout(scalar, binding = 2) readonly buffer Tiles { uint tile_list[]; };               // x | y << 16 of the tiles to work on

// One a layer: lavapipe cannot index arrays of images. Coordinates are texels (unnormalised), so that texel centres are exact.
layout(binding = 5) uniform sampler2D layer_0;
layout(binding = 6) uniform sampler2D layer_1;
layout(binding = 7) uniform sampler2D layer_2;
layout(binding = 8) uniform sampler2D layer_3;
layout(binding = 9) uniform sampler2D layer_4;
layout(binding = 10) uniform sampler2D layer_5;
layout(binding = 11) uniform sampler2D layer_6;
layout(binding = 12) uniform sampler2D layer_7;
layout(binding = 13) uniform sampler2D layer_8;
layout(binding = 14) uniform sampler2D layer_9;
layout(binding = 15) uniform sampler2D layer_10;
layout(binding = 16) uniform sampler2D layer_11;
layout(binding = 17) uniform sampler2D layer_12;
layout(binding = 18) uniform sampler2D layer_13;
layout(binding = 19) uniform sampler2D layer_14;
layout(binding = 20) uniform sampler2D layer_15;

// Linear value of a layer at a texel. A value that is not finite may come from one neighbour with weight 0 (0 times infinity is NaN): then
// the nearest texel speaks alone.
vec4 layer_value(sampler2D image, vec2 texel) {
    vec4 value = textureLod(image, texel, 0.0);
    if (clean_values) {
        const float sum = value.x + value.y + value.z + value.w;
        if (!(abs(sum) < 3e38)) value = texelFetch(image, ivec2(texel), 0);
    }
    return value;
}

// Lays one layer over `light` (cd/m²) at lens coordinates `at` = (p.x, p.y, D) of one colour.
void lay_over(sampler2D image, uint slot, uint colour, vec3 at, inout vec3 light, inout bool changed) {
    const float a = dot(layers[slot].texel_from_lens[3 * colour], at);
    const float b = dot(layers[slot].texel_from_lens[3 * colour + 1], at);
    const float w = dot(layers[slot].texel_from_lens[3 * colour + 2], at);
    vec2 texel = vec2(a, b) * (1.0 / w);
    const bool seen = w > 0.0 && texel.x >= layers[slot].low.x && texel.y >= layers[slot].low.y && texel.x <= layers[slot].high.x &&
                      texel.y <= layers[slot].high.y;
    // 1/256 of a texel, as fine as hardware filters: a texel centre met to within rounding is that texel.
    texel = clamp(floor(texel * 256.0 + 0.5) * (1.0 / 256.0), layers[slot].clamp_low, layers[slot].clamp_high);
    const vec4 value = layer_value(image, texel);
    const uint flags = layers[slot].flags;
    float alpha = (flags & layer_blends) != 0u ? value.w : 1.0;
    if (clean_values) alpha = alpha > 0.0 ? min(alpha, 1.0) : 0.0;
    vec3 scene = value.rgb * layers[slot].cd_per_unit;
    if (clean_values) {
        bool dirty;
        scene = clean_scene_colour(scene, dirty);
        changed = changed || (dirty && seen);
    }
    scene = scene * ((flags & layer_unpremultiplied) != 0u ? alpha : 1.0) + layers[slot].offset_cd * alpha;
    light = seen ? scene + light * (1.0 - alpha) : light;
}

// All layers of an eye in painter's order, black beneath.
vec3 compose_layers(uint view, uint colour, vec3 at, inout bool changed) {
    const uint first = view * layer_slots;
    vec3 light = vec3(0.0);
    if (used_slots > 0) lay_over(layer_0, first, colour, at, light, changed);
    if (used_slots > 1) lay_over(layer_1, first + 1, colour, at, light, changed);
    if (used_slots > 2) lay_over(layer_2, first + 2, colour, at, light, changed);
    if (used_slots > 3) lay_over(layer_3, first + 3, colour, at, light, changed);
    if (used_slots > 4) lay_over(layer_4, first + 4, colour, at, light, changed);
    if (used_slots > 5) lay_over(layer_5, first + 5, colour, at, light, changed);
    if (used_slots > 6) lay_over(layer_6, first + 6, colour, at, light, changed);
    if (used_slots > 7) lay_over(layer_7, first + 7, colour, at, light, changed);
    if (used_slots > 8) lay_over(layer_8, first + 8, colour, at, light, changed);
    if (used_slots > 9) lay_over(layer_9, first + 9, colour, at, light, changed);
    if (used_slots > 10) lay_over(layer_10, first + 10, colour, at, light, changed);
    if (used_slots > 11) lay_over(layer_11, first + 11, colour, at, light, changed);
    if (used_slots > 12) lay_over(layer_12, first + 12, colour, at, light, changed);
    if (used_slots > 13) lay_over(layer_13, first + 13, colour, at, light, changed);
    if (used_slots > 14) lay_over(layer_14, first + 14, colour, at, light, changed);
    if (used_slots > 15) lay_over(layer_15, first + 15, colour, at, light, changed);
    return light;
}

// (p.x, p.y, D) of one colour at pixel `px` of eye `view`.
vec3 lens_coordinates(uint view, uint colour, vec2 px) {
    const vec2 p = lens_position(geometry[view], geometry[view].channels[colour], px);
    return vec3(p, lens_denominator(geometry[view].channels[colour], dot(p, p)));
}

#endif
