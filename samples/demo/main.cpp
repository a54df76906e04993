// entoptic-demo: a low-light office with a desk lamp, as in the user study of Luidolt et al. 2020, in cd/m².
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "samples/common/failure.h"
#include "samples/demo/keys.h"
#include "samples/demo/light_control.h"
#include "samples/demo/offscreen.h"

namespace samples {

namespace {

struct Options {
    std::string light = "dusk";
    std::string lamp;
    double lamp_cd_m2 = bulb_peak_cd_m2;
    std::string script;
    double at_seconds = 0;
    std::uint64_t frames = 0;
    double seconds = 0;
    std::string samples;  // empty: by the device
    std::string detail = "full";
    bool measure = false;
    int plants = 0;
    bool no_extension = false;
    OffscreenOptions offscreen;
};

VkExtent2D parse_size(const std::string& text) {
    unsigned width = 0, height = 0;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%ux%u%c", &width, &height, &rest) != 2 || width == 0 || height == 0 || width > 16384 || height > 16384) {
        throw Failure(ExitCode::usage, fmt::format("--size {}: expected WxH, for example 1440x1600", text));
    }
    return {width, height};
}

// Returns the exit code when the command line ends the program.
std::optional<int> parse(int argc, char** argv, Options& options) {
    CLI::App app{"A small office under light from day to starlight, for OpenXR runtimes that simulate the eye.", "entoptic-demo"};
    std::string size = "1440x1600";
    app.add_option("--light", options.light, "day, dusk, night, starlight, or cycle through all")
        ->check(CLI::IsMember({"day", "dusk", "night", "starlight", "cycle"}))
        ->capture_default_str();
    app.add_option("--lamp", options.lamp, "the desk lamp on or off (default: the light's)")->check(CLI::IsMember({"on", "off"}));
    app.add_option("--lamp-cd", options.lamp_cd_m2, "luminance of the bulb's centre, cd/m2")
        ->check(CLI::Range(1.0, 1e8))
        ->capture_default_str();
    app.add_option("--script", options.script, "CSV of keyframes: time_s,sky_cd_m2,moon,ceiling,lamp (the last three 0 to 1)");
    app.add_option("--frames", options.frames, "end the session after N frames drawn (off screen: draw N times)");
    app.add_option("--seconds", options.seconds, "end the session after so much displayed time")->check(CLI::NonNegativeNumber);
    app.add_option("--samples", options.samples,
                   "samples a pixel, 1 or 4, or gaze: 4 only where the eye can see them, by XR_ENTOPTICX_observer (default: 4 on a GPU, 1 "
                   "on a software renderer)")
        ->check(CLI::IsMember({"1", "4", "gaze"}));
    app.add_option("--detail", options.detail,
                   "full, or gaze: objects as coarse as the eye cannot tell from the whole, where XR_ENTOPTICX_observer says that it looks")
        ->check(CLI::IsMember({"full", "gaze"}))
        ->capture_default_str();
    app.add_option("--plants", options.plants, "potted plants of 147 000 triangles each")
        ->check(CLI::Range(0, most_plants))
        ->capture_default_str();
    app.add_flag("--measure", options.measure, "draw each picture in full detail too, and print triangles and GPU times of both");
    app.add_flag("--no-extension", options.no_extension, "leave XR_ENTOPTICX_scene_luminance out");
    auto* folder = app.add_option("--offscreen", options.offscreen.folder, "no OpenXR: write DIR/left.exr and DIR/right.exr in cd/m2");
    app.add_option("--size", size, "pixels of an eye, WxH")->needs(folder)->capture_default_str();
    app.add_option("--fov", options.offscreen.fov_degrees, "horizontal field of view, degrees")
        ->needs(folder)
        ->check(CLI::Range(1.0, 160.0))
        ->capture_default_str();
    app.add_option("--yaw", options.offscreen.yaw_degrees, "head turned right, degrees")->needs(folder);
    app.add_option("--pitch", options.offscreen.pitch_degrees, "head tilted up, degrees")->needs(folder);
    app.add_option("--gaze", options.offscreen.gaze_degrees, "X,Y: where both eyes look, degrees right and up of the view's centre")
        ->delimiter(',')
        ->expected(2)
        ->check(CLI::Range(-180.0, 180.0))
        ->needs(folder);
    app.add_option("--at", options.at_seconds, "time of the script or cycle to show, s")->needs(folder);
    app.add_option("--offscreen-png", options.offscreen.png_white_cd_m2, "write PNGs too, with this luminance in cd/m2 as white")
        ->needs(folder)
        ->check(CLI::PositiveNumber);
    app.footer(
        "Keys in the terminal: d day, u dusk, n night, s starlight, l lamp, c ceiling, m moon, + - brighter and darker sky, q quit.\n"
        "Controllers: select toggles the lamp; stick, trackpad or trigger dims the sky.");
    try {
        app.parse(argc, argv);
        options.offscreen.size = parse_size(size);
        options.offscreen.whole_too = options.measure;
        if (options.measure && options.samples == "gaze") {
            throw CLI::ValidationError("--measure", "does not go with --samples gaze, which draws in two passes");
        }
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? static_cast<int>(ExitCode::done) : static_cast<int>(ExitCode::usage);
    }
    options.offscreen.frames = options.frames;
    return std::nullopt;
}

LightControl make_control(const Options& options) {
    std::optional<LightScript> script;
    if (!options.script.empty()) {
        script = LightScript::load(options.script);
    } else if (options.light == "cycle") {
        script = LightScript::day_cycle();
    }
    Light light = script ? script->at(0) : preset_light(options.light);
    if (!options.lamp.empty()) {
        if (script) { throw Failure(ExitCode::usage, "--lamp does not go with a script or the cycle, which switch the lamp themselves"); }
        light.lamp = options.lamp == "on" ? 1 : 0;
    }
    return {light, std::move(script)};
}

class Demo : public Scene {
public:
    Demo(const Options& options, LightControl control)
        : options_(options), control_(std::move(control)), office_(build_office(options.plants)) {}

    // Bakes the light and uploads the office.
    void load(const Gpu& gpu, bool keep_depth) {
        using clock = std::chrono::steady_clock;
        const auto seconds = [](clock::duration d) { return std::chrono::duration<double>(d).count(); };
        const auto start = clock::now();
        const std::vector<Canvas> materials = paint_materials();
        const auto painted = clock::now();
        const Lightmap lightmap = bake(office_, materials);
        const auto baked = clock::now();
        const DrawOptions draw{sampling(gpu), options_.detail == "gaze" ? Detail::gaze : Detail::full, options_.measure,
                               options_.lamp_cd_m2, keep_depth};
        renderer_ = std::make_unique<OfficeRenderer>(gpu, office_, materials, lightmap, draw);
        fmt::print(stderr, "office ready: textures {:.2f} s, light {:.2f} s ({} x {} texels), upload {:.2f} s, on {}\n",
                   seconds(painted - start), seconds(baked - painted), lightmap.width, lightmap.height, seconds(clock::now() - baked),
                   gpu.properties().deviceName);
    }

    OfficeRenderer& renderer() { return *renderer_; }
    LightControl& control() { return control_; }

    void prepare(const Gpu& gpu, const std::vector<EyeImages>& eyes) override {
        load(gpu, !eyes.front().depth_images.empty());
        for (const EyeImages& eye : eyes) { renderer_->add_eye(eye.extent, eye.images, eye.depth_images); }
        if (options_.no_extension) {
            fmt::print(stderr,
                       "entoptic-demo: XR_ENTOPTICX_scene_luminance is not in use; tell the runtime the scale another way, for "
                       "example `entoptic run --luminance {} -- entoptic-demo`\n",
                       pre_exposure(renderer_->brightest(all_lights)));
        }
        if (keys_.active()) { fmt::print(stderr, "keys: d u n s light, l lamp, c ceiling, m moon, + - sky, q quit\n"); }
    }

    bool update(const FrameTime& time, const ControllerInput& input) override {
        control_.update(time, input);
        bool go_on = true;
        while (const auto key = keys_.next()) { go_on = control_.press(*key) && go_on; }
        // Without the extension the unit stays put: the runtime cannot be told of a change.
        unit_ = pre_exposure(renderer_->brightest(options_.no_extension ? all_lights : control_.light()));
        renderer_->set_light(control_.light(), unit_);
        return go_on;
    }

    float luminance_per_unit() const override { return unit_; }

    void draw(std::uint32_t eye, std::uint32_t image, std::uint32_t depth, const EyeView& view) override {
        renderer_->draw(eye, image, depth, view);
    }

    // For runtimes that take no XR_ENTOPTICX_scene_luminance: one unit for any light, which they can be told by other means.
    void fix_unit() { options_.no_extension = true; }

private:
    static constexpr Light all_lights{5000, 1, 1, 1};

    // Measured at 1440 x 1600 an eye, CPU time of both eyes: lavapipe 0.26 s with one sample and 0.62 s with four. For GPUs
    // four is a choice, not measured.
    Sampling sampling(const Gpu& gpu) const {
        if (options_.samples == "gaze") { return Sampling::gaze; }
        const bool software = gpu.properties().deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
        return options_.samples == "4" || (options_.samples.empty() && !software) ? Sampling::four : Sampling::one;
    }

    Options options_;
    LightControl control_;
    KeyReader keys_;
    Office office_;
    std::unique_ptr<OfficeRenderer> renderer_;
    float unit_ = 1;
};

std::string in_words(const DrawCost& cost) {
    const double pictures = static_cast<double>(cost.pictures);
    std::string text = fmt::format("{:.0f} triangles", cost.triangles / pictures);
    std::vector<double> times = cost.milliseconds;
    if (times.empty()) { return text; }
    std::sort(times.begin(), times.end());
    return text + fmt::format(", GPU {:.2f} ms (median; fastest {:.2f})", times[times.size() / 2], times.front());
}

// What the picture of an eye cost, in the mean.
void print_cost(const OfficeRenderer& renderer) {
    if (renderer.cost().pictures == 0) { return; }
    fmt::print(
        stderr, "drawn, a picture of an eye: {} (in full detail {})\n", in_words(renderer.cost()),
        renderer.whole_cost().pictures > 0 ? in_words(renderer.whole_cost()) : fmt::format("{} triangles", renderer.whole_triangles()));
}

int run_offscreen(const Options& options) {
    const auto gpu = Gpu::standalone("Entoptic demo");
    Demo demo(options, make_control(options));
    if (options.light == "cycle" || !options.script.empty()) { demo.control().update({options.at_seconds, 0}, {}); }
    demo.load(*gpu, true);
    render_offscreen(*gpu, demo.renderer(), demo.control().light(), options.offscreen);
    if (options.detail == "gaze" || options.measure) { print_cost(demo.renderer()); }
    return static_cast<int>(ExitCode::done);
}

int run_openxr(const Options& options) {
    LightControl control = make_control(options);
    XrAppOptions app_options;
    app_options.application = "Entoptic demo";
    app_options.formats = {OfficeRenderer::format};
    app_options.scene_luminance = !options.no_extension;
    app_options.gaze = options.samples == "gaze" || options.detail == "gaze";
    app_options.controllers = true;
    app_options.near_m = OfficeRenderer::near_plane;
    app_options.far_m = OfficeRenderer::far_plane;
    app_options.frames = options.frames;
    app_options.seconds = options.seconds;
    XrApp app(app_options);
    Demo demo(options, std::move(control));  // after the app, so that it is destroyed before its device
    if (!app.tells_luminance()) { demo.fix_unit(); }
    std::signal(SIGINT, [](int) { XrApp::request_end(); });
    std::signal(SIGTERM, [](int) { XrApp::request_end(); });
    app.run(demo);
    if (options.detail == "gaze" || options.measure) { print_cost(demo.renderer()); }
    if (options.samples == "gaze") {
        fmt::print(stderr, "four samples in {:.1f} % of all pixels: where an eye could have seen the difference\n",
                   100 * demo.renderer().finely_sampled_share());
    }
    return static_cast<int>(ExitCode::done);
}

}  // namespace

}  // namespace samples

int main(int argc, char** argv) {
    return samples::run_reporting_failures("entoptic-demo", [&] {
        samples::Options options;
        if (const auto exit_code = samples::parse(argc, argv, options)) { return *exit_code; }
        return options.offscreen.folder.empty() ? samples::run_openxr(options) : samples::run_offscreen(options);
    });
}
