#include "app/simulation/scene_input.h"

#include "app/parse.h"
#include "base/image_io.h"
#include "shaders/colour_math.glsl"
#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

constexpr double min_scale = 1e-6, max_scale = 1e8;
constexpr double degree = 0.017453292519943295;

Result<double> choose_scale(const std::string& path, const SceneOptions& options, std::optional<float> white, std::string& source) {
    const auto checked = [&](double value) -> Result<double> {
        if (value >= min_scale && value <= max_scale) return value;
        const std::string what = fmt::format(
            "The luminance scale of '{}' is {:g} cd/m² ({}); it must lie between {:g} and {:g}. Give another with --luminance-scale.", path,
            value, source, min_scale, max_scale);
        return source.starts_with("--") ? usage_error(what) : failure(what);
    };
    if (options.luminance_scale) {
        source = "--luminance-scale";
        return checked(*options.luminance_scale);
    }
    if (white) {
        source = fmt::format("whiteLuminance of {}", path);
        return checked(static_cast<double>(*white));
    }
    if (options.assume_white) {
        source = "--assume-white";
        return checked(*options.assume_white);
    }
    return usage_error(
        fmt::format("'{}' does not say how bright it is (no attribute whiteLuminance). Give the cd/m² of RGB (1,1,1) with "
                    "--luminance-scale, or with --assume-white for files that do not say.",
                    path));
}

ImageF averaged(const ImageF& in, int k) {
    ImageF out(std::max(1, in.width / k), std::max(1, in.height / k), in.channels);
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x)
            for (int c = 0; c < in.channels; ++c) {
                double sum = 0;
                int count = 0;
                for (int j = y * k; j < std::min(in.height, (y + 1) * k); ++j)
                    for (int i = x * k; i < std::min(in.width, (x + 1) * k); ++i, ++count) sum += static_cast<double>(in.at(i, j, c));
                out.at(x, y, c) = static_cast<float>(sum / count);
            }
    return out;
}

// One pixel's distance for k x k: a mean would lie where there is nothing.
ImageF thinned(const ImageF& in, int k) {
    if (in.data.empty() || k == 1) return in;
    ImageF out(std::max(1, in.width / k), std::max(1, in.height / k), 1);
    for (int y = 0; y < out.height; ++y)
        for (int x = 0; x < out.width; ++x) out.at(x, y, 0) = in.at(std::min(x * k + k / 2, in.width - 1), std::min(y * k + k / 2, in.height - 1), 0);
    return out;
}

// The number in `file` if it is `prefix`, digits, `suffix`.
std::optional<int> number_in(const std::string& file, const std::string& prefix, const std::string& suffix) {
    if (file.size() <= prefix.size() + suffix.size() || !file.starts_with(prefix) || !file.ends_with(suffix)) return std::nullopt;
    const std::string digits = file.substr(prefix.size(), file.size() - prefix.size() - suffix.size());
    if (digits.size() > 9 || digits.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
    return std::stoi(digits);
}

// The numbers of the files that `name` stands for, in order.
std::vector<int> numbers_of(const NumberedName& numbered, const std::string& name) {
    const fs::path pattern(name);
    const std::string file = pattern.filename();
    const auto percent = file.find('%'), d = file.find('d', percent);
    std::vector<int> numbers;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(pattern.has_parent_path() ? pattern.parent_path() : fs::path("."), error)) {
        const auto n = number_in(entry.path().filename(), file.substr(0, percent), file.substr(d + 1));
        if (n && fs::path(numbered.with(*n, 0)).filename() == entry.path().filename()) numbers.push_back(*n);
    }
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

double clean(float v) {
    const double x = static_cast<double>(v);
    return x > 0 ? std::min(x, static_cast<double>(max_scene_cd_m2)) : 0;
}

}  // namespace

Result<Scene> load_scene(const std::string& path, const SceneOptions& options) {
    ENTOPTIC_TRY(file, read_exr(path));
    Scene scene;
    ENTOPTIC_TRY(scale, choose_scale(path, options, file.white_luminance, scene.scale_source));
    scene.cd_per_unit = scale;
    scene.rgb = options.downscale > 1 ? averaged(file.rgb, options.downscale) : std::move(file.rgb);
    scene.depth = thinned(file.depth, options.downscale);
    for (float& v : scene.rgb.data) v = static_cast<float>(static_cast<double>(v) * scale);
    return scene;
}

Result<std::vector<InputFile>> input_files(const std::string& name) {
    ENTOPTIC_TRY(numbered, NumberedName::parse(name));
    if (numbered.has_time()) return usage_error(fmt::format("'{}': %t belongs into the output's name.", name));
    if (!numbered.has_number()) return std::vector<InputFile>{{name, 0}};
    std::vector<InputFile> files;
    for (const int n : numbers_of(numbered, name)) {
        if (!files.empty() && n != files.back().number + 1)
            return failure(
                fmt::format("'{}' is missing, though there are frames before it and after it. Make it, or take the later ones elsewhere: "
                            "time must not jump.",
                            numbered.with(files.back().number + 1, 0)));
        files.push_back({numbered.with(n, 0), n});
    }
    if (files.empty()) return failure(fmt::format("There is no file like '{}'. Check the folder and the number of digits.", name));
    return files;
}

Result<EyeGeometry> scene_geometry(std::optional<Projection> projection, std::optional<double> fov_deg, int width, int height) {
    if (!projection && !fov_deg && width != 2 * height)
        return usage_error(
            fmt::format("What field of view does this picture of {} x {} pixels show? Give --fov DEGREES (horizontal), or --projection "
                        "equirect for a full sphere.",
                        width, height));
    EyeGeometry g{};
    g.width = static_cast<uint>(width);
    g.height = static_cast<uint>(height);
    if (projection == Projection::equirect && width != 2 * height)
        return usage_error(fmt::format(
            "--projection equirect shows the full sphere, twice as wide as high; this picture has {} x {} pixels.", width, height));
    if (projection.value_or(fov_deg ? Projection::rectilinear : Projection::equirect) == Projection::equirect) {
        if (fov_deg) return usage_error("--fov does not go with --projection equirect, which always shows the full sphere.");
        g.kind = geometry_equirect;
        return g;
    }
    if (!fov_deg) return usage_error("A rectilinear picture needs its horizontal field of view: give --fov DEGREES.");
    if (!(*fov_deg > 0.01 && *fov_deg < 179))
        return usage_error(fmt::format("--fov {:g}: a flat picture shows more than 0.01 and less than 179 degrees.", *fov_deg));
    g.kind = geometry_rectilinear;
    const double half = std::tan(*fov_deg * 0.5 * degree);
    g.tan_right = static_cast<float>(half);
    g.tan_left = -g.tan_right;
    g.tan_up = static_cast<float>(half * height / width);
    g.tan_down = -g.tan_up;
    return g;
}

double mean_luminance(const ImageF& rgb, const EyeGeometry& geometry) {
    double sum = 0, sr = 0;
    for (int y = 0; y < rgb.height; ++y)
        for (int x = 0; x < rgb.width; ++x) {
            const double w = geometry::geometry_solid_angle(geometry, {x + 0.5, y + 0.5});
            sum += w * colour::luminance({clean(rgb.at(x, y, 0)), clean(rgb.at(x, y, 1)), clean(rgb.at(x, y, 2))});
            sr += w;
        }
    return sr > 0 ? sum / sr : 0;
}

double field_deg2(const EyeGeometry& geometry) {
    if (geometry.kind == geometry_equirect) return 4 * 180 * 180 / (180 * degree);
    // Solid angle of a rectangle on the tangent plane: 4 asin(sin a sin b), a and b half the angles (van Oosterom and Strackee give the same).
    const double a = std::atan(static_cast<double>(geometry.tan_right)), b = std::atan(static_cast<double>(geometry.tan_up));
    return 4 * std::asin(std::sin(a) * std::sin(b)) / (degree * degree);
}

}  // namespace entoptic::app
