#include "samples/demo/lights.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include <fmt/format.h>

#include "samples/common/failure.h"
#include "samples/demo/bake.h"

namespace samples {

double bulb_profile_exponent() {
    constexpr double pi = std::numbers::pi;
    constexpr double area = 4 * pi * bulb_radius_m * bulb_radius_m;
    constexpr double mean = bulb_flux_lm / (2 * pi * area * bulb_peak_cd_m2);  // = edge / 2 + (1 - edge) / (p + 2)
    return (1 - bulb_edge_share) / (mean - bulb_edge_share / 2) - 2;
}

Light preset_light(std::string_view name) {
    const auto* const preset = std::find_if(presets.begin(), presets.end(), [name](const Preset& p) { return p.name == name; });
    if (preset == presets.end()) {
        throw Failure(ExitCode::usage, fmt::format("no light is called {}: use day, dusk, night, starlight or cycle", name));
    }
    return preset->light;
}

// ---- scripts --------------------------------------------------------------------------------------------------------------------

static Light mixed(const Light& a, const Light& b, double t) {
    constexpr double darkest = 1e-7;  // cd/m²; a sky of 0 has no logarithm
    const double from = std::log(std::max(a.sky_cd_m2, darkest)), to = std::log(std::max(b.sky_cd_m2, darkest));
    return {t <= 0   ? a.sky_cd_m2
            : t >= 1 ? b.sky_cd_m2
                     : std::exp(std::lerp(from, to, t)),
            std::lerp(a.moon, b.moon, t), std::lerp(a.ceiling, b.ceiling, t), std::lerp(a.lamp, b.lamp, t)};
}

Light LightScript::at(double seconds) const {
    if (period_ > 0) { seconds = std::fmod(std::max(seconds, 0.0), period_); }
    const auto after = std::find_if(keyframes_.begin(), keyframes_.end(), [&](const Keyframe& k) { return k.seconds > seconds; });
    if (after == keyframes_.begin()) { return keyframes_.front().light; }
    const auto before = after - 1;
    if (after == keyframes_.end()) { return before->light; }
    return mixed(before->light, after->light, (seconds - before->seconds) / (after->seconds - before->seconds));
}

LightScript LightScript::day_cycle() {
    LightScript script({{0, {5000, 0, 1, 0}},
                        {15, {500, 0, 1, 0}},
                        {20, {100, 0, 0, 0}},
                        {30, {5, 0, 0, 0}},
                        {30.5, {4.5, 0, 0, 1}},
                        {45, {0.02, 1, 0, 1}},
                        {50, {0.02, 1, 0, 1}},
                        {50.1, {0.02, 1, 0, 0}},
                        {60, {0.002, 0, 0, 0}},
                        {75, {0.002, 0, 0, 0}},
                        {100, {5, 0, 0, 0}},
                        {120, {5000, 0, 1, 0}}});
    script.period_ = 120;
    return script;
}

static LightScript::Keyframe parse_keyframe(const std::string& line, const std::string& place) {
    std::istringstream fields(line);
    std::array<double, 5> values{};
    for (double& value : values) {
        std::string field;
        std::getline(fields, field, ',');
        bool is_number = true;
        try {
            std::size_t used = 0;
            value = std::stod(field, &used);
            is_number = field.find_first_not_of(" \t\r", used) == std::string::npos;
        } catch (const std::exception&) { is_number = false; }
        if (!is_number || !std::isfinite(value) || value < 0) {
            throw Failure(ExitCode::usage,
                          fmt::format("{}: expected five numbers of 0 or more: time_s,sky_cd_m2,moon,ceiling,lamp", place));
        }
    }
    return {values[0], {values[1], values[2], values[3], values[4]}};
}

LightScript LightScript::load(const std::string& path) {
    std::ifstream file(path);
    if (!file) { throw Failure(ExitCode::usage, fmt::format("cannot read the script {}", path)); }
    std::vector<Keyframe> keyframes;
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        const std::size_t start = line.find_first_not_of(" \t\r");
        const bool header = start != std::string::npos && (line[start] == '#' || line.compare(start, 4, "time") == 0);
        if (start == std::string::npos || header) { continue; }
        const std::string place = fmt::format("{}:{}", path, number);
        keyframes.push_back(parse_keyframe(line, place));
        if (keyframes.size() > 1 && keyframes.back().seconds <= keyframes[keyframes.size() - 2].seconds) {
            throw Failure(ExitCode::usage, fmt::format("{}: times must rise from line to line", place));
        }
    }
    if (keyframes.empty()) { throw Failure(ExitCode::usage, fmt::format("the script {} has no keyframes", path)); }
    return LightScript(std::move(keyframes));
}

// ---- colours --------------------------------------------------------------------------------------------------------------------

// Chromaticity by the cubic fits of Kim et al. 2002 (US patent 7024034), within 0.001 of the Planckian locus.
glm::vec3 blackbody(double kelvin) {
    const double i = 1e3 / kelvin;
    const double x = kelvin <= 4000 ? ((-0.2661239 * i - 0.2343589) * i + 0.8776956) * i + 0.179910
                                    : ((-3.0258469 * i + 2.1070379) * i + 0.2226347) * i + 0.240390;
    const double y = kelvin <= 2222   ? ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
                     : kelvin <= 4000 ? ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
                                      : ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483;
    const double X = x / y, Z = (1 - x - y) / y;  // Y = 1
    const glm::dvec3 rgb(3.2406 * X - 1.5372 - 0.4986 * Z, -0.9689 * X + 1.8758 + 0.0415 * Z, 0.0557 * X - 0.2040 + 1.0570 * Z);
    return glm::max(rgb, glm::dvec3(0));
}

// Colour temperature of the sky by its luminance: overcast day 6500 K, blue hour 12000 K, the night's airglow and haze 4500 K.
static double sky_kelvin(double cd_m2) {
    const double decade = std::log10(std::max(cd_m2, 1e-4));
    if (decade >= 1) { return std::lerp(12000.0, 6500.0, std::clamp((decade - 1) / 2, 0.0, 1.0)); }
    return std::lerp(4500.0, 12000.0, std::clamp((decade + 2.5) / 2.5, 0.0, 1.0));
}

std::array<glm::vec3, 4> channel_colours(const Light& light, double lamp_peak_cd_m2) {
    const double flux = bulb_flux_lm * lamp_peak_cd_m2 / bulb_peak_cd_m2 * light.lamp;
    std::array<glm::vec3, 4> colours{};
    colours[light_sky] = blackbody(sky_kelvin(light.sky_cd_m2)) * static_cast<float>(light.sky_cd_m2);
    colours[light_ceiling] = blackbody(4000) * static_cast<float>(panel_cd_m2 * light.ceiling);
    colours[light_lamp] = blackbody(2700) * static_cast<float>(flux);
    colours[light_moon] = blackbody(4100) * static_cast<float>(moon_lux * light.moon);
    return colours;
}

float pre_exposure(double brightest_cd_m2) {
    constexpr double largest_fp16 = 65504;
    const double exponent = std::ceil(std::log2(std::max(brightest_cd_m2, 1e-30) / largest_fp16));
    return static_cast<float>(std::exp2(std::clamp(exponent, -19.0, 19.0)));
}

}  // namespace samples
