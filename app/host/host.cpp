#include "app/host/host.h"

#include "app/calibration_target.h"
#include "app/cli/output.h"
#include "app/display_file.h"
#include "app/host/display_target.h"
#include "app/host/eye_size.h"
#include "app/host/resolution.h"
#include "app/launch.h"
#include "app/observer_calibration.h"
#include "app/observer_file.h"
#include "base/log.h"
#include "compositor/warm_up.h"
#include "drivers/driver.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace entoptic::app {
namespace {

constexpr std::chrono::milliseconds publish_every{500}, look_for_requests_every{50};
constexpr std::size_t kept_errors = 100;

// ---- The host that lives, for exit() with an instance still open ------------------------------------------------------------------

std::mutex live_mutex;
Host* live_host = nullptr;

void finish_live_host() {
    Host* host = nullptr;
    {
        const std::lock_guard lock(live_mutex);
        std::swap(host, live_host);
    }
    if (host) host->finish();
}
void set_live_host(Host* host) {
    static const int registered = std::atexit(finish_live_host);
    (void)registered;
    const std::lock_guard lock(live_mutex);
    live_host = host;
}
void forget_live_host(const Host* host) {
    const std::lock_guard lock(live_mutex);
    if (live_host == host) live_host = nullptr;
}

// ---- From the configuration to the rooms' options ------------------------------------------------------------------------------------

void tell_launcher(const Config& config, const std::string& message) {
    if (config.launcher_directory.value.empty()) return;
    std::ofstream(fmt::format("{}/{}", config.launcher_directory.value, failure_file), std::ios::app) << message << '\n';
}

Result<Headset> open_headset(const Config& config, TimeNs start_time) {
    drivers::DriverOptions options;
    options.name = config.hmd.value;
    options.panel_width = config.panel.value.first;
    options.panel_height = config.panel.value.second;
    options.ipd_mm = config.ipd_mm.value;
    options.script = config.script.value;
    options.seed = config.seed.value;
    options.ideal_tracker = config.ideal_tracker.value;
    options.start_time = start_time;
    options.real_time = config.clock.value == "real";
    return drivers::open_headset(options);
}

// Eye cameras in place of the headset's own tracker, where the configuration says so or the headset is a real one.
Result<void> choose_eye_tracker(const Config& config, Clock& clock, Headset& headset) {
    const std::string& wanted = config.eye_tracker.value;
    const bool automatic = wanted == "auto";
    if (wanted == "headset" || (automatic && (config.hmd.value == "virtual" || config.hmd.value == "replay"))) return {};
    if (config.clock.value == "lockstep")
        return usage_error("Eye cameras work in real time only. Use --clock real, or eye_tracker = \"headset\".");
    auto eyes = drivers::open_eye_tracker(wanted, clock);
    if (!eyes) return automatic && eyes.error().kind == ErrorKind::missing ? Result<void>{} : forward_error(eyes.error());
    headset.eye_tracker = eyes->get();
    headset.owner = std::make_shared<std::pair<std::shared_ptr<void>, std::shared_ptr<EyeSource>>>(headset.owner, *eyes);
    return {};
}

// The person's calibration over whatever eye tracker there is.
Result<std::shared_ptr<drivers::CalibratedEyes>> calibrate_eye_tracker(const Config& config, Headset& headset) {
    ENTOPTIC_TRY(calibration, read_calibration(config.observer.value));
    const auto eyes = std::make_shared<drivers::CalibratedEyes>(*headset.eye_tracker, calibration);
    headset.eye_tracker = eyes.get();
    headset.owner = std::make_shared<std::pair<std::shared_ptr<void>, std::shared_ptr<EyeSource>>>(headset.owner, eyes);
    return eyes;
}

LayerLuminance luminance_of(const Config& config, const Photometry& panel) {
    if (!config.luminance.value) return {panel.white_cd_m2 - panel.black_cd_m2, panel.black_cd_m2, LuminanceSource::default_sdr};
    const bool command_line = config.luminance.origin == "command line";
    return {static_cast<float>(*config.luminance.value), 0,
            command_line ? LuminanceSource::command_line : LuminanceSource::application_profile};
}

compositor::WantedPictures wanted_pictures(const std::vector<std::string>& names) {
    const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
    return {has("warp"), has("perceive"), has("lens"), has("panel"), has("seen")};
}

}  // namespace

Result<std::unique_ptr<Host>> Host::create(const ApplicationIdentity& application, const Config& config) {
    std::unique_ptr<Host> host(new Host);
    ENTOPTIC_CHECK(host->start(application, config));
    set_live_host(host.get());
    return host;
}

Result<void> Host::start(const ApplicationIdentity& application, const Config& config) {
    facts_.started = stopwatch_.now();
    facts_.application = application;
    facts_.config = config;
    const auto selected = select_effects(config.preset.value, config.model_names(), config.setting_texts(), config.observer.value,
                                         perception::Viewer::wearer);
    if (!selected) return forward_error(with_origin(selected.error(), config));
    const perception::Selection& selection = *selected;
    facts_.selection = selection;
    acuity_simulated_ = selection.find("acuity") != nullptr;
    if (lockstep())
        clock_ = std::make_unique<VirtualClock>();
    else
        clock_ = std::make_unique<MonotonicClock>();
    ENTOPTIC_TRY(headset, open_headset(config, clock_->now()));
    headset_ = std::move(headset);
    ENTOPTIC_CHECK(choose_eye_tracker(config, *clock_, headset_));
    ENTOPTIC_TRY(eyes, calibrate_eye_tracker(config, headset_));
    eyes_ = std::move(eyes);
    if (!config.display.value.empty()) {
        ENTOPTIC_TRY(file, find_display_file(config.display.value));
        ENTOPTIC_TRY(photometry, measured_photometry(file));
        headset_.display.photometry = photometry;
    }
    facts_.hmd = headset_.display.name;
    facts_.luminance = luminance_of(config, headset_.display.photometry);
    ENTOPTIC_CHECK(open_compositor());
    start_publishing();
    return {};
}

Result<void> Host::open_compositor() {
    const Config& config = facts_.config;
    ENTOPTIC_TRY(device, gpu::Device::create({config.vulkan_validation.value, may_be_window(config), config.vulkan_device.value}));
    device_ = std::move(device);
    ENTOPTIC_CHECK(compositor::warm_up(*device_));  // before set_live_host
    compositor::ServiceOptions options;
    options.path.panel = {static_cast<std::uint32_t>(headset_.display.panel_width),
                          static_cast<std::uint32_t>(headset_.display.panel_height)};
    ENTOPTIC_TRY(open, open_target(*device_, stopwatch_, config, headset_.display, facts_.application.name));
    if (!open.instead.empty()) report_error(open.instead);
    options.path.eye_scale = config.eye_scale.value;
    options.path.display = {headset_.display.photometry.white_cd_m2, headset_.display.photometry.black_cd_m2};
    options.path.measured = headset_.display.photometry.measured;
    options.path.selection = facts_.selection;
    options.path.seed = config.seed.value;
    options.path.stopwatch = &stopwatch_;
    options.lockstep = lockstep();
    options.frame_limit = config.frames.value;
    options.dump.directory = config.dump_dir.value;
    if (!config.dump_dir.value.empty()) options.dump.stages = wanted_pictures(config.dump_stages.value);
    options.dump.every = static_cast<std::uint32_t>(std::min<std::uint64_t>(config.dump_every.value, UINT32_MAX));
    ENTOPTIC_TRY(frames, compositor::CompositorService::create(*device_, *clock_, headset_, std::move(open.target), std::move(options)));
    frames_ = std::move(frames);
    if (open.is_panel && headset_.presence) {
        panel_presence_ = std::make_unique<PanelPresence>(*headset_.presence, *frames_);
        headset_.presence = panel_presence_.get();
    }
    watch_ = std::make_unique<LayerWatch>(*frames_);
    return {};
}

Host::~Host() {
    forget_live_host(this);
    finish();
}

void Host::recommended_eye_size(std::uint32_t& width, std::uint32_t& height) const {
    const EyeSize size = app::recommended_eye_size(headset_, facts_.config.eye_scale.value);
    width = size.width;
    height = size.height;
}

std::array<double, 2> Host::resolved_angles_rad() const {
    const auto adaptation = frames_->adaptation_cd_m2();
    const bool scene = acuity_simulated_ && adaptation;
    std::array<double, 2> angles{};
    for (std::size_t eye = 0; eye < 2; ++eye)
        angles[eye] = resolved_angle_rad(static_cast<double>(scene ? (*adaptation)[eye] : headset_.display.photometry.white_cd_m2));
    return angles;
}

Quirks Host::quirks() const {
    const auto& names = facts_.config.quirks.value;
    return {.untyped_arrays = std::find(names.begin(), names.end(), "untyped_arrays") != names.end()};
}

void Host::report_error(const std::string& message) {
    {
        const std::lock_guard lock(mutex_);
        if (errors_.size() >= kept_errors || std::find(errors_.begin(), errors_.end(), message) != errors_.end()) return;
        errors_.push_back(message);
    }
    log::error("{}", message);
}

std::vector<std::string> Host::errors(const compositor::RunReport& report) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> all = errors_;
    all.insert(all.end(), report.errors.begin(), report.errors.end());
    return all;
}

// ---- Status and report --------------------------------------------------------------------------------------------------------------

void Host::start_publishing() {
    if (auto status = StatusFile::create())
        status_ = std::move(*status);
    else
        log::warn("{}", status.error().message);
    publish();
    publisher_ = std::thread([this] { publish_until_stopped(); });
}

void Host::publish_until_stopped() {
    std::unique_lock lock(mutex_);
    std::chrono::milliseconds since_published{0};
    while (!stop_publishing_.wait_for(lock, look_for_requests_every, [this] { return finished_; })) {
        lock.unlock();
        since_published += look_for_requests_every;
        answer_key();
        if (adjust() || since_published >= publish_every) {
            publish();
            since_published = {};
        }
        lock.lock();
    }
}

bool Host::adjust() {
    const auto taken = take_request(getpid());
    if (!taken) {
        report_error(taken.error().message);
        return true;
    }
    if (!*taken) return false;
    const auto done = apply(**taken);
    facts_.adjusted.id = (*taken)->id;
    facts_.adjusted.error = done ? "" : done.error().message;
    if (!done || !(*taken)->recentre_gaze) facts_.adjusted.gaze.clear();
    return true;
}

Result<void> Host::apply(const SettingsRequest& request) {
    LiveChoice live = joined(request.reset ? LiveChoice{} : facts_.adjusted.choice, request.choice);
    LiveChoice all{facts_.config.preset.value, facts_.config.model_names(), facts_.config.setting_texts()};
    all = joined(std::move(all), live);
    ENTOPTIC_TRY(selection,
                 select_effects(all.preset, all.models, all.settings, facts_.config.observer.value, perception::Viewer::wearer));
    if (request.recentre_gaze) {
        ENTOPTIC_TRY(gaze, recentre_gaze(request.save_gaze));
        facts_.adjusted.gaze = std::move(gaze);
    }
    if (!request.reset && text_of(request.choice).empty()) return {};
    facts_.selection = selection;
    acuity_simulated_ = selection.find("acuity") != nullptr;
    facts_.adjusted.choice = std::move(live);
    frames_->select(std::move(selection));
    return {};
}

Result<std::string> Host::recentre_gaze(bool save) {
    const std::string& observer = facts_.config.observer.value;
    if (!eyes_->present()) return missing(fmt::format("There is no eye tracker to re-centre: {}", eyes_->description()));
    if (save && observer.empty()) return usage_error("There is no observer whose file could keep it. Start the session with --observer NAME.");
    using drivers::GazeAngles;
    const auto shifts = eyes_->recentre(clock_->now(), {target_of_eye(headset_, 0, GazeAngles(0)), target_of_eye(headset_, 1, GazeAngles(0))});
    if (!shifts) return forward_error(shifts.error());
    std::string text = "Gaze re-centred";
    for (std::size_t eye = 0; eye < 2; ++eye) {
        const char* side = eye == 0 ? "left" : "right";
        if (const auto& shift = (*shifts)[eye])
            text += fmt::format("; {} eye: {:+.2f} degrees to the right, {:+.2f} up", side, shift->x, shift->y);
        else
            text += fmt::format("; {} eye: not seen, as before", side);
    }
    if (!save) return text + ".";
    drivers::EyeCalibration kept;
    kept.gaze = eyes_->calibration().gaze;
    ENTOPTIC_TRY(path, write_calibration(observer, kept));
    return fmt::format("{}. Kept in {}.", text, path);
}

void Host::answer_key() {
    if (!frames_->take_recentre_wish()) return;
    const auto done = recentre_gaze(false);
    if (done)
        log::info("{}", *done);
    else
        log::warn("{}", done.error().message);
}

SessionFacts Host::facts_now() const {
    SessionFacts facts = facts_;
    if (headset_.status) facts.headset = headset_.status->status();
    facts.eye_tracker_present = eyes_->present();
    facts.eye_tracker = eyes_->description();
    facts.luminance = watch_->luminance().value_or(facts_.luminance);
    return facts;
}

void Host::publish() {
    const compositor::RunReport report = frames_->report();
    const SessionFacts facts = facts_now();
    const std::vector<std::string> all = errors(report);
    if (const auto published = status_.publish(status_json(facts, report, frames_->last_outcome(), all)); !published)
        log::debug("{}", published.error().message);
    if (facts.config.launcher_directory.value.empty()) return;
    const std::string progress = fmt::format("{}/{}", facts.config.launcher_directory.value, progress_file);
    if (const auto written = write_json(progress, report_json(facts, report, all)); !written) log::debug("{}", written.error().message);
}

void Host::finish() {
    if (!frames_) return;    // never came to life
    frames_->end_session();  // its thread rests from now on: nothing of Vulkan runs while the process takes libraries apart
    {
        const std::lock_guard lock(mutex_);
        if (finished_) return;
        finished_ = true;
        stop_publishing_.notify_all();
    }
    if (publisher_.joinable()) publisher_.join();
    const compositor::RunReport report = frames_->report();
    write_report(report);
    judge(report);
    status_ = {};
    (void)take_request(getpid());  // one that came too late
}

void Host::write_report(const compositor::RunReport& report) const {
    if (facts_.config.report.value.empty()) return;
    if (const auto written = write_json(facts_.config.report.value, report_json(facts_now(), report, errors(report))); !written) {
        log::error("{}", written.error().message);
        tell_launcher(facts_.config, written.error().message);
    }
}

// Pictures that were asked for and did not come are the runtime's failure, whatever the application says.
void Host::judge(const compositor::RunReport& report) const {
    const std::vector<std::string> all = errors(report);
    if (report.frames.submitted > 0 && report.frames.displayed == 0)
        tell_launcher(facts_.config, fmt::format("No frame could be shown. {}", all.empty() ? "" : all.front()));
    if (facts_.config.dump_dir.value.empty()) return;
    for (const std::string& error : all)
        if (error.find(facts_.config.dump_dir.value) != std::string::npos) tell_launcher(facts_.config, error);
}

Result<std::unique_ptr<RuntimeHost>> make_host(const ApplicationIdentity& application) {
    auto config = load_config(ApplicationNames{application.name, application.engine});
    if (!config) {
        log::error("{}", config.error().message);
        return forward_error(config.error());
    }
    auto host = Host::create(application, *config);
    if (!host) {
        log::error("{}", host.error().message);
        tell_launcher(*config, host.error().message);
        return forward_error(host.error());
    }
    return std::unique_ptr<RuntimeHost>(std::move(*host));
}

}  // namespace entoptic::app
