// The TOML form of a script: reading, checking, saying which line is wrong.
#include "drivers/virtual_hmd/virtual_hmd_script.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <initializer_list>
#include <limits>
#include <sstream>
#include <string_view>
#include <toml++/toml.h>

namespace entoptic::drivers {

namespace {

constexpr std::size_t most_keys = 100'000;
constexpr double longest_s = 1e6;
constexpr std::uintmax_t largest_file = 16u << 20;

struct Range {
    double low, high;
};

// Reads values out of a parsed document and keeps the first error; after one, everything it returns is harmless.
class Reader {
public:
    explicit Reader(std::string source) : source_(std::move(source)) {}

    const std::optional<Error>& error() const { return error_; }
    double end_time() const { return end_time_; }

    void fail(const toml::node& node, const std::string& message) {
        if (!error_) error_ = Error{ErrorKind::usage, fmt::format("{}:{}: {}", source_, node.source().begin.line, message)};
    }

    // Every key of `table` must be in `known`.
    void check_keys(const toml::table& table, const std::string& where, std::initializer_list<const char*> known) {
        for (const auto& [key, node] : table) {
            if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
            std::string names;
            for (const char* name : known) names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
            return fail(node, fmt::format("unknown key '{}' in {}; it may have: {}.", key.str(), where, names));
        }
    }

    const toml::table* table(const toml::table& parent, const char* key) {
        const toml::node* node = parent.get(key);
        if (!node) return nullptr;
        if (!node->is_table()) fail(*node, fmt::format("'{}' must be a table.", key));
        return node->as_table();
    }

    void text(const toml::table& parent, const char* key, std::string& value) {
        const toml::node* node = parent.get(key);
        if (!node) return;
        if (!node->is_string()) return fail(*node, fmt::format("'{}' must be a string.", key));
        value = node->as_string()->get();
    }

    void boolean(const toml::table& parent, const char* key, bool& value) {
        const toml::node* node = parent.get(key);
        if (!node) return;
        if (!node->is_boolean()) return fail(*node, fmt::format("'{}' must be true or false.", key));
        value = node->as_boolean()->get();
    }

    double number(const toml::node& node, const std::string& what, Range range) {
        const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
        if (value && *value >= range.low && *value <= range.high) return *value;
        fail(node, fmt::format("{} must be a number from {:g} to {:g}.", what, range.low, range.high));
        return range.low;
    }

    void number(const toml::table& parent, const char* key, Range range, double& value) {
        if (const toml::node* node = parent.get(key)) value = number(*node, fmt::format("'{}'", key), range);
    }

    template <std::size_t N>
    void channel(const toml::table& parent, const char* key, const std::array<Range, N>& ranges, Channel<N>& result,
                 Interpolation standard = Interpolation::linear) {
        const toml::node* node = parent.get(key);
        if (!node || error_) return;
        std::optional<Channel<N>> read =
            node->is_table() ? keyed<N>(*node->as_table(), key, ranges, standard) : constant<N>(*node, key, ranges);
        if (!read || error_) return;
        result = std::move(*read);
        end_time_ = std::max(end_time_, result.end_time());
    }

    // [[start, duration], ...], increasing, not overlapping.
    void intervals(const toml::table& parent, const char* key, std::vector<Interval>& result) {
        rows(parent, key, "[start, duration]", 2, 2, [&](const toml::node& node, const std::vector<double>& row) {
            if (!(row[1] > 0)) return fail(node, fmt::format("'{}': a duration must be more than 0 s.", key));
            if (!result.empty() && row[0] < result.back().end)
                return fail(node, fmt::format("'{}': intervals must follow each other.", key));
            result.push_back({row[0], row[0] + row[1]});
            end_time_ = std::max(end_time_, result.back().end);
        });
    }

    // [[start], [start, closed], ...].
    void blinks(const toml::table& parent, const char* key, std::vector<Blink>& result) {
        rows(parent, key, "[start] or [start, closed]", 1, 2, [&](const toml::node& node, const std::vector<double>& row) {
            if (!result.empty() && row[0] < result.back().end())
                return fail(node, fmt::format("'{}': blinks must follow each other.", key));
            result.push_back({row[0], row.size() > 1 ? row[1] : Blink{}.closed});
            end_time_ = std::max(end_time_, result.back().end());
        });
    }

private:
    template <class Row>
    void rows(const toml::table& parent, const char* key, const char* form, std::size_t fewest, std::size_t most, Row row) {
        const toml::node* node = parent.get(key);
        if (!node || error_) return;
        const toml::array* array = node->as_array();
        if (!array || array->size() > most_keys) return fail(*node, fmt::format("'{}' must be an array of {}.", key, form));
        for (const toml::node& entry : *array) {
            const toml::array* numbers = entry.as_array();
            if (!numbers || numbers->size() < fewest || numbers->size() > most)
                return fail(entry, fmt::format("'{}': expected {}.", key, form));
            std::vector<double> values;
            for (const toml::node& value : *numbers)
                values.push_back(number(value, fmt::format("'{}': a time in seconds", key), {0, longest_s}));
            if (error_) return;
            row(entry, values);
        }
    }

    template <std::size_t N>
    std::optional<Channel<N>> constant(const toml::node& node, const char* key, const std::array<Range, N>& ranges) {
        std::array<double, N> value{};
        if (N == 1 && node.is_number()) {
            value[0] = number(node, fmt::format("'{}'", key), ranges[0]);
            return Channel<N>(value);
        }
        const toml::array* array = node.as_array();
        if (!array || array->size() != N || !(*array)[0].is_number()) {
            fail(node, fmt::format("'{}' must be {} or a table {{ interpolation = \"...\", keys = [[time, ...], ...] }}.", key,
                                   N == 1 ? "a number" : fmt::format("an array of {} numbers", N)));
            return std::nullopt;
        }
        for (std::size_t c = 0; c < N; ++c) value[c] = number((*array)[c], fmt::format("'{}', number {}", key, c + 1), ranges[c]);
        return Channel<N>(value);
    }

    template <std::size_t N>
    std::optional<Channel<N>> keyed(const toml::table& table, const char* key, const std::array<Range, N>& ranges, Interpolation standard) {
        check_keys(table, fmt::format("'{}'", key), {"interpolation", "keys"});
        const Interpolation kind = interpolation(table, standard);
        const toml::node* node = table.get("keys");
        const toml::array* array = node ? node->as_array() : nullptr;
        if (!array || array->empty() || array->size() > most_keys) {
            fail(node ? *node : static_cast<const toml::node&>(table), fmt::format("'{}' needs keys = [[time, ...], ...].", key));
            return std::nullopt;
        }
        std::vector<Key<N>> keys;
        for (const toml::node& entry : *array) {
            keys.push_back(one_key<N>(entry, key, ranges));
            if (error_) return std::nullopt;
            check_order(entry, key, kind, keys);
        }
        if (error_) return std::nullopt;
        return Channel<N>(kind, std::move(keys));
    }

    template <std::size_t N> Key<N> one_key(const toml::node& entry, const char* key, const std::array<Range, N>& ranges) {
        Key<N> result;
        const toml::array* row = entry.as_array();
        if (!row || row->size() != N + 1) {
            fail(entry, fmt::format("'{}': a key is [time, {} number{}].", key, N, N == 1 ? "" : "s"));
            return result;
        }
        result.time = number((*row)[0], fmt::format("'{}': a key's time", key), {0, longest_s});
        for (std::size_t c = 0; c < N; ++c)
            result.value[c] = number((*row)[c + 1], fmt::format("'{}', number {} of a key", key, c + 1), ranges[c]);
        return result;
    }

    template <std::size_t N>
    void check_order(const toml::node& entry, const char* key, Interpolation kind, const std::vector<Key<N>>& keys) {
        if (keys.size() < 2) return;
        const double previous = keys[keys.size() - 2].time;
        if (!(keys.back().time > previous)) return fail(entry, fmt::format("'{}': times must increase.", key));
        if (kind != Interpolation::saccade || keys.size() < 3) return;
        const double end = Channel<N>(kind, {keys.end() - 3, keys.end() - 1}).end_time();
        if (keys.back().time < end)
            fail(entry, fmt::format("'{}': the saccade before lasts until {:.3f} s; begin this one later.", key, end));
    }

    Interpolation interpolation(const toml::table& table, Interpolation standard) {
        const toml::node* node = table.get("interpolation");
        if (!node) return standard;
        const std::string name = node->value_or(std::string());
        if (name == "linear") return Interpolation::linear;
        if (name == "smooth") return Interpolation::smooth;
        if (name == "hold") return Interpolation::hold;
        if (name == "saccade" && standard == Interpolation::saccade) return Interpolation::saccade;
        fail(*node, fmt::format("'interpolation' must be {}.",
                                standard == Interpolation::saccade ? "saccade, linear, smooth or hold" : "linear, smooth or hold"));
        return standard;
    }

    std::string source_;
    std::optional<Error> error_;
    double end_time_ = 0;
};

constexpr Range metres{-1000, 1000}, degrees{-36000, 36000}, gaze_degrees{-60, 60}, unit{0, 1}, stick{-1, 1};
constexpr Range milliseconds_range{0, 1000}, noise_degrees{0, 10}, probability{0, 1};
constexpr std::array<Range, 3> position_range{metres, metres, metres}, angles_range{degrees, degrees, degrees};
constexpr std::array<Range, 2> gaze_range{gaze_degrees, gaze_degrees}, stick_range{stick, stick};

void read_head(Reader& reader, const toml::table& root, Script& script) {
    const toml::table* head = reader.table(root, "head");
    if (!head) return;
    reader.check_keys(*head, "[head]", {"position_m", "orientation_deg"});
    reader.channel(*head, "position_m", position_range, script.head_position_m);
    reader.channel(*head, "orientation_deg", angles_range, script.head_orientation_deg);
}

// Distances become dioptres, in which a distance between two keys is interpolated.
void read_vergence(Reader& reader, const toml::table& gaze, Script& script) {
    Channel<1> distance({2});
    reader.channel(gaze, "vergence_m", std::array<Range, 1>{Range{0.05, std::numeric_limits<double>::infinity()}}, distance);
    std::vector<Key<1>> keys = distance.keys();
    for (Key<1>& key : keys) key.value[0] = 1 / key.value[0];
    script.vergence_dioptres = Channel<1>(distance.interpolation(), std::move(keys));
}

void read_gaze(Reader& reader, const toml::table& root, Script& script) {
    const toml::table* gaze = reader.table(root, "gaze");
    if (!gaze) return;
    reader.check_keys(*gaze, "[gaze]", {"direction_deg", "vergence_m", "left_deg", "right_deg"});
    const bool left = gaze->contains("left_deg"), right = gaze->contains("right_deg");
    if (left != right || (left && (gaze->contains("direction_deg") || gaze->contains("vergence_m"))))
        return reader.fail(*gaze, "[gaze] has either direction_deg and vergence_m, or both left_deg and right_deg.");
    if (left) {
        script.eye_gaze_deg.emplace();
        reader.channel(*gaze, "left_deg", gaze_range, (*script.eye_gaze_deg)[0], Interpolation::saccade);
        reader.channel(*gaze, "right_deg", gaze_range, (*script.eye_gaze_deg)[1], Interpolation::saccade);
        return;
    }
    reader.channel(*gaze, "direction_deg", gaze_range, script.gaze_deg, Interpolation::saccade);
    read_vergence(reader, *gaze, script);
}

void read_pupil(Reader& reader, const toml::table& root, Script& script) {
    const toml::table* pupil = reader.table(root, "pupil");
    if (!pupil) return;
    reader.check_keys(*pupil, "[pupil]", {"diameter_mm"});
    const toml::node* diameter = pupil->get("diameter_mm");
    if (!diameter) return;
    if (diameter->value_or(std::string()) == "model")
        script.pupil_mm.reset();
    else
        reader.channel(*pupil, "diameter_mm", std::array<Range, 1>{Range{1.5, 9}}, *script.pupil_mm);
}

void read_blinks(Reader& reader, const toml::table& root, Script& script) {
    const toml::table* blinks = reader.table(root, "blinks");
    if (!blinks) return;
    reader.check_keys(*blinks, "[blinks]", {"at", "spontaneous_per_minute"});
    reader.blinks(*blinks, "at", script.blinks);
    reader.number(*blinks, "spontaneous_per_minute", {0, 60}, script.spontaneous_blinks_per_minute);
}

void read_lost(Reader& reader, const toml::table& root, Script& script) {
    const toml::table* lost = reader.table(root, "lost");
    if (!lost) return;
    reader.check_keys(*lost, "[lost]", {"head", "eyes"});
    reader.intervals(*lost, "head", script.head_lost);
    reader.intervals(*lost, "eyes", script.eyes_lost);
}

void read_tracker(Reader& reader, const toml::table& root, Script& script) {
    const toml::table* table = reader.table(root, "tracker");
    if (!table) return;
    TrackerScript& tracker = script.tracker;
    reader.check_keys(*table, "[tracker]",
                      {"rate_hz", "latency_ms", "latency_jitter_ms", "read_ahead_ms", "gaze_noise_deg", "gaze_offset_deg", "gaze_drift_deg",
                       "pupil_noise_mm", "dropout_probability", "bursts_per_minute", "missing_probability"});
    reader.number(*table, "rate_hz", {30, 500}, tracker.rate_hz);
    reader.number(*table, "latency_ms", milliseconds_range, tracker.latency_ms);
    reader.number(*table, "latency_jitter_ms", milliseconds_range, tracker.latency_jitter_ms);
    reader.number(*table, "read_ahead_ms", milliseconds_range, tracker.read_ahead_ms);
    reader.number(*table, "gaze_noise_deg", noise_degrees, tracker.gaze_noise_deg);
    reader.number(*table, "gaze_offset_deg", noise_degrees, tracker.gaze_offset_deg);
    reader.number(*table, "gaze_drift_deg", noise_degrees, tracker.gaze_drift_deg);
    reader.number(*table, "pupil_noise_mm", {0, 2}, tracker.pupil_noise_mm);
    reader.number(*table, "dropout_probability", probability, tracker.dropout_probability);
    reader.number(*table, "bursts_per_minute", {0, 60}, tracker.bursts_per_minute);
    reader.number(*table, "missing_probability", {0, 0.5}, tracker.missing_probability);
    if (tracker.latency_jitter_ms > tracker.latency_ms || 2 * tracker.latency_jitter_ms >= 1000 / tracker.rate_hz)
        reader.fail(*table, "latency_jitter_ms must not exceed latency_ms and must be less than half the time between two samples.");
    if (tracker.latency_ms + tracker.latency_jitter_ms > 900)
        reader.fail(*table, "latency_ms and latency_jitter_ms must not exceed 900 ms together.");
}

void read_buttons(Reader& reader, const toml::table& controller, ControllerScript& result) {
    const toml::table* buttons = reader.table(controller, "buttons");
    if (!buttons) return;
    reader.check_keys(*buttons, "[controllers.*.buttons]",
                      {"thumbstick_click", "thumbstick_touch", "trackpad_click", "trackpad_touch", "trigger_touch", "a", "b", "menu",
                       "system", "select"});
    for (std::size_t i = 0; i < button_count; ++i) reader.intervals(*buttons, button_names()[i], result.buttons[i]);
}

void read_controller(Reader& reader, const toml::table& controllers, const char* hand, ControllerScript& result) {
    const toml::table* table = reader.table(controllers, hand);
    if (!table) return;
    reader.check_keys(
        *table, fmt::format("[controllers.{}]", hand),
        {"enabled", "position_m", "orientation_deg", "trigger", "squeeze", "thumbstick", "trackpad", "buttons", "lost", "off"});
    reader.boolean(*table, "enabled", result.enabled);
    reader.channel(*table, "position_m", position_range, result.position_m);
    reader.channel(*table, "orientation_deg", angles_range, result.orientation_deg);
    reader.channel(*table, "trigger", std::array<Range, 1>{unit}, result.trigger);
    reader.channel(*table, "squeeze", std::array<Range, 1>{unit}, result.squeeze);
    reader.channel(*table, "thumbstick", stick_range, result.thumbstick);
    reader.channel(*table, "trackpad", stick_range, result.trackpad);
    read_buttons(reader, *table, result);
    reader.intervals(*table, "lost", result.lost);
    reader.intervals(*table, "off", result.off);
}

void read_controllers(Reader& reader, const toml::table& root, Script& script) {
    const toml::table* controllers = reader.table(root, "controllers");
    if (!controllers) return;
    reader.check_keys(*controllers, "[controllers]", {"left", "right"});
    read_controller(reader, *controllers, "left", script.controllers[0]);
    read_controller(reader, *controllers, "right", script.controllers[1]);
}

void read_duration(Reader& reader, const toml::table& root, Script& script) {
    script.duration_s = reader.end_time();
    reader.boolean(root, "loop", script.loop);
    reader.number(root, "duration_s", {0.001, longest_s}, script.duration_s);
    if (reader.error()) return;
    const toml::node* given = root.get("duration_s");
    if (script.loop && script.duration_s < reader.end_time()) {
        reader.fail(given ? *given : static_cast<const toml::node&>(root),
                    fmt::format("a script that loops must last until its last event, {:.3f} s.", reader.end_time()));
    }
    if (script.loop && script.duration_s <= 0) reader.fail(*root.get("loop"), "a script without keys cannot loop; give duration_s.");
}

void read_version(Reader& reader, const toml::table& root) {
    double version = 1;
    reader.number(root, "version", {1, 1}, version);
}

Result<Script> script_of(const toml::table& root, const std::string& source) {
    Reader reader(source);
    Script script;
    reader.check_keys(
        root, "a script",
        {"version", "name", "description", "duration_s", "loop", "head", "gaze", "pupil", "blinks", "lost", "tracker", "controllers"});
    read_version(reader, root);
    script.name = source;
    reader.text(root, "name", script.name);
    reader.text(root, "description", script.description);
    read_head(reader, root, script);
    read_gaze(reader, root, script);
    read_pupil(reader, root, script);
    read_blinks(reader, root, script);
    read_lost(reader, root, script);
    read_tracker(reader, root, script);
    read_controllers(reader, root, script);
    read_duration(reader, root, script);
    if (reader.error()) return forward_error(*reader.error());
    return script;
}

std::string builtin_names() {
    std::string names;
    for (const BuiltinScript& script : builtin_scripts()) names += fmt::format("{}{}", names.empty() ? "" : ", ", script.name);
    return names;
}

}  // namespace

Result<Script> parse_script(const std::string& text, const std::string& source) {
    try {
        return script_of(toml::parse(std::string_view(text), std::string_view(source)), source);
    } catch (const toml::parse_error& error) {
        return usage_error(fmt::format("{}:{}: not valid TOML: {}.", source, error.source().begin.line, error.description()));
    } catch (const std::exception& error) { return usage_error(fmt::format("{}: cannot be read: {}.", source, error.what())); }
}

Result<Script> load_script(const std::string& name_or_path) {
    for (const BuiltinScript& script : builtin_scripts()) {
        if (name_or_path == script.name) return parse_script(script.text, script.name);
    }
    std::error_code code;
    if (!std::filesystem::is_regular_file(name_or_path, code))
        return usage_error(
            fmt::format("There is no script '{}': neither a file nor one of the built-in scripts {}.", name_or_path, builtin_names()));
    if (std::filesystem::file_size(name_or_path, code) > largest_file || code)
        return usage_error(fmt::format("Script '{}' is larger than 16 MiB or cannot be read.", name_or_path));
    std::ifstream file(name_or_path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    if (!file) return usage_error(fmt::format("Script '{}' cannot be read; check its permissions.", name_or_path));
    return parse_script(text.str(), name_or_path);
}

}  // namespace entoptic::drivers
