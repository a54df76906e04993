// `entoptic curve`: a model's curve as implemented, for people who check and plot it.
#include "app/cli/command.h"
#include "app/cli/curve_plot.h"
#include "app/cli/output.h"
#include "app/parse.h"
#include "perception/curves/curve.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <memory>

namespace entoptic::app {
namespace {

using namespace perception;

struct Options {
    std::string name, x, plot;
    std::vector<std::string> settings;
    bool json = false;
};

struct Abscissas {
    std::vector<double> xs;
    bool logarithmic = false;
};
constexpr double most_points = 1e6;

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> parts{""};
    for (const char c : text) {
        if (c == at) parts.emplace_back();
        else parts.back() += c;
    }
    return parts;
}

// "LIST" or "FROM:TO:N[:log]".
Result<Abscissas> abscissas_from(const std::string& text) {
    const auto wrong = [&](const char* why) {
        return usage_error(fmt::format("--x {}: {}. Write a list (0.01,1,100) or FROM:TO:N, with :log for equal ratios (1e-6:1e4:101:log).", text, why));
    };
    const std::vector<std::string> parts = split(text, ':');
    if (parts.size() == 1) {
        const auto list = numbers_from(text);
        if (!list) return wrong("not a list of numbers");
        return Abscissas{*list, false};
    }
    const bool logarithmic = parts.size() == 4 && parts[3] == "log";
    if (parts.size() != 3 && !logarithmic) return wrong("not FROM:TO:N");
    const auto from = number_from(parts[0]), to = number_from(parts[1]), count = number_from(parts[2]);
    if (!from || !to || !count) return wrong("not numbers");
    if (!(*count >= 2 && *count <= most_points) || *count != std::floor(*count)) return wrong("N is a whole number from 2 to 1000000");
    if (logarithmic && !(*from > 0 && *to > 0)) return wrong("a logarithmic scale begins and ends above 0");
    Abscissas made{{}, logarithmic};
    for (double i = 0; i < *count; ++i) {
        const double part = i / (*count - 1);
        made.xs.push_back(part == 0 ? *from : part == 1 ? *to : logarithmic ? *from * std::pow(*to / *from, part) : *from + (*to - *from) * part);
    }
    return made;
}

// What --set says about the model; empty when nothing.
Result<std::string> model_of(const std::vector<std::string>& settings) {
    std::string model;
    for (const std::string& text : settings) {
        if (text.find('=') == std::string::npos) return usage_error(fmt::format("--set {}: write NAME=VALUE.", text));
        if (text.starts_with("model=")) model = text.substr(6);
    }
    return model;
}

Result<CurveRequest> request_from(const Options& o) {
    ENTOPTIC_TRY(model, model_of(o.settings));
    ENTOPTIC_TRY(curve, find_curve(o.name, model));
    CurveRequest request(*curve);
    for (const std::string& text : o.settings) {
        const std::string name = text.substr(0, text.find('='));
        if (name == "model") continue;
        const auto values = numbers_from(std::string_view(text).substr(name.size() + 1));
        if (!values) return usage_error(fmt::format("--set {}: '{}' is not a number or a list of numbers with commas.", text, text.substr(name.size() + 1)));
        ENTOPTIC_TRY(used, request.set(name, *values));
        if (!used) fmt::print(stderr, "entoptic: {} of the model {} does not depend on {}.\n", o.name, curve->model, name);
    }
    return request;
}

using Rows = std::vector<std::vector<double>>;

Json curve_json(const CurveRequest& request, const Rows& rows) {
    const CurveKind& kind = *request.curve().kind;
    const std::size_t gpu_end = 1 + kind.parts.size();
    Json settings = Json::object(), list = Json::array();
    const auto number = [](double v) { return decimal(static_cast<float>(v)); };
    for (const CurveRequest::Setting& s : request.settings()) {
        if (s.values.empty()) settings[s.name] = nullptr;
        else if (s.values.size() == 1) settings[s.name] = number(s.values[0]);
        else
            for (const double v : s.values) settings[s.name].push_back(number(v));
    }
    for (const auto& row : rows) {
        Json values = Json::array();
        for (std::size_t i = 0; i < row.size(); ++i) values.push_back(i > 0 && i < gpu_end ? number(row[i]) : row[i]);
        list.push_back(std::move(values));
    }
    return {{"name", kind.name},         {"model", request.curve().model},  {"x", kind.x_name},  {"y", kind.y_name}, {"x_unit", kind.x_unit},
            {"y_unit", kind.y_unit},     {"settings", settings},            {"columns", request.columns()}, {"rows", list}};
}

std::string settings_text(const CurveRequest& request) {
    std::vector<std::string> list;
    for (const CurveRequest::Setting& s : request.settings())
        if (!s.values.empty()) list.push_back(fmt::format("{}={:g}{}", s.name, fmt::join(s.values, ","), s.unit == "1" || s.unit == "bool" ? "" : " " + s.unit));
    return fmt::format("{}", fmt::join(list, ", "));
}

void print_table(const CurveRequest& request, const Rows& rows) {
    const CurveKind& kind = *request.curve().kind;
    fmt::print("# {} of {}: {} ({}) over {} ({})\n", kind.name, request.curve().model, kind.y_name, kind.y_unit, kind.x_name, kind.x_unit);
    if (const std::string settings = settings_text(request); !settings.empty()) fmt::print("# {}\n", settings);
    for (const std::string& column : request.columns()) fmt::print("{:>14} ", column);
    fmt::print("\n");
    for (const auto& row : rows) {
        for (const double value : row) fmt::print("{:>14.8g} ", value);
        fmt::print("\n");
    }
}

CurvePicture picture_of(const CurveRequest& request, const Rows& rows, bool log_x) {
    const CurveKind& kind = *request.curve().kind;
    return {fmt::format("{}, {}", kind.name, request.curve().model), settings_text(request), fmt::format("{}, {}", kind.x_name, kind.x_unit),
            fmt::format("{}, {}", kind.y_name, kind.y_unit), log_x, request.columns(), rows};
}

Result<void> expect_numbers(const CurveRequest& request, const Rows& rows) {
    const auto columns = request.columns();
    for (const auto& row : rows)
        for (std::size_t i = 1; i < row.size(); ++i)
            if (!std::isfinite(row[i]))
                return failure(fmt::format(
                    "{} of {} has no value at {:g} ({}): these settings leave nothing to measure, such as an eye that lets no light in.",
                    request.curve().kind->name, request.curve().model, row[0], columns[i]));
    return {};
}

Result<int> curve(const Options& o) {
    ENTOPTIC_TRY(request, request_from(o));
    ENTOPTIC_TRY(x, abscissas_from(o.x));
    ENTOPTIC_CHECK(request.check(x.xs));
    ENTOPTIC_TRY(device, gpu::Device::create({}));
    ENTOPTIC_TRY(rows, request.rows(*device, x.xs));
    ENTOPTIC_CHECK(expect_numbers(request, rows));
    if (!o.plot.empty()) ENTOPTIC_CHECK(write_curve_plot(o.plot, picture_of(request, rows, x.logarithmic)));
    if (o.json) print_json(curve_json(request, rows));
    else if (o.plot.empty()) print_table(request, rows);
    return 0;
}

// Every curve with its models, units and settings.
std::string all_curves() {
    std::string text = "Curves (x -> y), the models that have them, settings [default]:\n";
    for (const Curve& first : curves()) {
        const CurveKind& kind = *first.kind;
        std::vector<std::string> models, settings;
        bool is_first = true;
        for (const Curve& c : curves()) {
            if (c.kind != &kind) continue;
            if (models.empty()) is_first = &c == &first;
            models.emplace_back(c.model);
            for (const CurveAlias& p : c.parameters)
                if (std::find(settings.begin(), settings.end(), p.name) == settings.end()) settings.emplace_back(p.name);
        }
        if (!is_first) continue;
        std::vector<std::string> own;
        for (const CurveSetting& s : kind.settings) own.push_back(s.optional ? s.name : fmt::format("{} [{:g}]", s.name, s.default_value));
        own.insert(own.end(), settings.begin(), settings.end());
        text += fmt::format("  {}: {}, {} -> {}, {}\n      model: {}\n", kind.name, kind.x_name, kind.x_unit, kind.y_name, kind.y_unit, fmt::join(models, ", "));
        if (!own.empty()) text += fmt::format("      {}\n", fmt::join(own, ", "));
        if (kind.parts.size() > 1) text += fmt::format("      columns gpu{}, and so on for double and reference\n", fmt::join(kind.parts, ", gpu"));
    }
    return text;
}

}  // namespace

void add_curve(CLI::App& app, Action& action) {
    auto o = std::make_shared<Options>();
    CLI::App* c = app.add_subcommand("curve", "A model's curve: as its shader computes it, in double, and by an independent implementation");
    c->add_option("name", o->name, "Which curve; they are listed below")->required();
    c->add_option("--x", o->x, "Where: a list (0.01,1,100) or FROM:TO:N, FROM:TO:N:log")->required();
    add_repeated(*c, "--set", o->settings, "NAME=VALUE, or NAME=A,B,C; model=NAME chooses the model (default: that of the preset combined)");
    c->add_flag("--json", o->json, "One JSON document on standard output");
    c->add_option("--plot", o->plot, "Draw it into this SVG file");
    c->footer(all_curves);
    c->callback([o, &action] { action = [o] { return curve(*o); }; });
}

}  // namespace entoptic::app
