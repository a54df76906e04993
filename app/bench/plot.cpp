#include "app/bench/plot.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>

namespace entoptic::app {
namespace {

constexpr double left = 80, right = 760, top = 50, bottom = 440;
constexpr double least = 1e-4;  // both axes: what is smaller is drawn here

// A logarithmic axis over whole decades.
struct Axis {
    double from = 0, to = 1, start = 0, end = 0;  // exponents; pixels
    double at(double value) const { return start + (std::log10(std::max(value, least)) - from) / (to - from) * (end - start); }
};

template <class Value> Axis axis_for(const std::vector<EffectRow>& rows, Value value, double start, double end) {
    double low = 1e9, high = -1e9;
    for (const EffectRow& row : rows) {
        low = std::min(low, std::floor(std::log10(std::max(value(row), least))));
        high = std::max(high, std::ceil(std::log10(std::max(value(row), least))));
    }
    return rows.empty() || low >= high ? Axis{rows.empty() ? -1 : low - 1, rows.empty() ? 1 : low + 1, start, end}
                                       : Axis{low, high, start, end};
}

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
    return out;
}

std::string grid(const Axis& x, const Axis& y) {
    std::string out;
    for (double e = x.from; e <= x.to; ++e)
        out += fmt::format("<path d='M{0:.1f} {1} V{2}' stroke='#ddd'/><text x='{0:.1f}' y='{3}' text-anchor='middle'>{4:g}</text>\n",
                           x.at(std::pow(10, e)), top, bottom, bottom + 18, std::pow(10, e));
    for (double e = y.from; e <= y.to; ++e)
        out += fmt::format("<path d='M{0} {1:.1f} H{2}' stroke='#ddd'/><text x='{3}' y='{4:.1f}' text-anchor='end'>{5:g}</text>\n", left,
                           y.at(std::pow(10, e)), right, left - 8, y.at(std::pow(10, e)) + 4, std::pow(10, e));
    return out;
}

}  // namespace

Result<void> write_plot(const std::string& path, const std::vector<EffectRow>& rows, const std::string& title) {
    const Axis x = axis_for(
        rows, [](const EffectRow& r) { return r.time_ms.median; }, left, right);
    const Axis y = axis_for(
        rows, [](const EffectRow& r) { return r.error.de_itp_p99; }, bottom, top);
    std::string svg =
        "<svg xmlns='http://www.w3.org/2000/svg' width='800' height='500' font-family='sans-serif' font-size='12'>\n<rect width='800' "
        "height='500' fill='white'/>\n";
    svg += fmt::format("<text x='{}' y='26' font-size='15'>{}</text>\n", left, escaped(title)) + grid(x, y);
    for (const EffectRow& row : rows) {
        const double px = x.at(row.time_ms.median), py = y.at(row.error.de_itp_p99);
        svg += fmt::format(
            "<circle cx='{:.1f}' cy='{:.1f}' r='5' fill='{}' stroke='#246'/><text x='{:.1f}' y='{:.1f}' font-size='10'>{} {}</text>\n", px,
            py, row.is_default ? "#246" : "white", px + 8, py + 3, escaped(row.effect), row.is_default ? "" : escaped(row.setting));
    }
    svg += fmt::format("<text x='{}' y='480' text-anchor='middle'>GPU time, ms (median)</text>\n", (left + right) / 2);
    svg += fmt::format(
        "<text transform='translate(22 {}) rotate(-90)' text-anchor='middle'>error, dE_ITP (99th percentile; 1 is just "
        "noticeable)</text>\n</svg>\n",
        (top + bottom) / 2);
    std::ofstream out(path, std::ios::trunc);
    out << svg;
    out.close();
    if (!out) return failure(fmt::format("Cannot write '{}'. Check that its folder may be written.", path));
    return {};
}

}  // namespace entoptic::app
