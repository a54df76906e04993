#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// The view's picture to the foveated image: each texel the mean of the pixels it covers, by a box of the texel's shape with edges one pixel
// soft, so that the shares of all texels in a pixel add up to one. Where texels are finer than pixels, the pixel that the texel lies in.

#include "perception/foveation/foveation_gpu.h"
#include "shaders/scene_statistics.h"

layout(local_size_x = 32, local_size_y = 8) in;

layout(scalar, binding = 0) readonly buffer Full { vec4 full[]; };
layout(scalar, binding = 1) readonly buffer Places { vec2 places[]; };
layout(scalar, binding = 2) readonly buffer Texels { FoveatedTexel texels[]; };
layout(scalar, binding = 3) writeonly buffer Scene { vec4 scene[]; };
layout(scalar, binding = 4) writeonly buffer SolidAngle { float solid_angle[]; };
layout(scalar, binding = 5) readonly buffer FullDioptre { float full_dioptre[]; };
layout(scalar, binding = 6) writeonly buffer Dioptre { float dioptre[]; };

layout(scalar, push_constant) uniform PushBlock { FoveationPush push; };

const float longest_px = 24.0;     // of a texel; at the rim of a Vive Pro's view it has 12

bool in_view(vec2 place) { return all(greaterThanEqual(place, vec2(0.0))) && all(lessThanEqual(place, vec2(push.width, push.height))); }

// Pixels from one texel to the next along x or y; `lone` where there is no neighbour in the view.
vec2 step_to_next(uvec2 at, uvec2 towards, uint base, vec2 here, vec2 lone) {
    const uvec2 before = at - min(at, towards), after = min(at + towards, uvec2(push.side - 1u));
    vec2 a = places[base + before.y * push.side + before.x], b = places[base + after.y * push.side + after.x];
    float steps = 2.0;
    if (!in_view(a)) { a = here; steps -= 1.0; }
    if (!in_view(b)) { b = here; steps -= 1.0; }
    const vec2 difference = (b - a) / max(steps, 1.0);
    const float size = length(difference);
    return size > 1e-4 ? difference * min(1.0, longest_px / size) : lone;
}

// Weight of a pixel `off` texel widths from the texel's middle, `px` pixels being a texel's width. A box, at least a pixel wide.
float share(float off, float px) {
    const float soft = clamp((px - nearest_until_px) / (filtered_from_px - nearest_until_px), 1e-3, 1.0);
    return clamp((0.5 * max(px, 1.0) - abs(off) * px) / soft + 0.5, 0.0, 1.0);
}

// Where several texels show one pixel, along one axis: what a texel's solid angle has to be multiplied by so that they have the pixel's between
// them. `at` is the texel's middle, `next` the way to the next one, `px` a texel's width, all in pixels.
float shared_among(float at, float next, float px) {
    const float part = fract(at), texels = ceil((1.0 - part) / max(next, 0.05)) + floor(part / max(next, 0.05));
    return mix(1.0 / (px * max(texels, 1.0)), 1.0, clamp((px - nearest_until_px) / (filtered_from_px - nearest_until_px), 0.0, 1.0));
}

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy;
    const uint view = gl_GlobalInvocationID.z, per_view = push.side * push.side;
    if (at.x >= push.side || at.y >= push.side) return;
    const uint texel = at.y * push.side + at.x, base = view * per_view, first = view * push.width * push.height;
    const vec2 here = places[base + texel];
    vec4 sum = vec4(0.0);
    float seen = 0.0, all_shares = 0.0, of_pixel = 1.0;
    if (in_view(here)) {
        const vec2 across = step_to_next(at, uvec2(1, 0), base, here, vec2(1, 0)), down = step_to_next(at, uvec2(0, 1), base, here, vec2(0, 1));
        const float area = across.x * down.y - across.y * down.x;
        const mat2 texels_of_px = abs(area) > 1e-3 * dot(across, across) ? mat2(down.y, -across.y, -down.x, across.x) / area : mat2(1.0);
        // Width of a texel between its sides, pixels; half of the box with its soft edges, texels.
        const vec2 width = vec2(1.0 / length(vec2(texels_of_px[0].x, texels_of_px[1].x)), 1.0 / length(vec2(texels_of_px[0].y, texels_of_px[1].y)));
        of_pixel = shared_among(here.x, across.x, width.x) * shared_among(here.y, down.y, width.y);
        const vec2 half_box = 0.5 * (max(width, vec2(1.0)) + 1.0) / width;
        const vec2 reach = min(abs(across) * half_box.x + abs(down) * half_box.y, vec2(longest_px));
        const ivec2 low = max(ivec2(floor(here - reach)), ivec2(0)), high = min(ivec2(ceil(here + reach)), ivec2(push.width, push.height));
        for (int y = low.y; y < high.y; ++y)
            for (int x = low.x; x < high.x; ++x) {
                const vec2 off = texels_of_px * (vec2(x, y) + 0.5 - here);
                const float weight = share(off.x, width.x) * share(off.y, width.y);
                const vec4 pixel = full[first + uint(y) * push.width + uint(x)];
                const float shown = pixel.w > 0.0 ? weight : 0.0;
                sum.rgb += shown * pixel.rgb;
                sum.w = max(sum.w, weight > 0.0 ? pixel.w : 0.0);
                seen += shown;
                all_shares += weight;
            }
    }
    const bool visible = seen > 0.0;
    scene[base + texel] = visible ? vec4(sum.rgb / seen, sum.w) : vec4(0.0, 0.0, 0.0, pixel_hidden);
    solid_angle[base + texel] = visible ? texels[texel].sr * of_pixel * (seen / all_shares) : 0.0;
    if (push.has_depth == 0u) return;
    // Between an edge's two sides there is nothing: the nearest pixel.
    const uvec2 nearest = min(uvec2(max(here, vec2(0.0))), uvec2(push.width, push.height) - 1u);
    dioptre[base + texel] = visible ? full_dioptre[first + nearest.y * push.width + nearest.x] : unknown_dioptre;
}
