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
layout(constant_id = 3) const bool special = false;      // some layer has one of the flags of layer_special

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

// Where a layer is looked at: texels, and whether it faces that way at all.
struct Look {
    vec2 texel;
    bool front;
};

// A curved surface's texel at a direction.
Look look_curved(uint slot, vec3 direction) {
    const vec3 o = layers[slot].origin;
    const bool cylinder = (layers[slot].flags & layer_cylinder) != 0u;
    const vec3 flat_axes = cylinder ? vec3(1.0, 0.0, 1.0) : vec3(1.0);
    const vec3 d = direction * flat_axes, from = o * flat_axes;
    const float a = dot(d, d), half_b = dot(d, from), c = dot(from, from) - layers[slot].radius * layers[slot].radius;
    const float root = half_b * half_b - a * c;
    const float t = (sqrt(max(root, 0.0)) - half_b) / a;   // the far wall: its inside
    const vec3 at = o + t * direction;
    const float across = atan(at.x, -at.z);
    const float along = cylinder ? at.y : asin(clamp(at.y / layers[slot].radius, -1.0, 1.0));
    return Look(vec2(across, along) * layers[slot].texel_scale + layers[slot].texel_bias, root >= 0.0 && t > 0.0);
}

Look look_at(uint slot, uint colour, vec3 at) {
    const vec3 h = vec3(dot(layers[slot].texel_from_lens[3 * colour], at), dot(layers[slot].texel_from_lens[3 * colour + 1], at),
                        dot(layers[slot].texel_from_lens[3 * colour + 2], at));
    if (special && (layers[slot].flags & (layer_cylinder | layer_sphere)) != 0u) return look_curved(slot, h);
    return Look(h.xy * (1.0 / h.z), h.z > 0.0);
}

// 1/256 of a texel, as fine as hardware filters: a texel centre met to within rounding is that texel.
vec2 within_image(uint slot, vec2 texel) {
    return clamp(floor(texel * 256.0 + 0.5) * (1.0 / 256.0), layers[slot].clamp_low, layers[slot].clamp_high);
}

float coverage_of(uint flags, float alpha) {
    if ((flags & layer_blends) == 0u) return 1.0;
    return clean_values ? (alpha > 0.0 ? min(alpha, 1.0) : 0.0) : alpha;
}

// The way to a neighbour's texel, not round the back of a full turn.
vec2 step_to(uint slot, vec2 texel, Look neighbour) {
    vec2 way = neighbour.texel - texel;
    if ((layers[slot].flags & (layer_cylinder | layer_sphere)) != 0u) {
        const float turn = 6.28318531 * abs(layers[slot].texel_scale.x);
        way.x -= turn * floor(way.x / turn + 0.5);
    }
    return way;
}

// Mean colour of the texels between a pixel and its neighbours, multiplied by alpha where it is not yet; in w its coverage.
vec4 footprint_value(sampler2D image, uint slot, vec2 texel, vec2 across, vec2 down) {
    const uint flags = layers[slot].flags;
    // Two texels a tap: bilinear interpolation reads both. Written so that what is not a number makes one tap.
    const vec2 lengths = vec2(length(across), length(down)) * 0.5;
    const ivec2 taps = ivec2(lengths.x > 1.0 ? min(ceil(lengths.x), float(most_taps)) : 1.0,
                             lengths.y > 1.0 ? min(ceil(lengths.y), float(most_taps)) : 1.0);
    vec4 sum = vec4(0.0);
    for (int j = 0; j < taps.y; ++j) {
        for (int i = 0; i < taps.x; ++i) {
            const vec2 part = (vec2(i, j) + 0.5) / vec2(taps) - 0.5;
            vec4 value = layer_value(image, within_image(slot, texel + across * part.x + down * part.y));
            value.w = coverage_of(flags, value.w);
            if ((flags & layer_unpremultiplied) != 0u) value.rgb *= value.w;
            sum += value;
        }
    }
    return sum / float(taps.x * taps.y);
}

// The same with what only special kernels do.
void lay_over_special(sampler2D image, uint slot, uint colour, vec3 at, vec3 at_right, vec3 at_below, inout vec3 light, inout vec3 beneath,
                      inout bool changed) {
    const uint flags = layers[slot].flags;
    const Look look = look_at(slot, colour, at);
    const bool seen = look.front && all(greaterThanEqual(look.texel, layers[slot].low)) && all(lessThanEqual(look.texel, layers[slot].high));
    const vec3 under = (flags & layer_replaces) != 0u ? beneath : light;
    if ((flags & layer_replaces) == 0u) beneath = light;
    if (!seen) return;
    vec2 across = vec2(0.0), down = vec2(0.0);
    if ((flags & layer_minified) != 0u) {
        across = step_to(slot, look.texel, look_at(slot, colour, at_right));
        down = step_to(slot, look.texel, look_at(slot, colour, at_below));
    }
    vec4 value = footprint_value(image, slot, look.texel, across, down);
    if ((flags & layer_tinted) != 0u) value = value * layers[slot].colour_scale + layers[slot].colour_bias;
    const float alpha = (flags & layer_blends) != 0u ? clamp(value.w, 0.0, 1.0) : 1.0;
    vec3 scene = value.rgb * layers[slot].cd_per_unit;
    bool dirty;
    scene = clean_scene_colour(scene, dirty);
    changed = changed || dirty;
    light = scene + layers[slot].offset_cd * alpha + under * (1.0 - alpha);
}

// Lays one layer over `light` (cd/m²) at lens coordinates `at` = (p.x, p.y, D) of one colour.
void lay_over(sampler2D image, uint slot, uint colour, vec3 at, inout vec3 light, inout bool changed) {
    const Look look = look_at(slot, colour, at);
    const bool seen = look.front && look.texel.x >= layers[slot].low.x && look.texel.y >= layers[slot].low.y &&
                      look.texel.x <= layers[slot].high.x && look.texel.y <= layers[slot].high.y;
    const vec4 value = layer_value(image, within_image(slot, look.texel));
    const uint flags = layers[slot].flags;
    const float alpha = coverage_of(flags, value.w);
    vec3 scene = value.rgb * layers[slot].cd_per_unit;
    if (clean_values) {
        bool dirty;
        scene = clean_scene_colour(scene, dirty);
        changed = changed || (dirty && seen);
    }
    scene = scene * ((flags & layer_unpremultiplied) != 0u ? alpha : 1.0) + layers[slot].offset_cd * alpha;
    light = seen ? scene + light * (1.0 - alpha) : light;
}

// (p.x, p.y, D) of one colour at pixel `px` of eye `view`.
vec3 lens_coordinates(uint view, uint colour, vec2 px) {
    const vec2 p = lens_position(geometry[view], geometry[view].channels[colour], px);
    return vec3(p, lens_denominator(geometry[view].channels[colour], dot(p, p)));
}

#define ENTOPTIC_LAYER(n, image)                                                                                    \
    if (used_slots > n) {                                                                                           \
        if (special) lay_over_special(image, first + n, colour, at, at_right, at_below, light, beneath, changed);   \
        else lay_over(image, first + n, colour, at, light, changed);                                                \
    }

// All layers of an eye in painter's order, black beneath, at pixel `px`; `at` are the lens coordinates of the colour there.
vec3 compose_layers(uint view, uint colour, vec2 px, vec3 at, inout bool changed) {
    const uint first = view * layer_slots;
    vec3 light = vec3(0.0), beneath = vec3(0.0), at_right = at, at_below = at;
    if (special) {
        at_right = lens_coordinates(view, colour, px + vec2(1.0, 0.0));
        at_below = lens_coordinates(view, colour, px + vec2(0.0, 1.0));
    }
    ENTOPTIC_LAYER(0, layer_0)
    ENTOPTIC_LAYER(1, layer_1)
    ENTOPTIC_LAYER(2, layer_2)
    ENTOPTIC_LAYER(3, layer_3)
    ENTOPTIC_LAYER(4, layer_4)
    ENTOPTIC_LAYER(5, layer_5)
    ENTOPTIC_LAYER(6, layer_6)
    ENTOPTIC_LAYER(7, layer_7)
    ENTOPTIC_LAYER(8, layer_8)
    ENTOPTIC_LAYER(9, layer_9)
    ENTOPTIC_LAYER(10, layer_10)
    ENTOPTIC_LAYER(11, layer_11)
    ENTOPTIC_LAYER(12, layer_12)
    ENTOPTIC_LAYER(13, layer_13)
    ENTOPTIC_LAYER(14, layer_14)
    ENTOPTIC_LAYER(15, layer_15)
    return light;
}

#endif
