#include "app/calibration_session.h"

#include "app/calibration_target.h"
#include "app/host/host.h"
#include "app/launch.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace entoptic::app {
namespace {

constexpr double target_size_m = 0.035;                                          // one degree
constexpr double backdrop_distance_m = 3, backdrop_size_m = 30;                  // fills any lens
constexpr std::uint32_t format_rgba8_srgb = 43, usage_colour_attachment = 0x10;  // VkFormat, VkImageUsageFlagBits
constexpr double reaction_s = 0.2;                                               // of the virtual wearer: latency of a saccade
constexpr double narrow_mm = 2.6, wide_mm = 6.4, pupil_moves_s = 2;              // of the virtual wearer, in the panel's white and black
constexpr int small_panel_width = 48, small_panel_height = 54;  // virtual headset: nobody looks, the tracker is what is measured

// A head-locked square of even light: whatever its picture holds counts nothing (0 cd/m² a unit), its light is the offset.
Layer square(std::uint64_t picture, glm::dvec3 at, double size_m, float cd_m2) {
    Layer layer;
    layer.kind = LayerKind::quad;
    layer.head_locked = true;
    layer.luminance = {0, cd_m2, LuminanceSource::layer_extension};
    layer.views[0].image = {picture, 0, 0, 0, 0, 8, 8};
    layer.space_from_quad.position = glm::vec3(at);
    layer.quad_width_m = layer.quad_height_m = static_cast<float>(size_m);
    return layer;
}

class Session {
public:
    Session(Host& host, const std::vector<CalibrationStep>& steps) : host_(host), steps_(steps) {}

    Result<std::vector<CalibrationSample>> run(const std::function<void(std::size_t, std::size_t)>& progress) {
        ENTOPTIC_TRY(picture, make_picture());
        FrameService& frames = host_.frames();
        frames.begin_session();
        for (step_ = 0; step_ < steps_.size(); ++step_) {
            progress(step_, steps_.size());
            show_step(picture);
        }
        frames.end_session();
        frames.destroy_swapchain(picture);
        return samples_;
    }

private:
    Result<std::uint64_t> make_picture() {
        SwapchainRequest request;
        request.vk_format = format_rgba8_srgb;
        request.width = request.height = 8;
        request.vk_usage = usage_colour_attachment;
        request.is_static = true;
        ENTOPTIC_TRY(allocation, host_.frames().create_swapchain(request));
        for (const ImageMemory& image : allocation.images) ::close(image.fd);
        return allocation.id;
    }

    std::vector<Layer> layers(std::uint64_t picture) const {
        const CalibrationStep& step = steps_[step_];
        const Photometry& panel = host_.headset().display.photometry;
        std::vector<Layer> all{
            square(picture, {0, 0, -backdrop_distance_m}, backdrop_size_m, step.white ? panel.white_cd_m2 : panel.black_cd_m2)};
        if (step.target_deg) all.push_back(square(picture, target_point(*step.target_deg), target_size_m, 0.3f * panel.white_cd_m2));
        return all;
    }

    void show_step(std::uint64_t picture) {
        FrameService& frames = host_.frames();
        TimeNs start = 0, now = 0;
        do {
            const FrameTiming timing = frames.wait_frame();
            frames.begin_frame(timing.frame_id);
            frames.submit_frame({timing.frame_id, timing.predicted_display_time, layers(picture)});
            now = timing.predicted_display_time;
            if (start == 0) start = now;
            note_samples(start, now - timing.period);
        } while (seconds(now - start) < steps_[step_].seconds && !frames.exit_wanted());
    }

    void note_samples(TimeNs start, TimeNs now) {
        for (int eye = 0; eye < 2; ++eye) {
            const auto raw = host_.headset().eye_tracker->raw_at(eye, now);
            const auto e = static_cast<std::size_t>(eye);
            if (!raw || raw->time <= newest_[e]) continue;
            newest_[e] = raw->time;
            CalibrationSample sample{step_, seconds(raw->time - start), eye, *raw, {}};
            if (const auto& target = steps_[step_].target_deg) sample.target_deg = target_of_eye(host_.headset(), e, *target);
            samples_.push_back(sample);
        }
    }

    Host& host_;
    const std::vector<CalibrationStep>& steps_;
    std::size_t step_ = 0;
    std::array<TimeNs, 2> newest_{};
    std::vector<CalibrationSample> samples_;
};

Result<void> make_virtual(Config& config, const std::string& folder, const std::vector<CalibrationStep>& steps) {
    const std::string path = folder + "/wearer.toml";
    std::ofstream out(path);
    out << wearer_script(steps);
    if (!out.flush()) return failure(fmt::format("Cannot write '{}'. Check that its folder has room.", path));
    config.script.value = path;
    config.clock.value = "lockstep";
    config.target.value = "headless";
    config.panel.value = {small_panel_width, small_panel_height};
    return {};
}

}  // namespace

std::string wearer_script(const std::vector<CalibrationStep>& steps) {
    std::string gaze = "[0, 0, 0]", pupil = fmt::format("[0, {}]", !steps.empty() && steps[0].white ? narrow_mm : wide_mm);
    double start = 0, at_gaze = 0, at_pupil = 0, diameter = !steps.empty() && steps[0].white ? narrow_mm : wide_mm;
    for (const CalibrationStep& step : steps) {
        if (step.target_deg && start + reaction_s > at_gaze) {
            at_gaze = start + reaction_s;
            gaze += fmt::format(", [{:.3f}, {:.4f}, {:.4f}]", at_gaze, step.target_deg->x, step.target_deg->y);
        }
        const double wanted = step.white ? narrow_mm : wide_mm;
        if (wanted != diameter && start + reaction_s > at_pupil) {
            at_pupil = start + reaction_s + pupil_moves_s;
            pupil += fmt::format(", [{:.3f}, {}], [{:.3f}, {}]", start + reaction_s, diameter, at_pupil, wanted);
            diameter = wanted;
        }
        start += step.seconds;
    }
    return fmt::format(
        "version = 1\nname = \"calibration\"\nduration_s = {:.3f}\n[gaze.direction_deg]\nkeys = [{}]\n[gaze.vergence_m]\nkeys = [[0, {}]]\n"
        "[pupil.diameter_mm]\ninterpolation = \"smooth\"\nkeys = [{}]\n",
        start + 10, gaze, target_distance_m, pupil);
}

Result<std::vector<CalibrationSample>> run_calibration(const Config& config, const std::vector<CalibrationStep>& steps,
                                                       const std::function<void(std::size_t, std::size_t)>& progress) {
    ENTOPTIC_TRY(folder, PrivateFolder::create());
    Config own = config;
    own.observer.value.clear();  // its calibration would be calibrated again
    own.preset.value = "off";
    own.models.clear();
    own.settings.clear();
    own.frames.value = 0;
    own.report.value.clear();
    own.dump_dir.value.clear();
    if (own.hmd.value == "virtual" && own.eye_tracker.value != "pupil-labs") ENTOPTIC_CHECK(make_virtual(own, folder.path(), steps));
    ENTOPTIC_TRY(host, Host::create({"entoptic calibrate", "", 0, 0, 0, {}}, own));
    if (!host->headset().eye_tracker->present())
        return missing(fmt::format("There is no eye tracker to calibrate: {}", host->headset().eye_tracker->description()));
    return Session(*host, steps).run(progress);
}

}  // namespace entoptic::app
