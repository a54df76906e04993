// A headset's display and optics, as its driver knows them.
#pragma once

#include "base/pose.h"
#include "base/time.h"
#include "interfaces/sources.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>

namespace entoptic {

// Radial distortion of one colour: where light of a panel pixel comes from. Same for C++ and GLSL (see shaders/geometry.glsl).
//   x = 2u-1-ax, y = (2v-1)/aspect - ay, r2 = x²+y², d = 1/(1 + k0 r2 + k1 r2² + k2 r2³)
//   (X, Y) = (x d + ax, (y d + ay) aspect): normalised device coordinates of the undistorted view, times 1+grow
// (u,v in [0,1], v down, one eye's half of the panel.) Source: facts/devices.md 1.4.
struct ChannelDistortion {
    glm::vec2 centre{0};          // ax, ay
    glm::vec3 coefficients{0};    // k0, k1, k2
};

// One eye's lens. Direction seen through panel position (u,v), from (X, Y) above and the intrinsics:
//   tan_x = (X + cx)/fx, tan_y = (cy - Y)/fy, direction = normalize(tan_x, tan_y, -1).
// This is the file's own mapping display -> render target (U, V in [0,1] over the field of view below) written in tangents.
struct Lens {
    std::array<ChannelDistortion, 3> channels;   // red, green, blue
    float aspect = 0.9f;                         // physical_aspect_x_over_y
    float grow_for_undistort = 0.6f;
    float r2_cutoff = 1.13f;                     // nothing is seen through the lens where r2 of green exceeds this
    glm::vec2 focal{1.208f, 1.088f};             // fx, fy of the undistorted view, NDC per tangent
    glm::vec2 principal_point{0};                // cx, cy
};

// One eye's panel as a light meter saw it. A pixel sends what its three channels send at their codes, and the black.
struct MeasuredPanel {
    std::array<std::array<float, 256>, 3> curve{};   // by channel and code: share of the light at code 255; 0 at 0, 1 at 255, rising
    std::array<glm::vec3, 3> light{};                // of each channel at code 255 less its black: linear BT.709, cd/m²
    glm::vec3 black{0};                              // of code 0 in all channels: linear BT.709, cd/m²

    // False when one channel's colour is a mixture of the others' to within a hundredth (the volume that the three span, over that of right
    // angles): codes would follow the meter's noise.
    bool has_three_primaries() const {
        const double volume = std::abs(double(glm::determinant(glm::dmat3(light[0], light[1], light[2]))));
        return volume > 0.01 * double(glm::length(light[0])) * double(glm::length(light[1])) * double(glm::length(light[2]));
    }
};

// Light of the panel.
struct Photometry {
    float white_cd_m2 = 130;    // brightest D65 white that both eyes can show; code 255 in all channels of a nominal panel
    float black_cd_m2 = 0.04f;  // luminance of code 0, the brighter eye's
    // Null: primaries are BT.709 / D65 and the code curve is sRGB's. Else codes are made from a file in displays/.
    std::shared_ptr<const std::array<MeasuredPanel, 2>> measured;
};

struct DisplayIdentity {
    std::string name;                    // "HTC Vive Pro (virtual)"
    int panel_width = 1440, panel_height = 1600;   // pixels, one eye
    DurationNs period = ns_per_s / 90;   // of a refresh, rounded
    DurationNs vblank_to_photon = 0;     // from the vblank that starts scan-out to the middle of the light
    Photometry photometry;
    std::int64_t refresh_numerator = 90, refresh_denominator = 1;   // refreshes per second, exact

    // When refresh k after `start` happens, to the nearest nanosecond; k >= 0. Does not drift, as a sum of rounded periods would.
    TimeNs refresh_time(TimeNs start, std::int64_t k) const {
        const std::int64_t whole = k / refresh_numerator, rest = k % refresh_numerator;
        return start + whole * refresh_denominator * ns_per_s + (rest * refresh_denominator * ns_per_s + refresh_numerator / 2) / refresh_numerator;
    }
};

struct EyeOptics {
    Lens lens;
    Fov fov;                // the rectilinear view an application has to render to fill what the lens shows
    Pose head_from_eye;     // x = -IPD/2 for the left eye
};

// Everything the runtime and the compositor need of a headset. Sources live as long as the headset.
struct Headset {
    DisplayIdentity display;
    std::array<EyeOptics, 2> eyes;
    PoseSource* head = nullptr;         // never null
    EyeSource* eye_tracker = nullptr;   // never null; may say that it is absent
    std::array<ControllerSource*, 2> controllers{};   // left, right; null when there is none
    PresenceSource* presence = nullptr; // null: the headset cannot tell whether somebody wears it
    StatusSource* status = nullptr;     // null: always there, and nothing more to say
    glm::vec2 play_area_m{0};           // free floor about the world's origin, along x and z, metres; 0 when nobody has measured the room
    std::shared_ptr<void> owner;        // keeps the driver alive
};

}  // namespace entoptic
