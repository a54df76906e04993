#include "compositor/dump.h"

#include "base/image_io.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace entoptic::compositor {
namespace {

const char* eye_name(int eye) { return eye == 0 ? "left" : "right"; }

ExrAttributes attributes(const char* what, const FrameDescription& frame, int eye) {
    ExrAttributes a;
    a.white_luminance = 1;  // values are cd/m²
    a.text["what"] = what;
    a.text["unit"] = "cd/m², linear, BT.709 primaries, D65";
    a.text["projection"] = "the panel's own pixel grid, each pixel in the direction in which the green lens shows it";
    a.text["eye"] = eye_name(eye);
    a.text["display_time_ns"] = fmt::format("{}", frame.display_time);
    a.text["frame_id"] = fmt::format("{}", frame.frame_id);
    return a;
}

}  // namespace

WantedPictures FrameDumper::wanted(std::uint64_t index) const {
    if (failed_ || options_.directory.empty() || index % std::max(options_.every, 1u) != 0) return {};
    return options_.stages;
}

Result<void> FrameDumper::write(const FramePath& path, const FrameDescription& frame) {
    if (!wanted(frame.index).any()) return {};
    failed_ = true;  // until all has gone well
    if (!made_directory_) {
        std::error_code error;
        std::filesystem::create_directories(options_.directory, error);
        if (error)
            return failure(fmt::format("The folder for dumps, {}, cannot be made: {}. Dumping ends.", options_.directory, error.message()));
        made_directory_ = true;
    }
    for (int eye = 0; eye < eye_count; ++eye) {
        if (auto written = write_eye(path, frame, eye); !written) {
            written.error().message += " Dumping ends; the session goes on.";
            return written;
        }
    }
    failed_ = false;
    return {};
}

Result<void> FrameDumper::write_eye(const FramePath& path, const FrameDescription& frame, int eye) const {
    const auto file = [&](const char* stage, const char* extension) {
        return (std::filesystem::path(options_.directory) / fmt::format("{:06}_{}_{}.{}", frame.index, eye_name(eye), stage, extension))
            .string();
    };
    const WantedPictures& stages = options_.stages;
    if (stages.warp)
        ENTOPTIC_CHECK(
            write_exr(file("warp", "exr"), path.warp_picture(eye), attributes("scene luminance, before perception", frame, eye)));
    if (stages.perceive)
        ENTOPTIC_CHECK(
            write_exr(file("perceive", "exr"), path.perceive_picture(eye), attributes("display light, after perception", frame, eye)));
    if (stages.lens)
        ENTOPTIC_CHECK(write_exr(file("lens", "exr"), path.lens_picture(eye),
                                 attributes("light of each panel pixel, colours moved for the lens", frame, eye)));
    if (stages.panel) ENTOPTIC_CHECK(write_png(file("panel", "png"), path.panel_picture(eye)));
    if (stages.seen) ENTOPTIC_CHECK(write_png(file("seen", "png"), path.seen_picture(eye)));
    return {};
}

}  // namespace entoptic::compositor
