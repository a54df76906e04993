// Grey pictures of cameras: JPEG (files and frames of a motion JPEG stream, luma only), PGM and PNG, through their libraries. Nothing read
// here is trusted: sizes are bounded, a picture that is cut short or corrupt is an error and not half a picture.
#pragma once

#include "base/image.h"
#include "base/result.h"

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace entoptic {

constexpr int max_gray_side = 16384;  // px; libturbojpeg's own limit is 65500

// Decodes the luma of JPEG pictures; keeps its memory from one to the next. One thread at a time. Frames without Huffman tables (as motion
// JPEG cameras send them) are decoded with the standard's own.
class JpegLumaDecoder {
public:
    JpegLumaDecoder();
    ~JpegLumaDecoder();
    JpegLumaDecoder(JpegLumaDecoder&&) noexcept;
    JpegLumaDecoder& operator=(JpegLumaDecoder&&) noexcept;

    // Into `image`, whose memory is used again; it is garbage after an error. Errors: not a JPEG picture, larger than max_gray_side each way,
    // corrupt or cut short (what libjpeg-turbo only warns of too).
    Result<void> decode(std::span<const std::uint8_t> jpeg, Image8& image);

private:
    struct Handle;
    std::unique_ptr<Handle> handle_;
};

// A PGM, PNG or JPEG file, told by its first bytes, as 8-bit grey (BT.601 luma of colour ones).
Result<Image8> read_gray(const std::string& path);

}  // namespace entoptic
