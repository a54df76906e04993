#include "app/bench/plot.h"

#include "app/svg_plot.h"

#include <algorithm>
#include <fmt/format.h>

namespace entoptic::app {
namespace {

constexpr double least = 1e-4;  // both axes: what is smaller is drawn here

template <class Value> svg::Axis axis_for(const std::vector<EffectRow>& rows, Value value, double start, double end) {
    std::vector<double> values;
    for (const EffectRow& row : rows) values.push_back(value(row));
    return svg::axis_over(values, true, start, end);
}

double time_of(const EffectRow& row) { return std::max(row.time_ms.median, least); }
double error_of(const EffectRow& row) { return std::max(row.error.de_itp_p99, least); }

}  // namespace

Result<void> write_plot(const std::string& path, const std::vector<EffectRow>& rows, const std::string& title) {
    const svg::Axis x = axis_for(rows, time_of, svg::left, svg::right), y = axis_for(rows, error_of, svg::bottom, svg::top);
    std::string dots;
    for (const EffectRow& row : rows) {
        const double px = x.at(time_of(row)), py = y.at(error_of(row));
        dots += fmt::format(
            "<circle cx='{:.1f}' cy='{:.1f}' r='5' fill='{}' stroke='#246'/><text x='{:.1f}' y='{:.1f}' font-size='10'>{} {}</text>\n", px,
            py, row.is_default ? "#246" : "white", px + 8, py + 3, svg::escaped(row.model),
            row.setting == "default" ? "" : svg::escaped(row.setting));
    }
    return svg::write_plot_file(path, {title, "", "GPU time, ms (median)", "error, dE_ITP (99th percentile; 1 is just noticeable)"}, x, y,
                                dots);
}

}  // namespace entoptic::app
