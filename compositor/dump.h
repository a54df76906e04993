// Pictures of a session's frames as files: DIR/000012_left_warp.exr and so on. Frames count compositions from 0.
#pragma once

#include "compositor/frame.h"

#include <string>

namespace entoptic::compositor {

struct DumpOptions {
    std::string directory;    // empty: no dumps
    WantedPictures stages;    // warp, perceive, lens as .exr in cd/m²; panel, seen as .png
    std::uint32_t every = 1;  // frames 0, every, 2 every …
};

class FrameDumper {
public:
    explicit FrameDumper(DumpOptions options) : options_(std::move(options)) {}
    // Pictures that frame `index` needs.
    WantedPictures wanted(std::uint64_t index) const;
    // Writes those of the frame that `path` composed last, on the caller's time. The first error ends dumping.
    Result<void> write(const FramePath& path, const FrameDescription& frame);

private:
    Result<void> write_eye(const FramePath& path, const FrameDescription& frame, int eye) const;

    DumpOptions options_;
    bool failed_ = false, made_directory_ = false;
};

}  // namespace entoptic::compositor
