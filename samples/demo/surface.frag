#version 460
// A matt surface: albedo times the illuminance of four lights, over pi, in units of the layer.
layout(set = 0, binding = 0, std140) uniform View {
    mat4 clip_from_world;
    vec4 channel_radiance[4];
    vec4 eye;
} view;
layout(set = 0, binding = 1) uniform sampler2D lightmap;
layout(set = 1, binding = 0) uniform sampler2D albedo;

layout(location = 0) in vec2 texture_at;
layout(location = 1) in vec2 lightmap_at;
layout(location = 2) in vec3 tint;
layout(location = 0) out vec4 colour;

void main() {
    const vec4 lux = texture(lightmap, lightmap_at);
    const vec3 light = lux.x * view.channel_radiance[0].rgb + lux.y * view.channel_radiance[1].rgb +
                       lux.z * view.channel_radiance[2].rgb + lux.w * view.channel_radiance[3].rgb;
    colour = vec4(min(texture(albedo, texture_at).rgb * tint * light, vec3(65504.0)), 1.0);
}
