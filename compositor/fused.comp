#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Warp, lens and panel in one pass, for frames without a model of perception: layers to the codes of one eye's half of the panel.
// One workgroup a tile that the lens shows; the other tiles stay black as the buffer was made.
#include "compositor/layers.glsl"
#include "compositor/panel.glsl"

layout(local_size_x_id = 4, local_size_y_id = 5) in;

layout(scalar, binding = 3) writeonly buffer Codes { uint codes[]; };
layout(scalar, binding = 4) buffer Cleaned { uint cleaned[]; };   // pixels of each eye

layout(scalar, push_constant) uniform Push {
    uint view;
    uint tiles;
    PanelCurve curve;
} push;

// lens_shows(), with what is at hand: position in lens coordinates and its denominator.
bool shows(vec3 coordinates, float cutoff) { return dot(coordinates.xy, coordinates.xy) <= cutoff && coordinates.z > 0.05; }

void main() {
    const uint index = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (index >= push.tiles) return;
    const uint view = push.view;
    const uvec2 pixel = uvec2(tile_list[index] & 0xffffu, tile_list[index] >> 16) * gl_WorkGroupSize.xy + gl_LocalInvocationID.xy;
    const uvec2 size = uvec2(geometry[view].width, geometry[view].height);
    if (pixel.x >= size.x || pixel.y >= size.y) return;
    const vec2 px = vec2(pixel) + 0.5;
    bool changed = false;
    const vec3 green = lens_coordinates(view, 1, px);
    vec3 light = vec3(0.0);
    if (!special || achromatic) light = compose_layers(view, 1, px, green, changed);
    const vec3 cutoff = geometry[view].r2_cutoff;
    bvec3 shown = bvec3(shows(green, cutoff.g));
    if (!achromatic) {
        const vec3 red = lens_coordinates(view, 0, px), blue = lens_coordinates(view, 2, px);
        if (special) {  // a loop: the text of the special layers is long, and lavapipe compiles each copy of it
            for (uint colour = 0u; colour < 3u; ++colour) {
                const vec3 at = colour == 0u ? red : colour == 1u ? green : blue;
                light[colour] = compose_layers(view, colour, px, at, changed)[colour];
            }
        } else {
            light.r = compose_layers(view, 0, px, red, changed).r;
            light.b = compose_layers(view, 2, px, blue, changed).b;
        }
        shown = bvec3(shows(red, cutoff.r), shown.g, shows(blue, cutoff.b));
        if (lens_near_edge(geometry[view], px) && any(shown))
            shown = bvec3(lens_shows(geometry[view], 0, px), lens_shows(geometry[view], 1, px), lens_shows(geometry[view], 2, px));
    }
    const uint at = (view * size.y + pixel.y) * size.x + pixel.x;
    codes[at] = panel_codes(push.curve, mix(vec3(0.0), light, shown), at);
    if (clean_values) {
        bool changed_now;
        clean_scene_colour(light, changed_now);
        if (any(shown) && (changed || changed_now)) atomicAdd(cleaned[view], 1u);
    }
}
