#include "app/simulation/trace.h"

#include "app/parse.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>

namespace entoptic::app {
namespace {

using drivers::GazeAngles;

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
    bool needed;  // a row without it is an error
};
constexpr std::array<Limits, column_count> limits{{{0, 1e6, true}, {-180, 180, false}, {-90, 90, false}, {1.5, 9, false}, {0, 1, true}}};

// How trackers and programs for statistics write that there is no value.
bool says_none(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    static constexpr const char* words[] = {"", "nan", "+nan", "-nan", "n/a", "na", "inf", "+inf", "-inf"};
    return std::find(std::begin(words), std::end(words), text) != std::end(words);
}

// One row's value of a column; none: not found.
Result<std::optional<double>> value_of(const std::string& text, std::size_t column, const Position& at) {
    const Limits& limit = limits[column];
    const auto value = number_from(text);
    if (value && *value >= limit.low && *value <= limit.high) return value;
    if (limit.needed || (!value && !says_none(text)))
        return wrong(at,
                     fmt::format("{} is '{}'; wanted is a number from {:g} to {:g}.", column_names[column], text, limit.low, limit.high));
    return std::optional<double>();
}

constexpr double sampling_s = 0.005;  // as often as a good eye tracker

}  // namespace

Result<Trace> Trace::read(const std::string& path) {
    std::ifstream in(path);
    if (!in) return failure(fmt::format("Cannot read the trace '{}'. Check the name and the permissions.", path));
    Trace trace;
    std::vector<int> columns;
    std::string line;
    for (int number = 1; std::getline(in, line); ++number) {
        if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);  // byte order mark of UTF-8
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
        std::array<std::optional<double>, column_count> values{};
        for (std::size_t i = 0; i < texts.size(); ++i) {
            ENTOPTIC_TRY(value, value_of(texts[i], static_cast<std::size_t>(columns[i]), at));
            values[static_cast<std::size_t>(columns[i])] = value;
        }
        const auto has = [&](Column column) { return std::find(columns.begin(), columns.end(), int(column)) != columns.end(); };
        trace.has_gaze_ = has(gaze_x_column) || has(gaze_y_column);
        trace.has_pupil_ = has(pupil_column);
        if (!has(gaze_x_column)) values[gaze_x_column] = 0;
        if (!has(gaze_y_column)) values[gaze_y_column] = 0;
        Row row{*values[time_column], {}, values[pupil_column], values[blink_column].value_or(0) >= 0.5};
        if (trace.has_gaze_ && values[gaze_x_column] && values[gaze_y_column])
            row.gaze = GazeAngles(*values[gaze_x_column], *values[gaze_y_column]);
        if (!trace.rows_.empty() && row.time_s <= trace.rows_.back().time_s) return wrong(at, "time_s must grow from row to row.");
        trace.rows_.push_back(row);
    }
    if (trace.rows_.empty()) return failure(fmt::format("The trace '{}' has no rows.", path));
    trace.count();
    if (trace.has_pupil_ && trace.without_pupil_ == trace.rows())
        return failure(fmt::format("{}: no row has a pupil_mm from 1.5 to 9 mm. Give diameters in mm, or leave the column out.", path));
    if (trace.has_gaze_ && trace.without_gaze_ == trace.rows())
        return failure(fmt::format(
            "{}: no row has a gaze within 180 degrees to the sides and 90 up and down. Give degrees, or leave the columns out.", path));
    trace.leave_out_blinks();
    return trace;
}

// A lid that closes or opens hides part of the pupil, from a little before the tracker says so.
void Trace::leave_out_blinks() {
    const double margin_s = seconds(drivers::BlinkParameters{}.margin);
    std::vector<double> shut;
    for (const Row& row : rows_)
        if (row.blink) shut.push_back(row.time_s);
    for (Row& row : rows_) {
        const auto next = std::lower_bound(shut.begin(), shut.end(), row.time_s - margin_s);
        if (next == shut.end() || *next > row.time_s + margin_s) continue;
        row.gaze.reset();
        row.pupil_mm.reset();
    }
}

template <class T> std::optional<T> Trace::value_at(double time_s, std::optional<T> Row::*value) const {
    const auto next = std::upper_bound(rows_.begin(), rows_.end(), time_s, [](double t, const Row& r) { return t < r.time_s; });
    if (next == rows_.begin()) return rows_.front().*value;
    const Row& last = *(next - 1);
    const std::optional<T>& before = last.*value;
    if (next == rows_.end() || !before || !((*next).*value)) return before;
    const double w = (time_s - last.time_s) / (next->time_s - last.time_s);
    return *before + w * (*((*next).*value) - *before);
}

std::optional<GazeAngles> Trace::gaze_at(double time_s) const { return value_at(time_s, &Row::gaze); }
std::optional<double> Trace::pupil_at(double time_s) const { return value_at(time_s, &Row::pupil_mm); }

void Trace::count() {
    for (const Row& row : rows_) {
        without_gaze_ += has_gaze_ && !row.gaze;
        without_pupil_ += has_pupil_ && !row.pupil_mm;
    }
}

bool Trace::has_blinks() const {
    return std::any_of(rows_.begin(), rows_.end(), [](const Row& row) { return row.blink; });
}

// The lid runs evenly towards where the rows up to now send it, and is shown with a soft start and end.
double Trace::eyelid_open_at(double time_s) const {
    double open = rows_.front().blink ? 0 : 1;
    for (std::size_t i = 0; i < rows_.size() && rows_[i].time_s < time_s; ++i) {
        const double until = i + 1 < rows_.size() ? std::min(time_s, rows_[i + 1].time_s) : time_s, seconds = until - rows_[i].time_s;
        open = rows_[i].blink ? std::max(open - seconds / closing_s, 0.0) : std::min(open + seconds / opening_s, 1.0);
    }
    return open * open * (3 - 2 * open);
}

void TraceEye::sample(double time_s) {
    const TimeNs time = nanoseconds(time_s);
    pupil_.advance(pupil_parameters_, time);
    if (const auto gaze = trace_.gaze_at(time_s)) gaze_.add(drivers::GazeFilterParameters{}, time, time, *gaze);
    if (const auto pupil = trace_.pupil_at(time_s)) pupil_.add(pupil_parameters_, 0, *pupil);
}

void TraceEye::advance(double time_s, double model_mm) {
    pupil_parameters_.model_mm = model_mm;
    for (; static_cast<double>(samples_) * sampling_s <= time_s; ++samples_) sample(static_cast<double>(samples_) * sampling_s);
    pupil_.advance(pupil_parameters_, nanoseconds(time_s));
    time_s_ = std::max(time_s_, time_s);
}

GazeAngles TraceEye::gaze(GazeAngles centre) const {
    const drivers::GazeFilterParameters parameters;
    if (!gaze_.seen()) return centre;
    const TimeNs now = nanoseconds(time_s_), eases = gaze_.sample_arrival() + parameters.hold;
    const double left = now <= eases ? 1 : std::exp(-seconds(now - eases) / parameters.ease_tau_s);
    return centre + left * (gaze_.predicted(parameters, now) - centre);
}

}  // namespace entoptic::app
