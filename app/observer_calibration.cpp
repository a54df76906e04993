#include "app/observer_calibration.h"

#include "app/config.h"
#include "app/observer_file.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <toml++/toml.h>
#include <unistd.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;
using drivers::EyeCalibration;
using drivers::GazeMap;

const char* const sides[2] = {"left", "right"};

fs::path path_of(const std::string& observer) { return fs::path(config_folder()) / "observers" / (observer + ".toml"); }

Result<toml::table> table_in(const fs::path& path) {
    std::ifstream in(path);
    if (!in) return toml::table{};  // none, or one that comes with the program: nothing calibrated
    try {
        return toml::parse(in, path.string());
    } catch (const toml::parse_error& e) {
        return usage_error(fmt::format("{}:{}: {}.", path.string(), e.source().begin.line, e.description()));
    }
}

// What a person's file starts from: itself, or the observer of that name who comes with the program, whose place it will take.
Result<toml::table> table_to_extend(const std::string& observer) {
    const fs::path path = path_of(observer);
    std::error_code error;
    if (fs::exists(path, error)) return table_in(path);
    for (const BuiltInObserver& person : built_in_observers())
        if (observer == person.name) return toml::parse(person.toml);
    return toml::table{};
}

tl::unexpected<Error> wrong(const fs::path& path, const toml::node& node, const std::string& what) {
    return usage_error(fmt::format("{}:{}: {} Calibrate again (entoptic calibrate).", path.string(), node.source().begin.line, what));
}

bool read_terms(const toml::node* node, std::array<double, GazeMap::terms>& out) {
    const auto* list = node ? node->as_array() : nullptr;
    if (!list || list->size() != out.size()) return false;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const auto number = list->get(i)->is_number() ? list->get(i)->value<double>() : std::nullopt;
        if (!number) return false;
        out[i] = *number;
    }
    return true;
}

Result<GazeMap> read_map(const fs::path& path, const toml::node& node) {
    GazeMap map;
    const auto* rows = node.as_array();
    if (!rows || rows->size() != 2 || !read_terms(rows->get(0), map.right) || !read_terms(rows->get(1), map.up))
        return wrong(path, node, "gaze needs two lists of six numbers.");
    if (!map.sensible()) return wrong(path, node, "this correction of the gaze is not one of an eye.");
    return map;
}

Result<EyeCalibration> calibration_in(const fs::path& path, const toml::table& table) {
    EyeCalibration calibration;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        if (const toml::node* node = table["gaze"][sides[eye]].node()) {
            ENTOPTIC_TRY(map, read_map(path, *node));
            calibration.gaze[eye] = map;
        }
    }
    if (const toml::node* node = table["pupil"].node()) {
        const auto narrowest = table["pupil"]["narrowest_mm"].value<double>(), widest = table["pupil"]["widest_mm"].value<double>();
        if (!narrowest || !widest || !(*narrowest >= 1 && *widest <= 10 && *narrowest < *widest))
            return wrong(path, *node, "pupil needs narrowest_mm and widest_mm, 1 to 10.");
        calibration.pupil_range_mm = {*narrowest, *widest};
    }
    return calibration;
}

toml::array list_of(const std::array<double, GazeMap::terms>& terms) {
    toml::array list;
    for (const double term : terms) list.push_back(term);
    return list;
}

void put(toml::table& table, const EyeCalibration& calibration) {
    for (std::size_t eye = 0; eye < 2; ++eye) {
        if (!calibration.gaze[eye]) continue;
        if (!table["gaze"].is_table()) table.insert_or_assign("gaze", toml::table{});
        table["gaze"].as_table()->insert_or_assign(sides[eye],
                                                   toml::array{list_of(calibration.gaze[eye]->right), list_of(calibration.gaze[eye]->up)});
    }
    if (calibration.pupil_range_mm)
        table.insert_or_assign(
            "pupil", toml::table{{"narrowest_mm", calibration.pupil_range_mm->first}, {"widest_mm", calibration.pupil_range_mm->second}});
}

}  // namespace

Result<EyeCalibration> read_calibration(const std::string& observer) {
    if (observer.empty() || observer.find('/') != std::string::npos) return EyeCalibration{};
    const fs::path path = path_of(observer);
    ENTOPTIC_TRY(table, table_in(path));
    return calibration_in(path, table);
}

Result<std::string> write_calibration(const std::string& observer, const EyeCalibration& calibration) {
    if (observer.empty() || observer.find('/') != std::string::npos)
        return usage_error(fmt::format("'{}' cannot be an observer's name: it names a file in observers/.", observer));
    const fs::path path = path_of(observer);
    ENTOPTIC_TRY(table, table_to_extend(observer));
    put(table, calibration);
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    const fs::path temporary = path.string() + fmt::format(".{}", getpid());
    {
        std::ofstream out(temporary);
        out << table << "\n";
        if (!out.flush())
            return failure(fmt::format("Cannot write '{}'. Check that its folder may be written and has room.", temporary.string()));
    }
    fs::rename(temporary, path, error);
    if (error) return failure(fmt::format("Cannot write '{}': {}.", path.string(), error.message()));
    return path.string();
}

}  // namespace entoptic::app
