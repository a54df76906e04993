#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Lens: the seen image to the light of each panel pixel (or straight to its codes). Green stays where it is; red and blue come from where
// the green lens shows the direction that they will be seen in.
#include "compositor/lens_math.glsl"
#include "compositor/panel.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(constant_id = 0) const bool catmull_rom = true;    // filter: 4×4 Catmull-Rom, else 2×2 bilinear
layout(constant_id = 1) const bool same_grid = true;      // the eye image has the panel's size
layout(constant_id = 2) const bool to_codes = true;       // write codes, else light

layout(scalar, binding = 0) uniform Geometry { EyeGeometry geometry[2]; };   // of each eye's panel
layout(scalar, binding = 1) readonly buffer Tiles { uint tile_list[]; };
layout(scalar, binding = 2) readonly buffer Seen { float seen[]; };                 // four a pixel
layout(scalar, binding = 3) writeonly buffer Light { vec3 panel_light[]; };
layout(scalar, binding = 4) writeonly buffer Codes { uint codes[]; };

layout(scalar, push_constant) uniform Push {
    uint view;
    uint tiles;
    uvec2 eye_size;         // of the seen image
    PanelCurve curve;
} push;

float seen_at(ivec2 at, uint colour) {
    const ivec2 inside = clamp(at, ivec2(0), ivec2(push.eye_size) - 1);
    return seen[((push.view * push.eye_size.y + uint(inside.y)) * push.eye_size.x + uint(inside.x)) * 4 + colour];
}

// Weights of Catmull and Rom's cubic (1974) for samples at -1, 0, 1, 2 around t in 0..1.
vec4 cubic_weights(float t) {
    return vec4(t * (t * (1.0 - 0.5 * t) - 0.5), 1.0 + t * t * (1.5 * t - 2.5), t * (0.5 + t * (2.0 - 1.5 * t)), t * t * (0.5 * t - 0.5));
}

float filtered(vec2 px, uint colour) {
    const vec2 position = floor((px - 0.5) * 256.0 + 0.5) * (1.0 / 256.0);   // as fine as a texture unit; exact at pixel centres
    const vec2 corner = floor(position);
    const vec2 t = position - corner;
    const ivec2 at = ivec2(corner);
    if (!catmull_rom) {
        return mix(mix(seen_at(at, colour), seen_at(at + ivec2(1, 0), colour), t.x),
                   mix(seen_at(at + ivec2(0, 1), colour), seen_at(at + ivec2(1, 1), colour), t.x), t.y);
    }
    const vec4 wx = cubic_weights(t.x), wy = cubic_weights(t.y);
    float sum = 0.0;
    for (int row = 0; row < 4; ++row) {
        const ivec2 left = at + ivec2(-1, row - 1);
        sum += wy[row] * (wx.x * seen_at(left, colour) + wx.y * seen_at(left + ivec2(1, 0), colour) +
                          wx.z * seen_at(left + ivec2(2, 0), colour) + wx.w * seen_at(left + ivec2(3, 0), colour));
    }
    return max(sum, 0.0);
}

void main() {
    const uint index = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (index >= push.tiles) return;
    const uint view = push.view;
    const uvec2 pixel = uvec2(tile_list[index] & 0xffffu, tile_list[index] >> 16) * gl_WorkGroupSize.xy + gl_LocalInvocationID.xy;
    const uvec2 size = uvec2(geometry[view].width, geometry[view].height);
    if (pixel.x >= size.x || pixel.y >= size.y) return;
    const vec2 px = vec2(pixel) + 0.5;
    const vec2 scale = same_grid ? vec2(1.0) : vec2(push.eye_size) / vec2(size);
    vec3 light;
    light.r = filtered(green_pixel_of_colour(geometry[view], geometry[view].channels[0], px) * scale, 0);
    light.g = same_grid ? seen_at(ivec2(pixel), 1) : filtered(px * scale, 1);
    light.b = filtered(green_pixel_of_colour(geometry[view], geometry[view].channels[2], px) * scale, 2);
    for (int colour = 0; colour < 3; ++colour)
        if (!lens_shows(geometry[view], colour, px)) light[colour] = 0.0;
    const uint at = (view * size.y + pixel.y) * size.x + pixel.x;
    if (to_codes) codes[at] = panel_codes(push.curve, light, at);
    else panel_light[at] = light;
}
