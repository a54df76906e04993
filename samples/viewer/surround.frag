#version 460
// A radiance map at infinity, seen in the direction of each pixel. Values pass as they are.
layout(set = 0, binding = 0) uniform sampler2D map;
layout(push_constant) uniform View {
    vec4 tangents;       // left, right, up, down
    vec4 orientation;    // quaternion x, y, z, w: world from eye
    vec2 half_size;      // flat: tangents of half its width and height
    uint flat_map;       // 0: equirectangular
} view;

layout(location = 0) in vec2 screen;
layout(location = 0) out vec4 colour;

const float pi = 3.14159265358979;

vec3 rotated(vec4 q, vec3 v) {
    return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

// Longitude 0 (the middle of the map) lies ahead, along -z; longitudes grow to the right, the top row is straight up.
vec2 equirect_coordinates(vec3 d) {
    return vec2(0.5 + atan(d.x, -d.z) / (2.0 * pi), acos(clamp(d.y / length(d), -1.0, 1.0)) / pi);
}

void main() {
    const vec3 in_eye = vec3(mix(view.tangents.x, view.tangents.y, screen.x), mix(view.tangents.z, view.tangents.w, screen.y), -1.0);
    const vec3 direction = rotated(view.orientation, in_eye);
    vec2 at = equirect_coordinates(direction);
    bool inside = true;
    if (view.flat_map != 0) {
        const vec2 on_plane = direction.xy / (-direction.z * view.half_size);
        inside = direction.z < 0.0 && all(lessThanEqual(abs(on_plane), vec2(1.0)));
        at = vec2(0.5 + 0.5 * on_plane.x, 0.5 - 0.5 * on_plane.y);
    }
    const vec3 value = textureLod(map, at, 0.0).rgb;
    colour = vec4(inside ? value : vec3(0.0), 1.0);
}
