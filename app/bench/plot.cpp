#include "app/bench/plot.h"

#include "app/svg_plot.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace entoptic::app {
namespace {

constexpr double least_error = 1e-3, least_ms = 1e-2;      // what is smaller is drawn here
constexpr double dot = 5, letter = 5.4, line_height = 11;  // pixels
constexpr const char* colours[] = {"#1f5fa8", "#c2410c", "#15803d", "#7e22ce", "#b91c8c", "#0e7490", "#a16207", "#475569", "#be123c"};

double time_of(const EffectRow& row) { return std::max(row.typical_ms(), least_ms); }
double error_of(const EffectRow& row) { return std::max(row.error.de_itp_p99, least_error); }

struct Box {
    double left, top, right, bottom;
    bool overlaps(const Box& b) const { return left < b.right && b.left < right && top < b.bottom && b.top < bottom; }
    bool within_plot() const { return left >= svg::left && right <= svg::right && top >= svg::top && bottom <= svg::bottom; }
};

// Dots and their labels, none over another as far as there is room.
class Marks {
public:
    explicit Marks(const std::vector<EffectRow>& rows) : rows_(rows) {
        std::vector<double> times, errors{least_error, 1};
        for (const EffectRow& row : rows) times.push_back(time_of(row)), errors.push_back(error_of(row));
        x_ = svg::axis_over(times, true, svg::left, svg::right);
        y_ = svg::axis_over(errors, true, svg::bottom, svg::top);
        for (const EffectRow& row : rows)
            if (const std::string name = series(row); !colour_.contains(name))
                colour_.emplace(name, colours[colour_.size() % std::size(colours)]);
        one_model_ = std::all_of(rows.begin(), rows.end(), [&](const EffectRow& row) { return row.model == rows[0].model; });
    }
    std::string draw() {
        std::string out = fmt::format(
            "<rect x='{}' y='{:.1f}' width='{}' height='{:.1f}' fill='#2a2' fill-opacity='0.07'/>"
            "<text x='{}' y='{:.1f}' font-size='10' fill='#262'>cannot be seen</text>\n",
            svg::left, y_.at(1), svg::right - svg::left, svg::bottom - y_.at(1), svg::left + 6, svg::bottom - 6);
        out += lines();
        for (const EffectRow& row : rows_) taken_.push_back(around(row));
        for (const EffectRow& row : rows_) out += circle(row);
        for (const EffectRow& row : rows_) out += label(row);
        return out;
    }
    const svg::Axis& x() const { return x_; }
    const svg::Axis& y() const { return y_; }

private:
    std::string series(const EffectRow& row) const { return row.model + " " + row.parameter; }
    Box around(const EffectRow& row) const {
        const double px = x_.at(time_of(row)), py = y_.at(error_of(row));
        return {px - dot, py - dot, px + dot, py + dot};
    }
    std::string text(const EffectRow& row) const {
        const std::string setting = row.setting == "default" ? "" : row.setting;
        return one_model_ ? (setting.empty() ? "default" : setting) : row.model + (setting.empty() ? "" : " " + setting);
    }
    // A parameter's values from fine to coarse; the default stands between them where it is one of them.
    std::string lines() const {
        std::map<std::string, std::vector<const EffectRow*>> joined;
        for (const EffectRow& row : rows_)
            if (!row.parameter.empty()) joined[series(row)].push_back(&row);
        std::string out;
        for (const auto& [name, list] : joined) {
            std::string points;
            for (const EffectRow* row : list) points += fmt::format("{:.1f},{:.1f} ", x_.at(time_of(*row)), y_.at(error_of(*row)));
            out += fmt::format("<polyline points='{}' fill='none' stroke='{}' stroke-opacity='0.4'/>\n", points, colour_.at(name));
        }
        return out;
    }
    std::string circle(const EffectRow& row) const {
        const double px = x_.at(time_of(row)), py = y_.at(error_of(row));
        const std::string& colour = colour_.at(series(row));
        std::string out;
        if (row.is_fastest_unseen)
            out += fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='8' fill='none' stroke='#2a2' stroke-width='2'/>", px, py);
        return out + fmt::format("<circle cx='{:.1f}' cy='{:.1f}' r='{}' fill='{}' stroke='{}'/>\n", px, py, dot,
                                 row.is_chosen ? colour : "white", colour);
    }
    std::string label(const EffectRow& row) {
        const Box at = around(row);
        const std::string words = text(row);
        const double width = letter * double(words.size()), px = 0.5 * (at.left + at.right), py = 0.5 * (at.top + at.bottom);
        Box best{};
        for (int step = 0; step < 24; ++step) {
            // To the right, to the left, then above and below, ever farther away.
            const double away = (step / 4) * line_height;
            const bool right = step % 2 == 0;
            const double x = right ? px + 11 : px - 11 - width, y = py + (step % 4 < 2 ? -away : away) - 0.5 * line_height;
            const Box box{x, y, x + width, y + line_height};
            if (step == 0) best = box;
            if (!box.within_plot() || std::any_of(taken_.begin(), taken_.end(), [&](const Box& b) { return b.overlaps(box); })) continue;
            best = box;
            break;
        }
        taken_.push_back(best);
        return fmt::format("<text x='{:.1f}' y='{:.1f}' font-size='10' fill='{}'>{}</text>\n", best.left, best.bottom - 2.5,
                           colour_.at(series(row)), svg::escaped(words));
    }

    const std::vector<EffectRow>& rows_;
    svg::Axis x_, y_;
    std::map<std::string, std::string> colour_;
    std::vector<Box> taken_;
    bool one_model_ = false;
};

}  // namespace

Result<void> write_plot(const std::string& path, const std::vector<EffectRow>& rows, const std::string& title,
                        const std::string& subtitle) {
    Marks marks(rows);
    const std::string drawn = marks.draw();
    return svg::write_plot_file(path,
                                {title, subtitle, "GPU time, ms (fastest frame)", "error, ΔE_ITP (99th percentile; 1 is just noticeable)"},
                                marks.x(), marks.y(), drawn);
}

}  // namespace entoptic::app
