/* XR_ENTOPTICX_scene_luminance: what one unit of a layer's linear value means, in candelas per square metre.
 *
 * Experimental. Public C header of an OpenXR extension of the Entoptic runtime.
 *
 * OpenXR does not say how bright a composition layer is. A runtime that simulates human vision has to know: glare,
 * adaptation and the loss of colour and acuity in the dark all depend on luminance. With this extension an application
 * says it once for each layer and frame.
 */
#ifndef XR_ENTOPTICX_SCENE_LUMINANCE_H_
#define XR_ENTOPTICX_SCENE_LUMINANCE_H_ 1

#include <openxr/openxr.h>

#ifdef __cplusplus
extern "C" {
#endif

#define XR_ENTOPTICX_scene_luminance 1
#define XR_ENTOPTICX_scene_luminance_SPEC_VERSION 1
#define XR_ENTOPTICX_SCENE_LUMINANCE_EXTENSION_NAME "XR_ENTOPTICX_scene_luminance"

/* Structure type. The number lies outside of the ranges that Khronos has given to registered extensions. */
#define XR_TYPE_COMPOSITION_LAYER_SCENE_LUMINANCE_ENTOPTICX ((XrStructureType)1000987000)

/* Valid range of luminancePerUnit, cd/m² per unit. */
#define XR_ENTOPTICX_SCENE_LUMINANCE_MIN 1.0e-6f
#define XR_ENTOPTICX_SCENE_LUMINANCE_MAX 1.0e6f

/* XrCompositionLayerSceneLuminanceENTOPTICX
 *
 * Chained to the `next` of a composition layer (any type whose base is XrCompositionLayerBaseHeader) that is given to
 * xrEndFrame.
 *
 * Members
 *   type              is XR_TYPE_COMPOSITION_LAYER_SCENE_LUMINANCE_ENTOPTICX.
 *   next              is NULL or a pointer to the next structure in a structure chain.
 *   luminancePerUnit  is the luminance in cd/m² of a pixel whose linear red, green and blue are all 1, in Rec.709
 *                     primaries with a D65 white. Linear is the value after the transfer function of the swapchain's
 *                     format: as stored for floating-point and UNORM formats, decoded for _SRGB formats.
 *
 * The luminance of any other pixel is luminancePerUnit * (0.2126 R + 0.7152 G + 0.0722 B).
 *
 * The value holds for this layer in this frame only and may differ in the next one: an application may pre-expose a
 * half-precision swapchain (largest value 65504, smallest normal value 6.1e-5) to suit the light of the moment. The
 * runtime combines layers of different scales in cd/m², before it blends them. Without the structure the runtime takes the
 * application's profile, then its default.
 *
 * Valid usage (implicit)
 *   - The XR_ENTOPTICX_scene_luminance extension must be enabled before this structure is used.
 *   - luminancePerUnit must be finite and greater than 0, else xrEndFrame returns XR_ERROR_VALIDATION_FAILURE.
 *   - luminancePerUnit should lie in [1e-6, 1e6]; the runtime may clamp it to that range.
 *   - A layer's chain must hold at most one of these structures.
 */
typedef struct XrCompositionLayerSceneLuminanceENTOPTICX {
    XrStructureType type;
    const void* XR_MAY_ALIAS next;
    float luminancePerUnit;
} XrCompositionLayerSceneLuminanceENTOPTICX;

#ifdef __cplusplus
}
#endif

#endif /* XR_ENTOPTICX_SCENE_LUMINANCE_H_ */
