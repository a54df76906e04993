// `entoptic simulate`: the perception stage on calibrated radiance maps, without a headset and without OpenXR.
#include "app/choice_json.h"
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/cli/simulate_plan.h"
#include "app/simulation/simulator.h"
#include "base/image_io.h"
#include "perception/pupil/watson_yellott.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>

namespace entoptic::app {
namespace {

using namespace perception;
using drivers::GazeAngles;

constexpr double frame_rate = 90;         // of the eye's states between the wanted times
constexpr double full_field_deg2 = 8495;  // a disc of 104 degrees, what a headset shows

// A gaze beside a flat picture goes to its edge, as that of a headset's wearer goes to the edge of the view.
GazeAngles inside(const EyeGeometry& g, GazeAngles gaze) {
    if (g.kind != geometry_rectilinear) return gaze;
    constexpr double degree = 1 / drivers::degrees_per_radian;
    const double right = std::atan(static_cast<double>(g.tan_right)), x = std::clamp(gaze.x * degree, -right, right);
    const double up = std::atan(static_cast<double>(g.tan_up) * std::cos(x));
    return GazeAngles(x, std::clamp(gaze.y * degree, -up, up)) / degree;
}

class Simulation {
public:
    Simulation(const SimulateOptions& options, SimulatePlan plan) : o_(options), plan_(std::move(plan)), progress_("frames", options.progress) {
        if (plan_.trace) trace_eye_.emplace(*plan_.trace);
    }

    Result<Json> run() {
        ENTOPTIC_CHECK(load(plan_.files[0]));
        tell_idle(plan_.selection, !scene_.depth.data.empty());
        ENTOPTIC_CHECK(start());
        ENTOPTIC_CHECK(plan_.files.size() > 1 ? run_sequence() : run_still());
        return report();
    }

private:
    Result<void> load(const InputFile& file) {
        ENTOPTIC_TRY(scene, load_scene(file.path, o_.scene));
        scene_ = std::move(scene);
        return {};
    }
    Result<void> start() {
        ENTOPTIC_TRY(geometry, scene_geometry(plan_.projection, o_.fov_deg, scene_.rgb.width, scene_.rgb.height));
        geometry_ = geometry;
        const SimulatorOptions options{geometry, display_, plan_.selection, o_.seed};
        if (o_.reference) {
            simulator_ = make_reference_simulator(options);
        } else {
            ENTOPTIC_TRY(device, gpu::Device::create({}));
            device_ = std::move(device);
            ENTOPTIC_TRY(simulator, make_gpu_simulator(*device_, options));
            simulator_ = std::move(simulator);
        }
        first_mean_ = mean_luminance(scene_.rgb, geometry_);
        simulator_->set_adaptation(plan_.adapted_to.value_or(std::clamp(first_mean_, 1e-6, 1e8)));
        return {};
    }
    // The eye at `time_s`, looking at the picture that is loaded.
    EyeInput eye_at(double time_s, double mean) {
        EyeInput eye;
        GazeAngles gaze = plan_.gaze;
        double pupil = plan_.pupil_mm.value_or(pupil_diameter_mm(mean, plan_.age, std::min(full_field_deg2, field_deg2(geometry_)), 2));
        if (trace_eye_) {
            trace_eye_->advance(time_s, pupil);
            gaze = inside(geometry_, trace_eye_->gaze(gaze));
            pupil = trace_eye_->pupil_mm().value_or(pupil);
            eye.eyelid_open = static_cast<float>(trace_eye_->eyelid_open());
        }
        eye.gaze_direction = vec3(drivers::direction_of(gaze));
        eye.pupil_diameter_mm = static_cast<float>(pupil);
        return eye;
    }
    Result<void> frame(double time_s, double dt_s, double mean, bool want_picture) {
        FrameInput input;
        input.dt_s = dt_s;
        input.snap = frames_ == 0 && !plan_.adapted_to;
        input.index = frames_++;
        input.eyes = {eye_at(time_s, mean)};
        return simulator_->frame(scene_.rgb, scene_.depth, input, want_picture);
    }
    Result<void> run_still() {
        ENTOPTIC_CHECK(frame(0, 0, first_mean_, plan_.times[0] == 0));
        const auto total = static_cast<std::uint64_t>(std::ceil(plan_.times.back() * frame_rate));
        double now = 0;
        for (const double wanted : plan_.times) {
            while (now < wanted) {
                const double next = (std::floor(now * frame_rate + 1e-6) + 1) / frame_rate;
                const double step_to = next > wanted - 1e-9 ? wanted : next;
                ENTOPTIC_CHECK(frame(step_to, step_to - now, first_mean_, step_to == wanted));
                now = step_to;
                progress_.update(static_cast<std::uint64_t>(now * frame_rate), total);
            }
            ENTOPTIC_CHECK(write(plan_.files[0], wanted));
        }
        return {};
    }
    Result<void> run_sequence() {
        for (std::size_t i = 0; i < plan_.files.size(); ++i) {
            if (i > 0) ENTOPTIC_CHECK(load(plan_.files[i]));
            if (scene_.rgb.width != static_cast<int>(geometry_.width) || scene_.rgb.height != static_cast<int>(geometry_.height))
                return failure(fmt::format("'{}' has {} x {} pixels, but the sequence began with {} x {}.", plan_.files[i].path,
                                           scene_.rgb.width, scene_.rgb.height, geometry_.width, geometry_.height));
            const double time_s = double(i) / o_.fps;
            ENTOPTIC_CHECK(frame(time_s, i == 0 ? 0 : 1 / o_.fps, i == 0 ? first_mean_ : mean_luminance(scene_.rgb, geometry_), true));
            ENTOPTIC_CHECK(write(plan_.files[i], time_s));
            progress_.update(i + 1, plan_.files.size());
        }
        return {};
    }
    Result<void> write(const InputFile& file, double time_s) {
        const std::string path = plan_.output.with(file.number, time_s);
        const ImageF shown = limited_to_display(simulator_->picture(), display_);
        const double adaptation = decimal(simulator_->view().adaptation_cd_m2);
        if (std::filesystem::path(path).extension() == ".png") {
            ENTOPTIC_CHECK(write_png(path, o_.dither ? dithered_codes(shown, display_, o_.seed, frames_) : display_codes(shown, display_)));
        } else {
            ExrAttributes attributes;
            attributes.white_luminance = 1.0f;
            attributes.text = {{"entopticVersion", ENTOPTIC_VERSION},
                               {"entopticPreset", plan_.selection.preset},
                               {"entopticQuantity", "display light, cd/m2"}};
            attributes.numbers = {{"entopticTime", static_cast<float>(time_s)},
                                  {"entopticPupilMm", simulator_->eye().pupil_diameter_mm},
                                  {"entopticAdaptation", static_cast<float>(adaptation)},
                                  {"entopticDisplayWhite", display_.white_cd_m2},
                                  {"entopticDisplayBlack", display_.black_cd_m2}};
            ENTOPTIC_CHECK(write_exr(path, shown, attributes));
        }
        outputs_.push_back(picture_json(file, time_s, path));
        return {};
    }
    Json picture_json(const InputFile& file, double time_s, const std::string& path) const {
        const ViewOutcome view = simulator_->view();
        const GazeAngles gaze = drivers::angles_of(glm::dvec3(simulator_->eye().gaze_direction));
        Json effects = Json::array();
        for (const EffectOutcome& e : simulator_->effects())
            effects.push_back(
                {{"slot", e.slot}, {"model", e.model}, {"recorded", e.recorded}, {"gated", e.gated}, {"failed", e.failed}, {"why", e.why}});
        return {{"input", file.path},
                {"output", path},
                {"time_s", time_s},
                {"gaze_deg", {gaze.x, gaze.y}},
                {"pupil_mm", decimal(simulator_->eye().pupil_diameter_mm)},
                {"scene",
                 {{"min_cd_m2", decimal(view.min_y)},
                  {"mean_cd_m2", decimal(view.mean_y)},
                  {"max_cd_m2", decimal(view.max_y)},
                  {"pixels_cleaned", view.cleaned}}},
                {"adaptation_cd_m2", decimal(view.adaptation_cd_m2)},
                {"effects", effects}};
    }
    Json trace_json() const {
        if (!plan_.trace) return nullptr;
        return {{"file", o_.trace},
                {"rows", plan_.trace->rows()},
                {"rows_without_gaze", plan_.trace->rows_without_gaze()},
                {"rows_without_pupil", plan_.trace->rows_without_pupil()}};
    }
    Json report() const {
        static constexpr const char* kinds[] = {"lens", "rectilinear", "equirect"};
        Json errors = Json::array();
        for (const EffectOutcome& e : simulator_->effects())
            if (!e.failed.empty()) errors.push_back(fmt::format("{}: {}", e.slot, e.failed));
        return {{"version", ENTOPTIC_VERSION},
                {"device", simulator_->device()},
                {"preset", plan_.selection.preset},
                {"observer", o_.observer},
                {"models", o_.models},
                {"settings", o_.settings},
                {"photographic", o_.photographic},
                {"seed", o_.seed},
                {"adapted_to", o_.adapted_to},
                {"chosen", choice_json(plan_.selection)},
                {"projection", kinds[geometry_.kind]},
                {"size", {geometry_.width, geometry_.height}},
                {"photometry", {{"scale", scene_.cd_per_unit}, {"source", scene_.scale_source}}},
                {"display", {{"white_cd_m2", decimal(display_.white_cd_m2)}, {"black_cd_m2", decimal(display_.black_cd_m2)}}},
                {"trace", trace_json()},
                {"frames", frames_},
                {"pictures", outputs_},
                {"errors", errors}};
    }

    const SimulateOptions& o_;
    SimulatePlan plan_;
    Progress progress_;
    Scene scene_;
    EyeGeometry geometry_{};
    DisplayRange display_;
    double first_mean_ = 0;
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<Simulator> simulator_;
    std::optional<TraceEye> trace_eye_;
    std::uint64_t frames_ = 0;
    Json outputs_ = Json::array();
};

// Said once, for people: pixels that had to be cleaned, and effects that failed.
void tell(const Json& report) {
    std::uint64_t cleaned = 0;
    for (const Json& picture : report["pictures"]) cleaned += picture["scene"]["pixels_cleaned"].get<std::uint64_t>();
    if (cleaned > 0)
        fmt::print(stderr, "entoptic: {} pixels held NaN, an infinity, a negative or more than 1e8 cd/m² and were brought into range.\n",
                   cleaned);
    if (const Json& trace = report["trace"];
        trace.is_object() && trace["rows_without_gaze"].get<int>() + trace["rows_without_pupil"].get<int>() > 0)
        fmt::print(stderr,
                   "entoptic: of {} rows in '{}' {} have no gaze and {} no pupil that an eye can have: held, then relaxed, as when a "
                   "tracker loses the eye.\n",
                   trace["rows"].get<int>(), trace["file"].get<std::string>(), trace["rows_without_gaze"].get<int>(),
                   trace["rows_without_pupil"].get<int>());
    for (const Json& error : report["errors"]) fmt::print(stderr, "entoptic: an effect is off: {}\n", error.get<std::string>());
}

Result<int> simulate(const SimulateOptions& options) {
    ENTOPTIC_TRY(plan, make_plan(options));
    ENTOPTIC_TRY(report, Simulation(options, std::move(plan)).run());
    tell(report);
    if (!options.report.empty()) ENTOPTIC_CHECK(write_json(options.report, report));
    if (options.json) {
        print_json(report);
    } else {
        for (const Json& picture : report["pictures"]) fmt::print("{}\n", picture["output"].get<std::string>());
    }
    return report["errors"].empty() ? 0 : 1;
}

}  // namespace

void add_simulate(CLI::App& app, Action& action) {
    auto o = std::make_shared<SimulateOptions>();
    CLI::App* c = app.add_subcommand("simulate", "Show what an eye would see of an OpenEXR radiance map");
    c->add_option("IN", o->input, "OpenEXR picture, or a numbered sequence such as in_%04d.exr")->required();
    c->add_option("-o,--output", o->output,
                  "Picture to write: .exr display light in cd/m², .png as the display shows it; %t is the time, %04d the frame")
        ->required();
    c->add_option("--fov", o->fov_deg, "Horizontal field of view of a flat picture, degrees");
    c->add_option("--projection", o->projection, "rectilinear or equirect")->check(CLI::IsMember({"rectilinear", "equirect"}));
    c->add_option("--luminance-scale", o->scene.luminance_scale, "cd/m² of RGB (1,1,1); default: the file's whiteLuminance");
    c->add_option("--assume-white", o->scene.assume_white, "The same, for files without whiteLuminance");
    c->add_option("--downscale", o->scene.downscale, "Average squares of K x K pixels first")->check(CLI::Range(1, 64));
    c->add_option("--fps", o->fps, "Frames a second of a numbered sequence")->check(CLI::Range(0.01, 10000.0));
    c->add_option("--gaze", o->gaze, "X,Y in degrees from the centre, right and up positive");
    c->add_option("--trace", o->trace,
                  "CSV file: time_s, gaze_x_deg, gaze_y_deg, pupil_mm, blink; filtered as an eye tracker's samples are");
    c->add_option("--pupil", o->pupil, "Pupil diameter in mm, or 'model' (from the scene's mean luminance), of the eye in the scene");
    c->add_option("--adapted-to", o->adapted_to, "What the eye was adapted to before: cd/m², or 'scene'");
    c->add_option("--at", o->at, "Seconds after the scene appears, such as 0,0.5,10");
    c->add_option("--preset", o->preset, "Preset of effects (entoptic effects lists them)");
    add_repeated(*c, "--model", o->models, "SLOT=NAME or SLOT=none");
    add_repeated(*c, "--set", o->settings, "SLOT.parameter=value");
    c->add_option("--observer", o->observer, "Person whose eye this is: observers/NAME.toml");
    c->add_option("--seed", o->seed, "Seed of everything random");
    c->add_flag("--reference", o->reference, "Double precision by the independent references, slow");
    c->add_flag("--photographic", o->photographic, "For pictures, not headsets: scatter the whole scene");
    c->add_flag("--dither", o->dither, "PNG: light between two codes as one of them by chance, each frame anew");
    c->add_option("--report", o->report, "Write what was done as JSON");
    c->add_flag("--json", o->json, "Print the report on standard output");
    c->add_flag("--progress", o->progress, "Tell progress even without a terminal");
    c->callback([o, &action] { action = [o] { return simulate(*o); }; });
}

}  // namespace entoptic::app
