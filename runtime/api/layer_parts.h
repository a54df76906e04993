// What several kinds of composition layer have in common, and the curved kinds. For api/layers.cpp.
#pragma once

#include "interfaces/layers.h"
#include "runtime/objects/outcome.h"
#include "runtime/openxr.h"

#include <memory>
#include <vector>

namespace entoptic::runtime {
class Session;
}

namespace entoptic::runtime::api {

struct LayerContext {
    std::shared_ptr<Session> session;
    XrTime time = 0;
    LayerLuminance default_luminance;
};

enum class Holds { colour, depth };

// A rectangle of a swapchain's image released last. `cube`: the swapchain must have six faces, else one.
Outcome resolve_sub_image(const LayerContext& context, const XrSwapchainSubImage& given, Holds holds, SubImage& image, bool cube = false);
Outcome resolve_visibility(XrEyeVisibility given, Layer& layer);

// XR_KHR_composition_layer_cylinder, _equirect, _equirect2.
Outcome resolve_cylinder(const LayerContext& context, const XrCompositionLayerCylinderKHR& given, Layer& layer);
Outcome resolve_equirect(const LayerContext& context, const XrCompositionLayerEquirectKHR& given, Layer& layer);
Outcome resolve_equirect2(const LayerContext& context, const XrCompositionLayerEquirect2KHR& given, Layer& layer);
// XR_KHR_composition_layer_cube: appends the six faces, each a projection layer seen from the middle, when `shown`.
Outcome resolve_cube(const LayerContext& context, const XrCompositionLayerCubeKHR& given, const Layer& base, bool shown,
                     std::vector<Layer>& layers);

}  // namespace entoptic::runtime::api
