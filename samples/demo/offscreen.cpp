#include "samples/demo/offscreen.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

#include "samples/common/failure.h"
#include "samples/common/picture.h"

namespace samples {

static constexpr float pupil_distance = 0.063F;  // m, the mean of adults

static EyeView eye_view(const OffscreenOptions& options, int eye) {
    EyeView view;
    view.orientation = glm::angleAxis(glm::radians(-options.yaw_degrees), glm::vec3(0, 1, 0)) *
                       glm::angleAxis(glm::radians(options.pitch_degrees), glm::vec3(1, 0, 0));
    view.position = view.orientation * glm::vec3((static_cast<float>(eye) - 0.5F) * pupil_distance, 0, 0);
    view.tan_right = std::tan(glm::radians(0.5F * options.fov_degrees));
    view.tan_left = -view.tan_right;
    view.tan_up = view.tan_right * static_cast<float>(options.size.height) / static_cast<float>(options.size.width);
    view.tan_down = -view.tan_up;
    if (options.gaze_degrees.size() == 2) {
        const double right = glm::radians(options.gaze_degrees[0]), up = glm::radians(options.gaze_degrees[1]);
        const glm::vec3 gaze(std::sin(right) * std::cos(up), std::sin(up), -std::cos(right) * std::cos(up));
        view.seen = {gaze, daylight_resolved_angle, daylight_eccentricity_factor};
    }
    return view;
}

// Distance from the eye of every pixel. 1 over the distance along the view's axis is linear in the depth buffer.
static std::vector<float> distances(const Gpu& gpu, const Image& depth, const EyeView& view) {
    std::vector<float> values = read_back_depth(gpu, depth.image.get(), depth.extent);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float u = (static_cast<float>(i % depth.extent.width) + 0.5F) / static_cast<float>(depth.extent.width);
        const float v = (static_cast<float>(i / depth.extent.width) + 0.5F) / static_cast<float>(depth.extent.height);
        const float axis = 1 / std::lerp(1 / OfficeRenderer::near_plane, 1 / OfficeRenderer::far_plane, values[i]);
        values[i] = axis * glm::length(glm::vec3(std::lerp(view.tan_left, view.tan_right, u), std::lerp(view.tan_up, view.tan_down, v), 1));
    }
    return values;
}

static Picture picture_of(const Gpu& gpu, const Image& image, float unit) {
    const std::vector<std::byte> bytes = read_back(gpu, image.image.get(), image.extent, 8);
    Picture picture{image.extent.width, image.extent.height, {}, {}};
    picture.pixels.reserve(bytes.size() / 8);
    for (std::size_t i = 0; i < bytes.size(); i += 8) {
        std::uint64_t halves = 0;
        std::memcpy(&halves, &bytes[i], 8);
        picture.pixels.push_back(glm::vec3(glm::unpackHalf4x16(halves)) * unit);
    }
    return picture;
}

static void print_statistics(const char* name, const Picture& picture) {
    std::vector<float> luminances;
    luminances.reserve(picture.pixels.size());
    double sum = 0;
    for (const glm::vec3& p : picture.pixels) {
        luminances.push_back(glm::dot(p, glm::vec3(0.2126F, 0.7152F, 0.0722F)));
        sum += luminances.back();
    }
    const auto middle = luminances.begin() + static_cast<std::ptrdiff_t>(luminances.size() / 2);
    std::nth_element(luminances.begin(), middle, luminances.end());
    const auto [low, high] = std::minmax_element(luminances.begin(), luminances.end());
    fmt::print("{}: luminance cd/m2 min {:.3g}, median {:.3g}, mean {:.3g}, max {:.3g}\n", name, *low, *middle,
               sum / static_cast<double>(luminances.size()), *high);
}

static void make_folder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) { throw Failure(ExitCode::failed, fmt::format("cannot make the folder {}: {}", folder, error.message())); }
}

void render_offscreen(const Gpu& gpu, OfficeRenderer& renderer, const Light& light, const OffscreenOptions& options) {
    make_folder(options.folder);
    std::vector<Image> images, depths;
    for (int eye = 0; eye < 2; ++eye) {
        images.push_back(create_image(gpu, {.format = OfficeRenderer::format,
                                            .extent = options.size,
                                            .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT}));
        depths.push_back(create_image(gpu, {.format = VK_FORMAT_D32_SFLOAT,
                                            .extent = options.size,
                                            .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT}));
        renderer.add_eye(options.size, {images.back().image.get()}, {depths.back().image.get()});
    }
    const float unit = pre_exposure(renderer.brightest(light));
    renderer.set_light(light, unit);
    std::vector<double> times_ms;
    for (std::uint64_t frame = 0; frame < std::max<std::uint64_t>(options.frames, 1); ++frame) {
        const auto start = std::chrono::steady_clock::now();
        for (int eye = 0; eye < 2; ++eye) { renderer.draw(static_cast<std::uint32_t>(eye), 0, 0, eye_view(options, eye)); }
        renderer.wait();
        times_ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(times_ms.begin(), times_ms.end());
    fmt::print("both eyes in {:.1f} ms (median of {}, fastest {:.1f}); {} cd/m2 per unit of fp16\n", times_ms[times_ms.size() / 2],
               times_ms.size(), times_ms.front(), unit);
    const auto write = [&](const std::string& folder) {
        for (int eye = 0; eye < 2; ++eye) {
            const char* name = eye == 0 ? "left" : "right";
            Picture picture = picture_of(gpu, images[static_cast<std::size_t>(eye)], unit);
            picture.distances = distances(gpu, depths[static_cast<std::size_t>(eye)], eye_view(options, eye));
            print_statistics(name, picture);
            const std::string base = folder + "/" + name;
            write_radiance_map(base + ".exr", picture, 1.0F);
            if (options.png_white_cd_m2 > 0) { write_preview(base + ".png", picture, static_cast<float>(options.png_white_cd_m2)); }
        }
    };
    write(options.folder);
    if (!options.whole_too) { return; }
    for (int eye = 0; eye < 2; ++eye) { renderer.draw_whole(static_cast<std::uint32_t>(eye), 0, 0, eye_view(options, eye)); }
    renderer.wait();
    make_folder(options.folder + "/whole");
    write(options.folder + "/whole");
}

}  // namespace samples
