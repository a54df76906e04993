// Layers to what each eye sees of them: all geometry of the warp that does not change from pixel to pixel, in double precision.
#pragma once

#include "compositor/depth_layer.h"
#include "compositor/layer_view.h"
#include "interfaces/layers.h"
#include "shaders/eye_geometry.h"

#include <optional>

namespace entoptic::compositor {

// Where an eye is when the light of the frame leaves the panel.
struct EyePlace {
    Pose world_from_head, head_from_eye;
};

// `layer` as eye `eye` (0 left, 1 right) sees it through the lens of `geometry` (kind geometry_lens; its size says how densely it is looked at).
// Projection layers are turned from the pose they were drawn for to the present one; where the eye stands is ignored, as if all were far
// away. Quads stand in space and are seen from their front (+z) only. Nothing when the eye cannot see the layer at all: hidden from this
// eye, an empty sub-image, a field of view or quad without extent, the quad's back, outside of what the lens shows.
// Cylinders and spheres are seen from within, where they stand; one without a radius is infinitely far away.
// `is_float`: the format of the layer's image can hold values that are not finite.
std::optional<LayerView> layer_view(const Layer& layer, int eye, const EyePlace& place, const EyeGeometry& geometry, bool is_float);

// How far away the same layer is; nothing when layer_view() gives nothing. Projection layers: as their depth image says, along the axis of
// the view that they were drawn for; unusable numbers count as unknown. Quads: where they stand. Curved layers: nothing, they leave the plane as it is.
std::optional<DepthLayer> depth_layer(const Layer& layer, int eye, const EyePlace& place, const EyeGeometry& geometry);

}  // namespace entoptic::compositor
