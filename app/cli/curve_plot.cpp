#include "app/cli/curve_plot.h"

#include "app/svg_plot.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace entoptic::app {
namespace {

bool spans_decades(const std::vector<double>& values) {
    double low = INFINITY, high = 0;
    for (const double v : values)
        if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    return low > 0 && high > 100 * low;
}

// A line, broken where there is no value. What is computed otherwise lies under it, so that later lines are thinner and dashed.
std::string line(const CurvePicture& p, std::size_t column, const svg::Axis& x, const svg::Axis& y) {
    constexpr const char* colours[] = {"#1b6ca8", "#d1495b", "#2e933c", "#8d5fd3", "#c98a00", "#00838f", "#6d4c41", "#ad1457", "#455a64"};
    const std::size_t lines = p.columns.size() - 1, way = 3 * (column - 1) / std::max<std::size_t>(lines, 1);
    const char* colour = colours[(column - 1) % std::size(colours)];
    constexpr const char* dashes[] = {"", " stroke-dasharray='8 5'", " stroke-dasharray='2 4'"};
    const std::string style =
        fmt::format("fill='none' stroke='{}' stroke-width='{}'{}", colour, 4 - way, dashes[std::min<std::size_t>(way, 2)]);
    std::string path;
    bool down = false;
    for (const auto& row : p.rows) {
        const bool shown = x.shows(row[0]) && y.shows(row[column]);
        if (shown) path += fmt::format("{}{:.2f} {:.2f} ", down ? 'L' : 'M', x.at(row[0]), y.at(row[column]));
        down = shown;
    }
    const double legend = svg::top + 14 + 16 * static_cast<double>(column - 1);
    return fmt::format("<path d='{}' {}/>\n<path d='M{} {} h26' {}/><text x='{}' y='{}'>{}</text>\n", path, style, svg::right - 130, legend,
                       style, svg::right - 98, legend + 4, svg::escaped(p.columns[column]));
}

}  // namespace

Result<void> write_curve_plot(const std::string& path, const CurvePicture& p) {
    std::vector<double> xs, ys;
    for (const auto& row : p.rows) xs.push_back(row[0]), ys.insert(ys.end(), row.begin() + 1, row.end());
    const svg::Axis x = svg::axis_over(xs, p.log_x, svg::left, svg::right),
                    y = svg::axis_over(ys, spans_decades(ys), svg::bottom, svg::top);
    std::string lines;
    for (std::size_t column = 1; column < p.columns.size(); ++column) lines += line(p, column, x, y);
    return svg::write_plot_file(path, {p.title, p.subtitle, p.x_label, p.y_label}, x, y, lines);
}

}  // namespace entoptic::app
