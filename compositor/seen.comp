#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// What the eye sees through the lens: the panel's light in a flat view of the eye's field, each colour from where it left the panel.
#include "compositor/measured_panel_gpu.h"
#include "shaders/colour_math.glsl"
#include "shaders/geometry.glsl"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) uniform Geometry { EyeGeometry geometry[2]; };   // of each eye's panel
layout(scalar, binding = 1) readonly buffer Codes { uint codes[]; };
layout(scalar, binding = 2) writeonly buffer Picture { uint picture[]; };

layout(scalar, binding = 3) readonly buffer Panels { MeasuredPanelTable panels[2]; };
layout(constant_id = 0) const bool measured = false;

layout(scalar, push_constant) uniform Push {
    uvec2 size;                                      // of the picture of one eye
    vec4 tangents[2];                                // left, right, up, down of each eye's field
    float black_cd_m2, white_cd_m2;
} push;

// Of one panel pixel, 0..1 of white - black: of a measured panel, of its own channel's.
float panel_linear(uint view, ivec2 at, uint colour) {
    const ivec2 size = ivec2(geometry[view].width, geometry[view].height);
    const ivec2 inside = clamp(at, ivec2(0), size - 1);
    const uint code = codes[(view * uint(size.y) + uint(inside.y)) * uint(size.x) + uint(inside.x)] >> (8 * colour) & 255u;
    return measured ? panels[view].share[colour * 256 + code] : srgb_decode(float(code) * (1.0 / 255.0));
}

float seen_linear(uint view, uint colour, vec2 tangents) {
    const EyeGeometry g = geometry[view];
    const vec2 px = lens_pixel(g, g.channels[colour], tangents);
    if (px.x < 0.0 || px.y < 0.0 || px.x > float(g.width) || px.y > float(g.height) || !lens_shows(g, int(colour), px)) return -1.0;
    const vec2 position = px - 0.5;
    const vec2 corner = floor(position), t = position - corner;
    const ivec2 at = ivec2(corner);
    return mix(mix(panel_linear(view, at, colour), panel_linear(view, at + ivec2(1, 0), colour), t.x),
               mix(panel_linear(view, at + ivec2(0, 1), colour), panel_linear(view, at + ivec2(1, 1), colour), t.x), t.y);
}

// Light of the three channels, each 0..1 or negative beyond the lens.
vec3 light_of(uint view, vec3 linear) {
    const vec3 sent = max(linear, 0.0);
    if (!measured) return sent * (push.white_cd_m2 - push.black_cd_m2) + push.black_cd_m2;
    return panels[view].black + sent.r * panels[view].light[0] + sent.g * panels[view].light[1] + sent.b * panels[view].light[2];
}
uint shown(float light, float linear) { return linear < 0.0 ? 0 : uint(srgb_encode(clamp(light / push.white_cd_m2, 0.0, 1.0)) * 255.0 + 0.5); }

void main() {
    const uvec2 pixel = gl_GlobalInvocationID.xy;
    const uint view = gl_GlobalInvocationID.z;
    if (pixel.x >= push.size.x || pixel.y >= push.size.y) return;
    const vec2 uv = (vec2(pixel) + 0.5) / vec2(push.size);
    const vec4 field = push.tangents[view];
    const vec2 tangents = vec2(mix(field.x, field.y, uv.x), mix(field.z, field.w, uv.y));
    const vec3 linear = vec3(seen_linear(view, 0, tangents), seen_linear(view, 1, tangents), seen_linear(view, 2, tangents));
    const vec3 light = light_of(view, linear);
    const uvec3 code = uvec3(shown(light.r, linear.r), shown(light.g, linear.g), shown(light.b, linear.b));
    picture[(view * push.size.y + pixel.y) * push.size.x + pixel.x] = code.r | code.g << 8 | code.b << 16 | 0xff000000u;
}
