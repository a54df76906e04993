// The office without OpenXR: both eyes to radiance maps on disk.
#pragma once

#include <string>

#include "samples/demo/lights.h"
#include "samples/demo/renderer.h"

namespace samples {

struct OffscreenOptions {
    std::string folder;
    VkExtent2D size{1440, 1600};
    float fov_degrees = 90;      // horizontal, symmetric; the vertical one follows from the size, pixels are square
    float yaw_degrees = 0;       // the head turned to the right
    float pitch_degrees = 0;     // the head tilted up
    double png_white_cd_m2 = 0;  // also write PNGs with this luminance as white; 0: none
    std::uint64_t frames = 1;    // draw so often, to measure the time of a frame
};

// Writes left.exr and right.exr in cd/m² (whiteLuminance 1) into the folder, which is made when it is missing, and prints
// luminance statistics and the time of a frame.
void render_offscreen(const Gpu& gpu, OfficeRenderer& renderer, const Light& light, const OffscreenOptions& options);

}  // namespace samples
