#version 460
// Vertices of the office: to clip space, with what the fragment stage looks up.
layout(set = 0, binding = 0, std140) uniform View {
    mat4 clip_from_world;
    vec4 channel_radiance[4];  // colour of each lightmap channel, over pi and over cd/m² per unit
    vec4 eye;
} view;

layout(location = 0) in vec3 position;
layout(location = 1) in vec2 texture_at;
layout(location = 2) in vec2 lightmap_at;  // emitters: x is a factor on their luminance
layout(location = 3) in vec4 tint;

layout(location = 0) out vec2 out_texture_at;
layout(location = 1) out vec2 out_lightmap_at;
layout(location = 2) out vec3 out_tint;
layout(location = 3) out vec3 out_position;

invariant gl_Position;  // lamps are drawn twice, as surfaces and as lights

void main() {
    out_texture_at = texture_at;
    out_lightmap_at = lightmap_at;
    out_tint = tint.rgb;
    out_position = position;
    gl_Position = view.clip_from_world * vec4(position, 1.0);
}
