// Makes one text readable by C++ and by GLSL. Structs shared by both use scalar layout on the GPU, so that there is no padding to
// think about, and these names:
//   vec2 vec3 vec4 uint         as in GLSL
// Mathematics that is compiled twice (files *_math.glsl) uses:
//   real rvec2 rvec3 rmat3      float in GLSL, double in C++ (through GLM)
//   FN                          in front of every function
//   OUT(T) INOUT(T)             for output parameters
//   LIT(x)                      around every literal with a fraction: `LIT(0.04)`
#ifndef ENTOPTIC_SHADERS_SHARED_TYPES_H
#define ENTOPTIC_SHADERS_SHARED_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace entoptic {
using glm::vec2;
using glm::vec3;
using glm::vec4;
using uint = std::uint32_t;
}  // namespace entoptic
// Wrap the inclusion of a *_math.glsl in namespaces of your own:  namespace entoptic::perception::key_reinhard_math { … }
#define ENTOPTIC_MATH_BEGIN(name)                 \
    namespace entoptic::name {                    \
    using namespace glm;                          \
    using real = double;                          \
    using rvec2 = glm::dvec2;                     \
    using rvec3 = glm::dvec3;                     \
    using rmat3 = glm::dmat3;                     \
    using uint = std::uint32_t;
#define ENTOPTIC_MATH_END }
#define FN inline
#define OUT(T) T&
#define INOUT(T) T&
#define LIT(x) (x)
#else
#define ENTOPTIC_MATH_BEGIN(name)
#define ENTOPTIC_MATH_END
#define real float
#define rvec2 vec2
#define rvec3 vec3
#define rmat3 mat3
#define FN
#define OUT(T) out T
#define INOUT(T) inout T
#define LIT(x) float(x)
#endif

#endif
