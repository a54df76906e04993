// What it costs and loses to keep the scene in a smaller format than decision 0002's: measured by `entoptic bench`.
#pragma once

#include "base/image.h"
#include "base/result.h"
#include "gpu/commands.h"

namespace entoptic::perception {

// Numbers are those of storage_pass.comp. fp32 and fp16 hold visibility, too; the others three channels only.
enum class StorageFormat : std::uint32_t { fp32, fp16, r11g11b10, rgb9e5 };

struct Stored {
    ImageF picture;               // as it comes back
    std::vector<double> pass_ms;  // GPU time of a pass that reads and writes every pixel, apiece
};

// Puts `rgb` (finite, not negative) into the format times `scale`, runs `passes` passes over it, and reads it back. Values too large for the
// format become its largest.
Result<Stored> through_storage(gpu::Device& device, const ImageF& rgb, StorageFormat format, float scale, int passes);

// The power of two with which the brightest channel of `rgb` lies at or below 32768: pre-exposure for fp16.
float pre_exposure(const ImageF& rgb);

}  // namespace entoptic::perception
