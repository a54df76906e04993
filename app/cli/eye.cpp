// `entoptic eye detect`: the pupil in pictures of eyes, by the same detector that the eye cameras' driver runs.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "base/gray_image_io.h"
#include "drivers/pupil_labs/pupil_detector.h"

#include <chrono>
#include <fmt/format.h>
#include <limits>
#include <memory>
#include <optional>

namespace entoptic::app {
namespace {

struct EyeOptions {
    std::vector<std::string> files;
    bool csv = false, json = false;
};

struct Row {
    std::string file;
    drivers::PupilDetection pupil;
    double ms = 0;
};

double degrees(double radians) { return radians * 180 / M_PI; }

std::string csv_cell(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string cell = "\"";
    for (const char c : text) cell += c == '"' ? "\"\"" : std::string(1, c);
    return cell + "\"";
}

void print_csv(const Row& row) {
    const auto& [found, e, confidence, quality] = row.pupil;
    if (found)
        fmt::print("{},1,{:.3f},{:.3f},{:.3f},{:.3f},{:.2f},{:.4f},{:.4f}\n", csv_cell(row.file), e.x, e.y, e.major, e.minor,
                   degrees(e.angle), confidence, row.ms);
    else
        fmt::print("{},0,nan,nan,nan,nan,nan,{:.4f},{:.4f}\n", csv_cell(row.file), confidence, row.ms);
}

void print_line(const Row& row) {
    const auto& [found, e, confidence, quality] = row.pupil;
    if (found)
        fmt::print("{}: pupil at {:.1f}, {:.1f} px, {:.1f} x {:.1f} px at {:.0f} degrees, confidence {:.2f}, {:.2f} ms\n", row.file, e.x,
                   e.y, e.major, e.minor, degrees(e.angle), confidence, row.ms);
    else
        fmt::print("{}: no pupil, {:.2f} ms\n", row.file, row.ms);
}

Json row_json(const Row& row) {
    const auto& [found, e, confidence, quality] = row.pupil;
    Json json = {{"file", row.file}, {"found", found}};
    const auto number = [&](double value) { return found ? Json(value) : Json(nullptr); };
    json.update({{"x_px", number(e.x)},
                 {"y_px", number(e.y)},
                 {"major_px", number(e.major)},
                 {"minor_px", number(e.minor)},
                 {"angle_deg", number(degrees(e.angle))},
                 {"confidence", confidence},
                 {"ms", row.ms}});
    return json;
}

Result<Row> detect_in(drivers::PupilDetector& detector, const std::string& file) {
    ENTOPTIC_TRY(image, read_gray(file));
    const auto start = std::chrono::steady_clock::now();
    const drivers::PupilDetection pupil = detector.detect(drivers::view_of(image));
    return Row{file, pupil, std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count()};
}

Result<int> detect(const EyeOptions& options) {
    drivers::PupilDetector detector;
    Json rows = Json::array();
    int unread = 0;
    if (options.csv) fmt::print("file,found,x_px,y_px,major_px,minor_px,angle_deg,confidence,ms\n");
    for (const std::string& file : options.files) {
        const Result<Row> row = detect_in(detector, file);
        if (!row) {
            fmt::print(stderr, "entoptic: {}\n", row.error().message);
            ++unread;
        } else if (options.json) {
            rows.push_back(row_json(*row));
        } else if (options.csv) {
            print_csv(*row);
        } else {
            print_line(*row);
        }
    }
    if (options.json) print_json(rows);
    if (unread > 0) return failure(fmt::format("{} of {} files could not be read.", unread, options.files.size()));
    return 0;
}

}  // namespace

void add_eye(CLI::App& app, Action& action) {
    auto options = std::make_shared<EyeOptions>();
    CLI::App* eye = app.add_subcommand("eye", "Work on pictures of eyes");
    eye->require_subcommand(1);
    CLI::App* command = eye->add_subcommand("detect", "Find the pupil in pictures of eyes (PGM, PNG, JPEG)");
    command->add_option("files", options->files, "Pictures under infrared light, at least 32 px each way")->required();
    CLI::Option* csv = command->add_flag(
        "--csv", options->csv, "Comma-separated: pixel centres at +0.5, full lengths of the axes, angle from +x towards +y (down)");
    command->add_flag("--json", options->json, "One JSON document on standard output")->excludes(csv);
    command->callback([options, &action] { action = [options]() -> Result<int> { return detect(*options); }; });
}

}  // namespace entoptic::app
