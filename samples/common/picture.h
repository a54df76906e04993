// Pictures on disk: radiance maps in OpenEXR, and a PNG for looking at them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace samples {

// Linear Rec.709 RGB, row by row from the top left.
struct Picture {
    std::uint32_t width = 0, height = 0;
    std::vector<glm::vec3> pixels;
    std::vector<float> distances;  // metres from the eye; empty: not known
};

// What a file says beside its pixels.
struct RadianceMap {
    Picture picture;
    bool half_precision = false;            // every channel is stored as half: fp16 holds it without loss
    std::optional<double> white_luminance;  // attribute whiteLuminance: cd/m² of RGB (1, 1, 1)
};

// Reads any single- or multi-part OpenEXR image with channels R, G, B, or Y with or without RY and BY: half, float or uint,
// scan lines or tiles. A `chromaticities` attribute other than Rec.709's is converted; values are otherwise as stored, NaN
// and negatives included. Throws Failure when the file is missing, damaged, of another kind, or wider or higher than
// `largest_side`.
RadianceMap read_radiance_map(const std::string& path, std::uint32_t largest_side);

// Writes 32-bit float RGB, and the distances as channel Z. `white_luminance` is the attribute of that name, cd/m² of RGB (1, 1, 1).
void write_radiance_map(const std::string& path, const Picture& picture, float white_luminance);

// Writes 8-bit sRGB: values divided by `white`, a soft shoulder above 0.8. For looking, not for measuring.
void write_preview(const std::string& path, const Picture& picture, float white);

}  // namespace samples
