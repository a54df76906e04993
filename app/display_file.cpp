#include "app/display_file.h"

#include "app/config.h"
#include "shaders/colour_math.glsl"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <toml++/toml.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

constexpr double curve_exponent = 2.2;      // the domain in which a panel's curve is nearly a line
constexpr double most_luminance_cd_m2 = 1e5;

// Linear BT.709 to CIE XYZ: ITU-R BT.709-6, primaries and D65, luminance of (1, 1, 1) = 1.
const glm::dmat3 xyz_from_bt709(0.4123907992659595, 0.2126390058715104, 0.0193308187155918, 0.3575843393838780, 0.7151686787677559,
                                0.1191947797946260, 0.1804807884018343, 0.0721923153607337, 0.9505321522496607);

// ---- The file ------------------------------------------------------------------------------------------------------------------

tl::unexpected<Error> wrong(const std::string& path, const toml::node& node, const std::string& what) {
    return usage_error(fmt::format("{}:{}: {}", path, node.source().begin.line, what));
}

constexpr const char* reading_form = "a reading is [RED, GREEN, BLUE, CD_PER_M2] or [RED, GREEN, BLUE, X, Y, CD_PER_M2]: codes from 0 to 255, CIE 1931 x "
                                     "and y between 0 and 1, luminance from 0 to 100000 cd/m2.";

Result<MeterReading> reading_of(const std::string& path, const toml::node& node) {
    const auto* list = node.as_array();
    if (!list || (list->size() != 4 && list->size() != 6)) return wrong(path, node, reading_form);
    MeterReading reading;
    reading.place = fmt::format("{}:{}", path, node.source().begin.line);
    for (std::size_t c = 0; c < 3; ++c) {
        const auto code = (*list)[c].value_exact<std::int64_t>();
        if (!code || *code < 0 || *code > 255) return wrong(path, node, reading_form);
        reading.codes[c] = static_cast<int>(*code);
    }
    const auto number = [&](std::size_t i) { return (*list)[i].is_number() ? (*list)[i].value<double>().value_or(-1) : -1; };
    reading.luminance_cd_m2 = number(list->size() - 1);
    if (!(reading.luminance_cd_m2 >= 0 && reading.luminance_cd_m2 <= most_luminance_cd_m2)) return wrong(path, node, reading_form);
    if (list->size() == 6) {
        const glm::dvec2 xy(number(3), number(4));
        if (!(xy.x > 0 && xy.y > 0 && xy.x + xy.y <= 1)) return wrong(path, node, reading_form);
        reading.xy = xy;
    }
    return reading;
}

Result<std::vector<MeterReading>> readings_of(const std::string& path, const toml::node& node) {
    const auto* table = node.as_table();
    const auto* list = table ? (*table)["readings"].as_array() : nullptr;
    if (!list || table->size() != 1) return wrong(path, node, "write 'readings = [ ... ]' here and nothing else.");
    std::vector<MeterReading> readings;
    for (const auto& item : *list) {
        ENTOPTIC_TRY(reading, reading_of(path, item));
        readings.push_back(std::move(reading));
    }
    return readings;
}

Result<DisplayFile> parse_display(const toml::table& table, const std::string& path) {
    DisplayFile file;
    file.name = fs::path(path).stem().string();
    for (const auto& [name, node] : table) {
        if (name == "description" && node.is_string()) {
            file.description = node.value_or(std::string());
        } else if (name == "instrument" && node.is_string()) {
            file.instrument = node.value_or(std::string());
        } else if (name == "both" || name == "left" || name == "right") {
            ENTOPTIC_TRY(readings, readings_of(path, node));
            if (name != "right") file.eyes[0] = readings;
            if (name != "left") file.eyes[1] = readings;
        } else {
            return wrong(path, node, fmt::format("there is no key '{}' of this type. There are: description, instrument, [both], [left], [right].", name.str()));
        }
    }
    if (table.contains("both") && (table.contains("left") || table.contains("right")))
        return usage_error(fmt::format("{}: [both] stands for [left] and [right]; write either.", path));
    if (file.eyes[0].empty() || file.eyes[1].empty()) return usage_error(fmt::format("{}: readings of both eyes are needed: [left] and [right], or [both].", path));
    return file;
}

// ---- The fit -------------------------------------------------------------------------------------------------------------------

glm::dvec3 light_of_reading(const MeterReading& reading) {
    if (!reading.xy) return glm::dvec3(reading.luminance_cd_m2);
    return light_of({reading.xy->x, reading.xy->y, reading.luminance_cd_m2});
}

double luminance(glm::dvec3 bt709) { return (xyz_from_bt709 * bt709).y; }

std::array<int, 3> only(std::size_t channel, int code) {
    std::array<int, 3> codes{};
    codes[channel] = code;
    return codes;
}

// Mean of all readings of these codes; none where there is none.
std::optional<MeterReading> mean_of(const std::vector<MeterReading>& readings, const std::array<int, 3>& codes) {
    std::optional<MeterReading> mean;
    int count = 0;
    for (const MeterReading& reading : readings) {
        if (reading.codes != codes) continue;
        if (!mean) mean = reading;
        else {
            mean->luminance_cd_m2 += reading.luminance_cd_m2;
            if (mean->xy && reading.xy) *mean->xy += *reading.xy;
        }
        ++count;
    }
    if (mean) {
        mean->luminance_cd_m2 /= count;
        if (mean->xy) *mean->xy /= count;
    }
    return mean;
}

Result<std::array<glm::vec3, 3>> channels_of(const std::vector<MeterReading>& readings, glm::dvec3 black) {
    std::array<glm::vec3, 3> light{};
    const auto white = mean_of(readings, {255, 255, 255});
    for (std::size_t c = 0; c < 3; ++c) {
        const auto primary = mean_of(readings, only(c, 255));
        glm::dvec3 unit(0);
        unit[static_cast<int>(c)] = 1;
        if (primary && primary->xy) light[c] = light_of_reading(*primary) - black;
        else if (primary) light[c] = unit * ((primary->luminance_cd_m2 - luminance(black)) / luminance(unit));
        else if (white) light[c] = unit * (light_of_reading(*white) - black);
        else return failure("A reading of 255, 255, 255 is needed, or one of 255 in each channel alone.");
        if (!(luminance(light[c]) > 0))
            return failure(fmt::format("Channel {} sends no more light at 255 than the black: check the readings of the black and of 255.", c));
    }
    return light;
}

struct CurvePoint {
    int code;
    double share;
    std::string place;
};

// Share of a channel's light that a reading of equal codes tells: by its colour, else by its luminance.
double share_in_gray(const MeterReading& gray, const MeterReading& white, std::size_t channel, const glm::dmat3& shares_of_light, glm::dvec3 black) {
    if (gray.xy) return (shares_of_light * (light_of_reading(gray) - black))[static_cast<int>(channel)];
    return (gray.luminance_cd_m2 - luminance(black)) / (white.luminance_cd_m2 - luminance(black));
}

// Points of a channel's curve, by code, without 0 and 255.
std::vector<CurvePoint> curve_points(const std::vector<MeterReading>& readings, std::size_t channel, const MeasuredPanel& panel) {
    const glm::dmat3 shares = glm::inverse(glm::dmat3(panel.light[0], panel.light[1], panel.light[2]));
    const glm::dvec3 black(panel.black);
    const auto full = mean_of(readings, only(channel, 255)), white = mean_of(readings, {255, 255, 255});
    std::vector<CurvePoint> points;
    for (int code = 1; code < 255; ++code) {
        const auto own = mean_of(readings, only(channel, code)), gray = mean_of(readings, {code, code, code});
        if (own && full) points.push_back({code, (own->luminance_cd_m2 - luminance(black)) / (full->luminance_cd_m2 - luminance(black)), own->place});
        else if (gray && (white || gray->xy)) points.push_back({code, share_in_gray(*gray, white.value_or(*gray), channel, shares, black), gray->place});
    }
    return points;
}

// Fritsch and Carlson's monotone cubic through (x, y) with y rising, at whole x from 0 to 255.
std::array<double, 256> monotone_cubic(const std::vector<glm::dvec2>& points) {
    const std::size_t n = points.size();
    std::vector<double> secant(n - 1), slope(n);
    for (std::size_t i = 0; i + 1 < n; ++i) secant[i] = (points[i + 1].y - points[i].y) / (points[i + 1].x - points[i].x);
    slope.front() = secant.front();
    slope.back() = secant.back();
    for (std::size_t i = 1; i + 1 < n; ++i) slope[i] = 2 / (1 / secant[i - 1] + 1 / secant[i]);      // harmonic mean: never overshoots
    std::array<double, 256> out{};
    std::size_t i = 0;
    for (std::size_t x = 0; x < out.size(); ++x) {
        while (i + 2 < n && static_cast<double>(x) > points[i + 1].x) ++i;
        const double h = points[i + 1].x - points[i].x, t = (static_cast<double>(x) - points[i].x) / h;
        out[x] = (1 + 2 * t) * (1 - t) * (1 - t) * points[i].y + t * (1 - t) * (1 - t) * h * slope[i] + t * t * (3 - 2 * t) * points[i + 1].y +
                 t * t * (t - 1) * h * slope[i + 1];
    }
    return out;
}

Result<std::array<float, 256>> curve_of(const std::vector<MeterReading>& readings, std::size_t channel, const MeasuredPanel& panel) {
    std::array<float, 256> curve{};
    const auto measured = curve_points(readings, channel, panel);
    if (measured.empty()) {
        for (std::size_t code = 0; code < curve.size(); ++code) curve[code] = static_cast<float>(colour::srgb_decode(static_cast<double>(code) / 255));
        return curve;
    }
    std::vector<glm::dvec2> points{{0, 0}};
    for (const CurvePoint& p : measured) {
        const double value = std::pow(std::max(p.share, 0.0), 1 / curve_exponent);
        if (!(value > points.back().y && p.share < 1))
            return failure(fmt::format("{}: the light does not rise with the code here; repeat this reading and its neighbours.", p.place));
        points.emplace_back(p.code, value);
    }
    points.emplace_back(255, 1);
    const auto values = monotone_cubic(points);
    for (std::size_t code = 1; code < curve.size(); ++code)
        curve[code] = std::max(static_cast<float>(std::pow(values[code], curve_exponent)), std::nextafter(curve[code - 1], 2.0f));
    curve[255] = 1;
    return curve;
}

// Brightest D65 white of a panel, cd/m².
double brightest_white(const MeasuredPanel& panel) {
    const glm::dmat3 shares = glm::inverse(glm::dmat3(panel.light[0], panel.light[1], panel.light[2]));
    const glm::dvec3 of_white = shares * glm::dvec3(1), of_black = shares * glm::dvec3(panel.black);
    double white = most_luminance_cd_m2;
    for (int c = 0; c < 3; ++c)
        if (of_white[c] > 0) white = std::min(white, (1 + of_black[c]) / of_white[c]);
    return white;
}

}  // namespace

Result<DisplayFile> read_display_file(const std::string& path) {
    std::ifstream in(path);
    if (!in || fs::is_directory(path)) return failure(fmt::format("Cannot read the display's file '{}'. Check the name and the permissions.", path));
    try {
        return parse_display(toml::parse(in, path), path);
    } catch (const toml::parse_error& e) {
        return usage_error(fmt::format("{}:{}: {}.", path, e.source().begin.line, e.description()));
    }
}

Result<DisplayFile> find_display_file(const std::string& name_or_path) {
    if (name_or_path.ends_with(".toml")) return read_display_file(name_or_path);
    if (name_or_path.find('/') != std::string::npos)
        return usage_error(fmt::format("'{}' is neither a name of a file in displays/ nor a path that ends in .toml.", name_or_path));
    return read_display_file((fs::path(config_folder()) / "displays" / (name_or_path + ".toml")).string());
}

glm::dvec2 Chromaticity::uv() const {
    const double below = -2 * x + 12 * y + 3;
    return {4 * x / below, 9 * y / below};
}

Chromaticity chromaticity_of(glm::dvec3 bt709) {
    const glm::dvec3 xyz = xyz_from_bt709 * bt709;
    const double sum = xyz.x + xyz.y + xyz.z;
    return sum > 0 ? Chromaticity{xyz.x / sum, xyz.y / sum, xyz.y} : Chromaticity{};
}

glm::dvec3 light_of(const Chromaticity& c) {
    return glm::inverse(xyz_from_bt709) * (glm::dvec3(c.x / c.y, 1, (1 - c.x - c.y) / c.y) * c.luminance_cd_m2);
}

Result<MeasuredPanel> fit_panel(const std::vector<MeterReading>& readings) {
    const auto black = mean_of(readings, {0, 0, 0});
    if (!black) return failure("A reading of the black is needed: codes 0, 0, 0.");
    MeasuredPanel panel;
    panel.black = light_of_reading(*black);
    ENTOPTIC_TRY(light, channels_of(readings, light_of_reading(*black)));
    panel.light = light;
    if (!panel.has_three_primaries())
        return failure("The colours of red, green and blue at 255 are mixtures of each other: check their readings' x and y.");
    for (std::size_t c = 0; c < 3; ++c) {
        ENTOPTIC_TRY(curve, curve_of(readings, c, panel));
        panel.curve[c] = curve;
    }
    return panel;
}

glm::dvec3 light_of_codes(const MeasuredPanel& panel, const std::array<int, 3>& codes) {
    glm::dvec3 light(panel.black);
    for (std::size_t c = 0; c < 3; ++c)
        light += static_cast<double>(panel.curve[c][static_cast<std::size_t>(codes[c])]) * glm::dvec3(panel.light[c]);
    return light;
}

glm::dvec3 nominal_light_of_codes(const Photometry& nominal, const std::array<int, 3>& codes) {
    glm::dvec3 light;
    for (std::size_t c = 0; c < 3; ++c)
        light[static_cast<int>(c)] = static_cast<double>(nominal.black_cd_m2) +
                                     static_cast<double>(nominal.white_cd_m2 - nominal.black_cd_m2) * colour::srgb_decode(codes[c] / 255.0);
    return light;
}

Result<Photometry> measured_photometry(const DisplayFile& file) {
    auto panels = std::make_shared<std::array<MeasuredPanel, 2>>();
    double white = most_luminance_cd_m2, black = 0;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        auto panel = fit_panel(file.eyes[eye]);
        if (!panel) return failure(fmt::format("Display '{}', {} eye: {}", file.name, eye == 0 ? "left" : "right", panel.error().message));
        (*panels)[eye] = *panel;
        white = std::min(white, brightest_white(*panel));
        black = std::max(black, luminance(glm::dvec3(panel->black)));
    }
    if (!(white > black)) return failure(fmt::format("Display '{}' shows no white brighter than its black: check the readings.", file.name));
    return Photometry{static_cast<float>(white), static_cast<float>(black), panels};
}

Result<DisplayCheck> check_display(const std::vector<MeterReading>& readings, const Photometry& nominal) {
    ENTOPTIC_TRY(panel, fit_panel(readings));
    DisplayCheck check;
    for (std::size_t i = 0; i < readings.size(); ++i) {
        const MeterReading& reading = readings[i];
        DisplayCheck::Row row{reading, 0, 0, {}, {}, {}};
        const glm::dvec3 nominal_light = nominal_light_of_codes(nominal, reading.codes), fitted = light_of_codes(panel, reading.codes);
        row.nominal_cd_m2 = luminance(nominal_light);
        row.fitted_cd_m2 = luminance(fitted);
        if (reading.xy) {
            const glm::dvec2 measured = Chromaticity{reading.xy->x, reading.xy->y, 1}.uv();
            row.nominal_duv = glm::length(chromaticity_of(nominal_light).uv() - measured);
            row.fitted_duv = glm::length(chromaticity_of(fitted).uv() - measured);
        }
        const bool within = std::any_of(reading.codes.begin(), reading.codes.end(), [](int code) { return code > 0 && code < 255; });
        std::vector<MeterReading> others = readings;
        std::erase_if(others, [&](const MeterReading& other) { return other.codes == reading.codes; });
        if (const auto without = within ? fit_panel(others) : failure("")) row.held_out_cd_m2 = luminance(light_of_codes(*without, reading.codes));
        check.rows.push_back(std::move(row));
    }
    const double black = luminance(glm::dvec3(panel.black));
    double sum = 0;
    bool all = true;
    for (std::size_t c = 0; c < 3; ++c) {
        const auto primary = mean_of(readings, only(c, 255));
        all = all && primary;
        if (primary) sum += primary->luminance_cd_m2 - black;
    }
    if (const auto white = mean_of(readings, {255, 255, 255}); white && all) check.additivity = (white->luminance_cd_m2 - black) / sum - 1;
    return check;
}

}  // namespace entoptic::app
