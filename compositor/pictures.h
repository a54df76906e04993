// The three pictures of a frame. They are different types, so that a stage cannot be given the wrong one. All are references to GPU
// storage buffers of both eyes, rows from the top, left eye first; the owner of the buffers is named with each.
#pragma once

#include "gpu/memory.h"

#include <cstdint>

namespace entoptic::compositor {

struct PictureSize {
    std::uint32_t width = 0, height = 0;  // pixels of one eye
    std::size_t pixels() const { return std::size_t(width) * height; }
};

// What the scene sends towards the eyes: vec4 a pixel; R, G, B in cd/m² (linear, BT.709, D65), w: pixel_hidden, pixel_visible or pixel_cleaned
// (shaders/scene_statistics.h).
// On the eye image's grid (EyeGeometry, kind geometry_lens). Belongs to perception::Stage.
struct SceneImage {
    const gpu::Buffer* pixels = nullptr;
    PictureSize size;
};

// What the panel should send to the eyes so that they see the scene as the observer would: same layout and grid, display light in cd/m².
// The perception stage works in place: the buffer is the scene's.
struct SeenImage {
    const gpu::Buffer* pixels = nullptr;
    PictureSize size;
};

// Light of each panel pixel: vec3 a pixel, R, G, B in cd/m². On the panel's own grid, each colour where its light leaves the panel.
// Belongs to LensPass.
struct PanelImage {
    const gpu::Buffer* light = nullptr;
    PictureSize size;
};

// What is sent to the panel: one uint a pixel, 8-bit R, G, B, A = 255 from the lowest byte. Belongs to FramePath.
struct PanelCodes {
    const gpu::Buffer* codes = nullptr;
    PictureSize size;
};

}  // namespace entoptic::compositor
