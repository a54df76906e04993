#include "app/cli/curve_plot.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>

namespace entoptic::app {
namespace {

constexpr double left = 100, right = 760, top = 50, bottom = 440;

// Values to pixels; over whole decades when logarithmic.
struct Axis {
    bool logarithmic = false;
    double from = 0, to = 1;      // values, exponents when logarithmic
    double start = 0, end = 0;    // pixels

    double place(double value) const { return logarithmic ? std::log10(value) : value; }
    bool shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
    double at(double value) const { return start + (place(value) - from) / (to - from) * (end - start); }
    double value(double place) const { return logarithmic ? std::pow(10, place) : place; }
};

// 1, 2 or 5 times a power of ten that divides the range into about eight.
double tick_step(const Axis& axis) {
    const double rough = (axis.to - axis.from) / 8, power = std::pow(10, std::floor(std::log10(rough)));
    const double step = power * (rough / power > 5 ? 10 : rough / power > 2 ? 5 : rough / power > 1 ? 2 : 1);
    return axis.logarithmic ? std::max(std::round(step), 1.0) : step;
}

std::vector<double> ticks(const Axis& axis) {
    const double step = tick_step(axis);
    std::vector<double> places;
    for (double k = std::ceil(axis.from / step - 1e-9); k * step <= axis.to + 1e-9 * step; ++k) places.push_back(k * step);
    return places;
}

Axis axis_over(const std::vector<double>& values, bool logarithmic, double start, double end) {
    Axis axis{logarithmic, 0, 1, start, end};
    double low = INFINITY, high = -INFINITY;
    for (const double v : values)
        if (axis.shows(v)) low = std::min(low, axis.place(v)), high = std::max(high, axis.place(v));
    if (!(low <= high)) return axis;
    if (low == high) low -= 0.5, high += 0.5;
    axis.from = logarithmic ? std::floor(low) : low;
    axis.to = logarithmic ? std::ceil(high) : high;
    if (!logarithmic) {
        const double step = tick_step(axis);
        axis.from = step * std::floor(low / step), axis.to = step * std::ceil(high / step);
    }
    return axis;
}

bool spans_decades(const std::vector<double>& values) {
    double low = INFINITY, high = 0;
    for (const double v : values)
        if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    return low > 0 && high > 100 * low;
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    return out;
}

std::string grid(const Axis& x, const Axis& y) {
    std::string out;
    for (const double t : ticks(x))
        out += fmt::format("<path d='M{0:.1f} {1} V{2}' stroke='#ddd'/><text x='{0:.1f}' y='{3}' text-anchor='middle'>{4:g}</text>\n", x.at(x.value(t)), top,
                           bottom, bottom + 18, x.value(t));
    for (const double t : ticks(y))
        out += fmt::format("<path d='M{0} {1:.1f} H{2}' stroke='#ddd'/><text x='{3}' y='{4:.1f}' text-anchor='end'>{5:g}</text>\n", left,
                           y.at(y.value(t)), right, left - 8, y.at(y.value(t)) + 4, y.value(t));
    return out;
}

// A line, broken where there is no value. What is computed otherwise lies under it, so that later lines are thinner and dashed.
std::string line(const CurvePicture& p, std::size_t column, const Axis& x, const Axis& y) {
    constexpr const char* colours[] = {"#1b6ca8", "#d1495b", "#2e933c", "#8d5fd3", "#c98a00", "#00838f", "#6d4c41", "#ad1457", "#455a64"};
    const std::size_t lines = p.columns.size() - 1, way = 3 * (column - 1) / std::max<std::size_t>(lines, 1);
    const char* colour = colours[(column - 1) % std::size(colours)];
    constexpr const char* dashes[] = {"", " stroke-dasharray='8 5'", " stroke-dasharray='2 4'"};
    const std::string style = fmt::format("fill='none' stroke='{}' stroke-width='{}'{}", colour, 4 - way, dashes[std::min<std::size_t>(way, 2)]);
    std::string path;
    bool down = false;
    for (const auto& row : p.rows) {
        const bool shown = x.shows(row[0]) && y.shows(row[column]);
        if (shown) path += fmt::format("{}{:.2f} {:.2f} ", down ? 'L' : 'M', x.at(row[0]), y.at(row[column]));
        down = shown;
    }
    const double legend = top + 14 + 16 * static_cast<double>(column - 1);
    return fmt::format("<path d='{}' {}/>\n<path d='M{} {} h26' {}/><text x='{}' y='{}'>{}</text>\n", path, style, right - 130, legend, style, right - 98, legend + 4,
                       escaped(p.columns[column]));
}

}  // namespace

Result<void> write_curve_plot(const std::string& path, const CurvePicture& p) {
    std::vector<double> xs, ys;
    for (const auto& row : p.rows) xs.push_back(row[0]), ys.insert(ys.end(), row.begin() + 1, row.end());
    const Axis x = axis_over(xs, p.log_x, left, right), y = axis_over(ys, spans_decades(ys), bottom, top);
    std::string svg = "<svg xmlns='http://www.w3.org/2000/svg' width='800' height='500' font-family='sans-serif' font-size='12'>\n"
                      "<rect width='800' height='500' fill='white'/>\n";
    svg += fmt::format("<text x='{0}' y='22' font-size='14'>{1}</text>\n<text x='{0}' y='38' font-size='9' fill='#555'>{2}</text>\n", left, escaped(p.title),
                       escaped(p.subtitle)) +
           grid(x, y);
    for (std::size_t column = 1; column < p.columns.size(); ++column) svg += line(p, column, x, y);
    svg += fmt::format("<text x='{}' y='480' text-anchor='middle'>{}</text>\n", (left + right) / 2, escaped(p.x_label));
    svg += fmt::format("<text transform='translate(24 {}) rotate(-90)' text-anchor='middle'>{}</text>\n</svg>\n", (top + bottom) / 2, escaped(p.y_label));
    std::ofstream out(path, std::ios::trunc);
    out << svg;
    out.close();
    if (!out) return failure(fmt::format("Cannot write '{}'. Check that its folder exists and may be written.", path));
    return {};
}

}  // namespace entoptic::app
