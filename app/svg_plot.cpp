#include "app/svg_plot.h"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>

namespace entoptic::app::svg {
namespace {

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

std::string grid(const Axis& x, const Axis& y) {
    std::string out;
    for (const double t : ticks(x))
        out += fmt::format("<path d='M{0:.1f} {1} V{2}' stroke='#ddd'/><text x='{0:.1f}' y='{3}' text-anchor='middle'>{4:g}</text>\n",
                           x.at(x.value(t)), top, bottom, bottom + 18, x.value(t));
    for (const double t : ticks(y))
        out += fmt::format("<path d='M{0} {1:.1f} H{2}' stroke='#ddd'/><text x='{3}' y='{4:.1f}' text-anchor='end'>{5:g}</text>\n", left,
                           y.at(y.value(t)), right, left - 8, y.at(y.value(t)) + 4, y.value(t));
    return out;
}

}  // namespace

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

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
    return out;
}

Result<void> write_plot_file(const std::string& path, const Labels& labels, const Axis& x, const Axis& y, const std::string& marks) {
    std::string svg =
        "<svg xmlns='http://www.w3.org/2000/svg' width='800' height='500' font-family='sans-serif' font-size='12'>\n"
        "<rect width='800' height='500' fill='white'/>\n";
    svg += fmt::format("<text x='{0}' y='22' font-size='14'>{1}</text>\n<text x='{0}' y='38' font-size='9' fill='#555'>{2}</text>\n", left,
                       escaped(labels.title), escaped(labels.subtitle));
    svg += grid(x, y) + marks;
    svg += fmt::format("<text x='{}' y='480' text-anchor='middle'>{}</text>\n", (left + right) / 2, escaped(labels.x));
    svg += fmt::format("<text transform='translate(24 {}) rotate(-90)' text-anchor='middle'>{}</text>\n</svg>\n", (top + bottom) / 2,
                       escaped(labels.y));
    std::ofstream out(path, std::ios::trunc);
    out << svg;
    out.close();
    if (!out) return failure(fmt::format("Cannot write '{}'. Check that its folder exists and may be written.", path));
    return {};
}

}  // namespace entoptic::app::svg
