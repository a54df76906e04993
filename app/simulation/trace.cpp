#include "app/simulation/trace.h"

#include "app/parse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>

namespace entoptic::app {
namespace {

enum Column { time_column, gaze_x_column, gaze_y_column, pupil_column, blink_column, column_count };
constexpr std::array<const char*, column_count> column_names{"time_s", "gaze_x_deg", "gaze_y_deg", "pupil_mm", "blink"};

std::vector<std::string> fields(std::string line) {
    std::vector<std::string> out(1);
    for (const char c : line) {
        if (c == ',')
            out.emplace_back();
        else if (c != ' ' && c != '\t' && c != '\r')
            out.back() += c;
    }
    return out;
}

struct Position {
    const std::string& path;
    int line;
};
tl::unexpected<Error> wrong(const Position& at, const std::string& what) {
    return failure(fmt::format("{}:{}: {}", at.path, at.line, what));
}

Result<std::vector<int>> header_columns(const std::vector<std::string>& names, const Position& at) {
    std::vector<int> columns;
    for (const std::string& name : names) {
        const auto found = std::find(column_names.begin(), column_names.end(), name);
        if (found == column_names.end())
            return wrong(at, fmt::format("'{}' is no column; there are time_s, gaze_x_deg, gaze_y_deg, pupil_mm, blink.", name));
        columns.push_back(static_cast<int>(found - column_names.begin()));
    }
    if (std::find(columns.begin(), columns.end(), int(time_column)) == columns.end())
        return wrong(at, "the first line must name the columns, time_s among them.");
    return columns;
}

struct Limits {
    double low, high;
};
constexpr std::array<Limits, column_count> limits{{{0, 1e6}, {-90, 90}, {-90, 90}, {1.5, 9}, {0, 1}}};

}  // namespace

Result<Trace> Trace::read(const std::string& path) {
    std::ifstream in(path);
    if (!in) return failure(fmt::format("Cannot read the trace '{}'. Check the name and the permissions.", path));
    Trace trace;
    std::vector<int> columns;
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        if (line.empty() || line[0] == '#') continue;
        const Position at{path, number};
        const auto texts = fields(line);
        if (columns.empty()) {
            ENTOPTIC_TRY(found, header_columns(texts, at));
            columns = std::move(found);
            continue;
        }
        if (texts.size() != columns.size())
            return wrong(at, fmt::format("{} values where the first line names {} columns.", texts.size(), columns.size()));
        std::array<double, column_count> values{};
        bool pupil = false;
        for (std::size_t i = 0; i < texts.size(); ++i) {
            const auto c = std::size_t(columns[i]);
            const auto value = number_from(texts[i]);
            if (!value || *value < limits[c].low || *value > limits[c].high)
                return wrong(at, fmt::format("{} is '{}'; wanted is a number from {:g} to {:g}.", column_names[c], texts[i], limits[c].low,
                                             limits[c].high));
            values[c] = *value;
            pupil |= c == pupil_column;
        }
        Row row{values[time_column], {values[gaze_x_column], values[gaze_y_column], std::nullopt, values[blink_column] >= 0.5}};
        if (pupil) row.state.pupil_mm = values[pupil_column];
        if (!trace.rows_.empty() && row.time_s <= trace.rows_.back().time_s) return wrong(at, "time_s must grow from row to row.");
        trace.rows_.push_back(row);
    }
    if (trace.rows_.empty()) return failure(fmt::format("The trace '{}' has no rows.", path));
    return trace;
}

TraceState Trace::at(double time_s) const {
    const auto next = std::upper_bound(rows_.begin(), rows_.end(), time_s, [](double t, const Row& r) { return t < r.time_s; });
    const auto with_lid = [&](TraceState state) {
        state.eyelid_open = eyelid_open_at(time_s);
        return state;
    };
    if (next == rows_.begin()) return with_lid(rows_.front().state);
    if (next == rows_.end()) return with_lid(rows_.back().state);
    const Row &a = *(next - 1), &b = *next;
    const double w = (time_s - a.time_s) / (b.time_s - a.time_s);
    TraceState state = with_lid(a.state);
    state.gaze_x_deg = std::lerp(a.state.gaze_x_deg, b.state.gaze_x_deg, w);
    state.gaze_y_deg = std::lerp(a.state.gaze_y_deg, b.state.gaze_y_deg, w);
    if (a.state.pupil_mm && b.state.pupil_mm) state.pupil_mm = std::lerp(*a.state.pupil_mm, *b.state.pupil_mm, w);
    return state;
}

bool Trace::has_blinks() const {
    return std::any_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.state.blink; });
}

// The lid runs evenly towards where the rows up to now send it, and is shown with a soft start and end.
double Trace::eyelid_open_at(double time_s) const {
    double open = rows_.front().state.blink ? 0 : 1;
    for (std::size_t i = 0; i < rows_.size() && rows_[i].time_s < time_s; ++i) {
        const double until = i + 1 < rows_.size() ? std::min(time_s, rows_[i + 1].time_s) : time_s, seconds = until - rows_[i].time_s;
        open = rows_[i].state.blink ? std::max(open - seconds / closing_s, 0.0) : std::min(open + seconds / opening_s, 1.0);
    }
    return open * open * (3 - 2 * open);
}

}  // namespace entoptic::app
