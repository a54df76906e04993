#include "app/simulation/stimuli.h"

#include "shaders/colour_math.glsl"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace entoptic::app {
namespace {

using Rgb = std::array<double, 3>;

constexpr double lead_s = 0.5;         // choice: of what was before, so that the eye is at rest when it begins
constexpr double flash_s = 0.125;      // Jacobs 2015, figures 4 and 5
constexpr double brightest_cd = 1e7;   // Jacobs 2015, figure 4: its brightest flash

Rgb grey(double cd_m2) { return {cd_m2, cd_m2, cd_m2}; }
Paint even(double cd_m2) {
    return [=](double, double) { return grey(cd_m2); };
}
bool within(double x, double y, double half_width, double half_height) { return std::abs(x) <= half_width && std::abs(y) <= half_height; }

// ---- Flashes ----

// A white disc in the dark, 10 degrees across (choice: the fovea and its surroundings).
std::vector<Phase> flash(const StimulusOptions& o) {
    const double light = o.luminance.value_or(brightest_cd) / o.filter;
    const Paint disc = [=](double x, double y) { return grey(std::hypot(x, y) <= 5 ? light : 0); };
    return {{lead_s, even(0)}, {flash_s, disc}, {10, even(0)}};
}

// Bars of 1e3 to 1e8 cd/m², one above the other with gaps, all at once, in the middle of the view (choice: 12 degrees high).
std::vector<Phase> flash_series(const StimulusOptions&) {
    const Paint bars = [](double x, double y) {
        const double row = std::floor((y + 6) / 2), in_row = (y + 6) / 2 - row;
        return grey(within(x, y, 6, 6) && in_row > 0.15 ? std::pow(10, 3 + row) : 0);
    };
    return {{lead_s, even(0)}, {flash_s, bars}, {10, even(0)}};
}

// A lamp far away (choice: 0.15 degrees across, two pixels of a headset).
std::vector<Phase> point_light(const StimulusOptions& o) {
    const double light = o.luminance.value_or(brightest_cd) / o.filter;
    const Paint lamp = [=](double x, double y) { return grey(std::hypot(x, y) <= 0.075 ? light : 0); };
    return {{1, lamp}};
}

// A camera's flash unit: a tube of 2.4 x 1.2 degrees, its glare a hundredth of it and less, just above the fixation target. The photograph
// was not published; the paper tells of "the very bright bulb of the flash and the dimmer glare surrounding it".
Paint camera_flash(double tube_cd_m2) {
    return [=](double x, double y) {
        const double above = y - 1.5, distance = std::hypot(x, above) / 1.5;
        return grey(within(x, above, 1.2, 0.6) ? tube_cd_m2 : 0.01 * tube_cd_m2 / std::pow(1 + distance * distance, 2));
    };
}

// Two flashes of 50 ms, each followed by 2.5 s of black. `test` is what the monitor showed of the second in cd/m²: 14, 19, 27, 35 or 49; the
// first is the standard, 27. The light that stands behind the standard is `luminance`.
std::vector<Phase> brightness(const StimulusOptions& o) {
    constexpr double standard = 27;
    const double light = o.luminance.value_or(brightest_cd);
    return {{lead_s, even(0)},
            {0.05, camera_flash(light)},
            {2.5, even(0)},
            {0.05, camera_flash(light * o.test.value_or(standard) / standard)},
            {2.5, even(0)}};
}

// One flash, bare or through a filter of 4 or 32, then darkness. The paper measured no luminance; that of its model's brightest option.
std::vector<Phase> hue(const StimulusOptions& o) {
    return {{lead_s, even(0)}, {flash_s, camera_flash(o.luminance.value_or(brightest_cd) / o.filter)}, {10, even(0)}};
}

// ---- Local adaptation ----

// Black arms of 1 degree around the fixation.
bool on_cross(double x, double y) { return within(x, y, 1, 0.1) || within(x, y, 0.1, 1); }

// Four quadrants of a square of 16 degrees around a cross, for several seconds, then the cross on an even field.
std::vector<Phase> quadrants(const std::array<Rgb, 4>& colours, double field) {
    const Paint pattern = [=](double x, double y) {
        if (on_cross(x, y)) return grey(0);
        if (!within(x, y, 8, 8)) return grey(field);
        return colours[static_cast<std::size_t>((x > 0 ? 1 : 0) + (y > 0 ? 2 : 0))];
    };
    const Paint blank = [=](double x, double y) { return grey(on_cross(x, y) ? 0 : field); };
    return {{lead_s, blank}, {8, pattern}, {4, blank}};
}

std::vector<Phase> adaptation_grey(const StimulusOptions& o) {
    const double field = o.luminance.value_or(40);
    const Rgb dark = grey(0.25 * field), light = grey(1.75 * field);
    return quadrants({dark, light, light, dark}, field);
}

std::vector<Phase> adaptation_colour(const StimulusOptions& o) {
    const double field = o.luminance.value_or(40), most = 2 * field, least = 0.25 * field;
    return quadrants({Rgb{most, least, least}, Rgb{least, most, least}, Rgb{least, least, most}, Rgb{most, most, least}}, field);
}

// A lamp is fixated for 4 s, then the page of a book 12 degrees to its right, where the lamp's afterimage is a dark spot.
std::vector<Phase> lamp_and_page(const StimulusOptions& o) {
    const double lamp = o.luminance.value_or(3000);
    const Paint scene = [=](double x, double y) {
        if (std::hypot(x + 6, y) <= 1.5) return grey(lamp);
        return grey(within(x - 6, y, 5, 6) ? 40 : 2);
    };
    return {{lead_s, scene, 6, 0}, {4, scene, -6, 0}, {4, scene, 6, 0}};
}

// ---- Dim light ----

// The 24 patches of the ColorChecker, sRGB codes as its maker gives them, row by row.
constexpr int checker[24][3] = {
    {115, 82, 68},  {194, 150, 130}, {98, 122, 157}, {87, 108, 67},  {133, 128, 177}, {103, 189, 170}, {214, 126, 44},  {80, 91, 166},
    {193, 90, 99},  {94, 60, 108},   {157, 188, 64}, {224, 163, 46}, {56, 61, 150},   {70, 148, 73},   {175, 54, 60},   {231, 199, 31},
    {187, 86, 149}, {8, 133, 161},   {243, 243, 242}, {200, 200, 200}, {160, 160, 160}, {122, 122, 121}, {85, 85, 85}, {52, 52, 52}};

Rgb patch(int index) {
    Rgb rgb{};
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = colour::srgb_decode(checker[index][c] / 255.0);
    return rgb;
}

// 6 x 4 patches of 3 degrees with gaps of 0.6 on a black card of 3 %, in the dark. `white`: luminance of its white patch, cd/m².
Paint colour_checker(double white) {
    const Rgb brightest = patch(18);
    const double scale = white / colour::luminance({brightest[0], brightest[1], brightest[2]});
    return [=](double x, double y) {
        constexpr double pitch = 3.6, gap = 0.6;
        const double across = x + 3 * pitch, down = 2 * pitch - y;
        if (!within(x, y, 3 * pitch + gap, 2 * pitch + gap)) return grey(0);
        const double column = std::floor(across / pitch), row = std::floor(down / pitch);
        const bool on_patch = column >= 0 && column < 6 && row >= 0 && row < 4 && std::abs(across - (column + 0.5) * pitch) < (pitch - gap) / 2 &&
                              std::abs(down - (row + 0.5) * pitch) < (pitch - gap) / 2;
        Rgb rgb = on_patch ? patch(static_cast<int>(6 * row + column)) : grey(0.03);
        for (double& v : rgb) v *= scale;
        return rgb;
    };
}

// Two views of 1.25 s, each followed by 0.75 s of black. First the standard, white patch 0.055 cd/m², then `test`: 0.041, 0.048, 0.055, 0.068
// or 0.075.
std::vector<Phase> mesopic(const StimulusOptions& o) {
    const double standard = o.luminance.value_or(0.055);
    return {{lead_s, even(0)},
            {1.25, colour_checker(standard)},
            {0.75, even(0)},
            {1.25, colour_checker(o.test.value_or(standard))},
            {0.75, even(0)}};
}

// The chart from 10 to 0.001 cd/m² of its white patch, half a decade a second: figure 11, whose own levels were not published.
std::vector<Phase> mesopic_levels(const StimulusOptions&) {
    std::vector<Phase> phases;
    for (int i = 2; i >= -6; --i) phases.push_back({1, colour_checker(std::pow(10, 0.5 * i))});
    return phases;
}

}  // namespace

const std::vector<StimulusEntry>& stimuli() {
    static const std::vector<StimulusEntry> table = {
        {"flash", "jacobs2015", "Jacobs 2015, figures 4 and 5", "A disc of --luminance for 1/8 s, then darkness", &flash},
        {"flash_series", "jacobs2015", "Jacobs 2015, figure 5", "Bars of 1e3 to 1e8 cd/m² for 1/8 s, then darkness", &flash_series},
        {"brightness", "jacobs2015", "Jacobs 2015, section 4.1", "Two camera flashes of 50 ms, the second --test over 27 as bright",
         &brightness},
        {"hue", "jacobs2015", "Jacobs 2015, section 4.3", "A camera flash, bare or through --filter 4 or 32", &hue},
        {"adaptation_grey", "jacobs2015", "Jacobs 2015, figure 3 (b, c)", "Dark and light quadrants for 8 s, then an even field",
         &adaptation_grey},
        {"adaptation_colour", "jacobs2015", "Jacobs 2015, figure 3 (d)", "Coloured quadrants for 8 s, then an even field",
         &adaptation_colour},
        {"lamp_and_page", "jacobs2015", "Jacobs 2015, figure 9", "A lamp is fixated, then a page: the gaze moves", &lamp_and_page},
        {"mesopic", "jacobs2015", "Jacobs 2015, section 4.2", "A colour chart in dim light twice, the second time at --test", &mesopic},
        {"point_light", "kakimoto2004", "Kakimoto 2004, figure 5",
         "A disc of 0.15 degrees of --luminance in the dark, to see a glare model by", &point_light},
        {"mesopic_levels", "jacobs2015", "Jacobs 2015, figure 11", "The colour chart from 10 down to 0.001 cd/m²", &mesopic_levels},
    };
    return table;
}

Result<const StimulusEntry*> find_stimulus(const std::string& name) {
    std::string names;
    for (const StimulusEntry& entry : stimuli()) {
        if (name == entry.name) return &entry;
        names += fmt::format("{}{}", names.empty() ? "" : ", ", entry.name);
    }
    return usage_error(fmt::format("There is no stimulus '{}'; there are {}.", name, names));
}

ImageF painted(const Paint& paint, int width, int height, double fov_deg) {
    constexpr double degree = 0.017453292519943295;
    const double half = std::tan(0.5 * fov_deg * degree);
    ImageF image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double right = half * (2 * (x + 0.5) / width - 1), up = half * (height - 2 * (y + 0.5)) / width;
            const Rgb rgb = paint(std::atan(right) / degree, std::atan(up / std::hypot(1, right)) / degree);
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>(rgb[static_cast<std::size_t>(c)]);
        }
    return image;
}

}  // namespace entoptic::app
