#version 460
// What gives light: radiance * (edge + (1 - edge) mu^p), mu the cosine between the normal of a sphere and the line of sight.
// edge = 1 for all but the bulb.
layout(set = 0, binding = 0, std140) uniform View {
    mat4 clip_from_world;
    vec4 channel_radiance[4];
    vec4 eye;
} view;
layout(set = 1, binding = 0) uniform sampler2D pattern;
layout(push_constant) uniform Emission {
    vec4 radiance_and_edge;
    vec4 centre_and_exponent;
} emission;

layout(location = 0) in vec2 texture_at;
layout(location = 1) in vec2 factor;
layout(location = 2) in vec3 tint;
layout(location = 3) in vec3 position;
layout(location = 0) out vec4 colour;

void main() {
    const vec3 normal = normalize(position - emission.centre_and_exponent.xyz);
    const float mu = max(dot(normal, normalize(view.eye.xyz - position)), 1e-4);
    const float edge = emission.radiance_and_edge.w;
    const float profile = edge + (1.0 - edge) * pow(mu, emission.centre_and_exponent.w);
    const vec3 radiance = emission.radiance_and_edge.rgb * texture(pattern, texture_at).rgb * tint * factor.x * profile;
    colour = vec4(min(radiance, vec3(65504.0)), 1.0);
}
