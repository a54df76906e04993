// entoptic-viewer: an OpenEXR radiance map around the viewer, in cd/m².
#include <cmath>
#include <csignal>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "samples/common/failure.h"
#include "samples/viewer/viewer.h"

namespace samples {

namespace {

// What any Vulkan device may be expected to take on a side; checked again against the device itself.
constexpr std::uint32_t largest_side = 32768;

struct Options {
    std::string file;
    std::string projection = "auto";
    float fov_degrees = 60;
    std::optional<double> luminance_scale, assume_white;
    std::string format = "auto";
    std::uint64_t frames = 0;
    double seconds = 0;
    bool no_extension = false;
};

std::optional<int> parse(int argc, char** argv, Options& options) {
    CLI::App app{"Shows an OpenEXR radiance map around the viewer, through any OpenXR runtime.", "entoptic-viewer"};
    app.add_option("FILE", options.file, "OpenEXR image, linear RGB or Y")->required();
    app.add_option("--projection", options.projection, "auto (2:1 is equirect), equirect or flat")
        ->check(CLI::IsMember({"auto", "equirect", "flat"}))
        ->capture_default_str();
    app.add_option("--fov", options.fov_degrees, "flat: horizontal field of view, degrees")
        ->check(CLI::Range(1.0, 170.0))
        ->capture_default_str();
    app.add_option("--luminance-scale", options.luminance_scale, "cd/m2 of RGB (1, 1, 1) (default: the file's whiteLuminance)")
        ->check(CLI::PositiveNumber);
    app.add_option("--assume-white", options.assume_white, "the same, for files without whiteLuminance")->check(CLI::PositiveNumber);
    app.add_option("--format", options.format, "fp16, fp32 or auto (as precise as the file)")
        ->check(CLI::IsMember({"auto", "fp16", "fp32"}))
        ->capture_default_str();
    app.add_option("--frames", options.frames, "end the session after N frames drawn");
    app.add_option("--seconds", options.seconds, "end the session after so much displayed time")->check(CLI::NonNegativeNumber);
    app.add_flag("--no-extension", options.no_extension, "leave XR_ENTOPTICX_scene_luminance out");
    app.footer("Equirect: the middle of the map lies ahead, longitudes grow to the right.");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? static_cast<int>(ExitCode::done) : static_cast<int>(ExitCode::usage);
    }
    return std::nullopt;
}

double cd_per_unit(const Options& options, const RadianceMap& map) {
    if (options.luminance_scale) { return *options.luminance_scale; }
    if (map.white_luminance && std::isfinite(*map.white_luminance) && *map.white_luminance > 0) { return *map.white_luminance; }
    if (options.assume_white) { return *options.assume_white; }
    throw Failure(ExitCode::failed,
                  fmt::format("{} does not say how bright it is (no usable whiteLuminance): give --luminance-scale CD, the cd/m2 of "
                              "RGB (1, 1, 1), or --assume-white CD",
                              options.file));
}

Projection projection(const Options& options, const Picture& picture) {
    const bool two_to_one = picture.width == 2 * picture.height;
    const bool flat = options.projection == "flat" || (options.projection == "auto" && !two_to_one);
    return flat ? Projection::flat : Projection::equirect;
}

std::vector<VkFormat> swapchain_formats(const Options& options, const RadianceMap& map) {
    const VkFormat half = VK_FORMAT_R16G16B16A16_SFLOAT, full = VK_FORMAT_R32G32B32A32_SFLOAT;
    if (options.format == "fp16") { return {half}; }
    if (options.format == "fp32") { return {full}; }
    return map.half_precision ? std::vector{half, full} : std::vector{full, half};
}

int run(const Options& options) {
    RadianceMap map = read_radiance_map(options.file, largest_side);
    Viewer::Options viewer_options;
    viewer_options.projection = projection(options, map.picture);
    viewer_options.fov_degrees = options.fov_degrees;
    viewer_options.cd_per_unit = cd_per_unit(options, map);
    XrAppOptions app_options;
    app_options.application = "Entoptic viewer";
    app_options.formats = swapchain_formats(options, map);
    app_options.scene_luminance = !options.no_extension;
    app_options.frames = options.frames;
    app_options.seconds = options.seconds;
    XrApp app(app_options);
    const std::uint32_t limit = app.gpu().properties().limits.maxImageDimension2D;
    if (map.picture.width > limit || map.picture.height > limit) {
        throw Failure(ExitCode::missing,
                      fmt::format("{} is {} x {} pixels and {} draws images up to {} a side: scale it down", options.file,
                                  map.picture.width, map.picture.height, app.gpu().properties().deviceName, limit));
    }
    fmt::print(stderr, "{}: {} x {} {}, {}, {:.6g} cd/m2 per unit\n", options.file, map.picture.width, map.picture.height,
               map.half_precision ? "half" : "float", viewer_options.projection == Projection::flat ? "flat" : "equirect",
               viewer_options.cd_per_unit);
    Viewer viewer(std::move(map), viewer_options);
    if (!app.tells_luminance()) {
        fmt::print(stderr,
                   "entoptic-viewer: XR_ENTOPTICX_scene_luminance is not in use: tell the runtime the scale another way, for "
                   "example `entoptic run --luminance {:.6g} -- …`\n",
                   viewer_options.cd_per_unit);
    }
    std::signal(SIGINT, [](int) { XrApp::request_end(); });
    std::signal(SIGTERM, [](int) { XrApp::request_end(); });
    app.run(viewer);
    return static_cast<int>(ExitCode::done);
}

}  // namespace

}  // namespace samples

int main(int argc, char** argv) {
    return samples::run_reporting_failures("entoptic-viewer", [&] {
        samples::Options options;
        if (const auto exit_code = samples::parse(argc, argv, options)) { return *exit_code; }
        return samples::run(options);
    });
}
