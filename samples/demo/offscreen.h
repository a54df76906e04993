// The office without OpenXR: both eyes to radiance maps on disk.
#pragma once

#include <string>
#include <vector>

#include "samples/demo/lights.h"
#include "samples/demo/renderer.h"

namespace samples {

struct OffscreenOptions {
    std::string folder;
    VkExtent2D size{1440, 1600};
    float fov_degrees = 90;            // horizontal, symmetric; the vertical one follows from the size, pixels are square
    float yaw_degrees = 0;             // the head turned to the right
    float pitch_degrees = 0;           // the head tilted up
    std::vector<double> gaze_degrees;  // of both eyes, right and up of the view's centre; empty: not known
    bool whole_too = false;            // write the picture in full detail too, into the folder `whole` within
    double png_white_cd_m2 = 0;        // also write PNGs with this luminance as white; 0: none
    std::uint64_t frames = 1;          // draw so often, to measure the time of a frame
};

// What an eye resolves where it looks, rad, and how that falls off (1/rad), as XR_ENTOPTICX_observer tells it for an eye adapted to a panel's white:
// Larson, Rushmeier and Piatko 1997 at 130 cd/m²: 47.8 cycles a degree; twice as coarse at 3.3° (Strasburger, Rentschler and Jüttner 2011).
constexpr float daylight_resolved_angle = 1.827e-4F, daylight_eccentricity_factor = 17.36F;

// Writes left.exr and right.exr in cd/m² (whiteLuminance 1) into the folder, which is made when it is missing, and prints
// luminance statistics and the time of a frame.
void render_offscreen(const Gpu& gpu, OfficeRenderer& renderer, const Light& light, const OffscreenOptions& options);

}  // namespace samples
