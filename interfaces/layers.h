// What an application submits for one frame, with everything resolved to poses, rectangles and cd/m².
#pragma once

#include "base/pose.h"
#include "base/time.h"

#include <array>
#include <cstdint>
#include <vector>

namespace entoptic {

constexpr int eye_count = 2;              // 0 left, 1 right
constexpr std::uint32_t max_layers = 16;  // XrSystemGraphicsProperties::maxLayerCount

// A rectangle of one array slice of one image of a swapchain. Texels, counted from the first of the first row in memory.
// The runtime has checked that it lies inside the image.
struct SubImage {
    std::uint64_t swapchain = 0;    // FrameService's id
    std::uint32_t image_index = 0;  // of the image released last
    std::uint32_t array_layer = 0;
    std::int32_t x = 0, y = 0, width = 0, height = 0;  // may be zero: the layer shows nothing then
    bool bottom_up = false;  // the first row is the picture's lowest (OpenGL), else its highest
};

// How linear layer values become luminance: cd/m² = value * cd_per_unit + offset_cd, for R = G = B = value.
// An SDR layer has cd_per_unit = panel white - panel black and offset = panel black, so that its codes come back to the bit.
enum class LuminanceSource { default_sdr, application_profile, layer_extension, command_line };
struct LayerLuminance {
    float cd_per_unit = 130;
    float offset_cd = 0;
    LuminanceSource source = LuminanceSource::default_sdr;
};

enum class LayerKind { projection, quad, cylinder, equirect };
enum class EyeVisibility { both, left, right };

// How far away a projection layer's picture is. 1 over the distance along the view's axis is linear in the texel: 1/near_z_m where it is
// min_depth, 1/far_z_m where it is max_depth. Either may be infinite, and near may lie beyond far.
struct LayerDepth {
    SubImage image;  // width 0: the application does not say
    float min_depth = 0, max_depth = 1;
    float near_z_m = 0, far_z_m = 0;
};

struct LayerView {
    Pose space_from_view;  // projection: pose of the eye the picture was rendered for, in the layer's space
    Fov fov;
    SubImage image;
    LayerDepth depth;  // projection only
};

// The inside of a cylinder about y or of a sphere, seen from within. Longitude 0 lies at -z and grows towards +x.
struct CurvedSurface {
    Pose space_from_centre;
    float radius_m = 0;                                // 0 or infinite: infinitely far away
    float longitude_centre = 0, longitude_extent = 0;  // radians: what the image's width spans
    float latitude_top = 0, latitude_bottom = 0;       // equirect, radians: of the image's upper and lower edge
    float height_m = 0;                                // cylinder; for an infinite one, of radius 1
};

// What a layer's linear colour is multiplied with, and what is added, after it was multiplied by alpha: R, G, B, alpha.
struct LayerTint {
    std::array<float, 4> scale{1, 1, 1, 1}, bias{0, 0, 0, 0};
    bool operator==(const LayerTint&) const = default;
};

// One composition layer. Painter's order: the first is farthest back.
struct Layer {
    LayerKind kind = LayerKind::projection;
    EyeVisibility visibility = EyeVisibility::both;
    bool blend_texture_source_alpha = false;  // else the layer is opaque
    bool unpremultiplied_alpha = false;       // colours are not yet multiplied by alpha
    bool replaces_previous = false;           // where it shows something, the layer before it does not: the inset of a foveated view
    LayerLuminance luminance;
    bool head_locked = false;  // the layer's space moves with the head: `anchor` is head_from_space, else world_from_space
    Pose anchor;
    std::array<LayerView, eye_count> views;  // projection: per eye; others: views[0].image for both
    Pose space_from_quad;                    // quad: its centre, facing +z, x right, y up
    float quad_width_m = 0, quad_height_m = 0;
    CurvedSurface surface;  // cylinder, equirect
    LayerTint tint;
};

// One xrEndFrame.
struct FrameSubmission {
    std::uint64_t frame_id = 0;  // of the wait_frame() it answers
    TimeNs display_time = 0;     // the application's displayTime
    std::vector<Layer> layers;   // at most max_layers; empty shows black
};

}  // namespace entoptic
