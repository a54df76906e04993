// A kernel's profile at an angle, per sr. Include after declaring the buffer `profile`.
#ifndef ENTOPTIC_PERCEPTION_GLARE_GLARE_RADIAL_GLSL
#define ENTOPTIC_PERCEPTION_GLARE_GLARE_RADIAL_GLSL

#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_math.glsl"

vec3 radial_entry(uint i, vec3 weights) {
    return weights.x * profile[i].part[0] + weights.y * profile[i].part[1] + weights.z * profile[i].part[2];
}

vec3 radial_kernel(float theta, uint first, vec3 weights) {
    const float place = radial_place(theta, radial_first, radial_entries);
    const uint i = min(uint(place), radial_entries - 2);
    return mix(radial_entry(first + i, weights), radial_entry(first + i + 1, weights), place - float(i));
}

#endif
