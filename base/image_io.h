// OpenEXR and PNG through their libraries. Nothing read here is trusted: sizes are bounded, errors say what to do.
#pragma once

#include "base/image.h"
#include "base/result.h"

#include <map>
#include <optional>
#include <string>

namespace entoptic {

// Largest picture accepted from outside, in pixels (a 16k equirectangular map is 134 million).
constexpr std::int64_t max_image_pixels = 200'000'000;

struct ExrImage {
    ImageF rgb;                              // linear, 3 channels, as stored (may hold NaN, infinities, negatives)
    ImageF depth;                            // channel Z beside R, G, B, as stored; empty when there is none or it is subsampled
    std::optional<float> white_luminance;    // attribute whiteLuminance: cd/m² of RGB (1,1,1)
    std::map<std::string, std::string> text; // string attributes
};

// Any OpenEXR image: scan-line or tiled, half or float, RGB(A), Y, or luminance-chroma. Alpha is dropped.
// Errors: not there, not OpenEXR, truncated, no colour channels, more than max_image_pixels.
Result<ExrImage> read_exr(const std::string& path);

struct ExrAttributes {
    std::optional<float> white_luminance;
    std::map<std::string, std::string> text;    // written as string attributes
    std::map<std::string, float> numbers;       // written as float attributes
};

// 1 or 3 channels (Y or RGB), 32-bit float, ZIP compressed; with `depth` (1 channel, same size) also Z.
Result<void> write_exr(const std::string& path, const ImageF& image, const ExrAttributes& attributes = {}, const ImageF& depth = {});

// 8-bit, 1, 3 or 4 channels.
Result<void> write_png(const std::string& path, const Image8& image);
Result<Image8> read_png(const std::string& path);

}  // namespace entoptic
