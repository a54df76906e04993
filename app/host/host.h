// The services behind one XrInstance: headset, clock, device and compositor wired together as the configuration says.
#pragma once

#include "app/host/layer_watch.h"
#include "app/host/session_report.h"
#include "app/status_file.h"
#include "compositor/service.h"
#include "drivers/eye_tracking/eye_calibration.h"
#include "interfaces/runtime_host.h"

#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

namespace entoptic::app {

// The runtime's factory (interfaces/runtime_host.h). A failure is also told to the `entoptic run` that started this process, if one did.
Result<std::unique_ptr<RuntimeHost>> make_host(const ApplicationIdentity& application);

// Nobody sees a panel that is away, whoever wears the headset.
class PanelPresence final : public PresenceSource {
public:
    PanelPresence(PresenceSource& wearer, const compositor::CompositorService& frames) : wearer_(wearer), frames_(frames) {}
    bool user_present() override { return frames_.display_lit() && wearer_.user_present(); }

private:
    PresenceSource& wearer_;
    const compositor::CompositorService& frames_;
};

class Host final : public RuntimeHost {
public:
    static Result<std::unique_ptr<Host>> create(const ApplicationIdentity& application, const Config& config);
    ~Host() override;

    Headset& headset() override { return headset_; }
    Clock& clock() override { return *clock_; }
    bool lockstep() const override { return facts_.config.clock.value == "lockstep"; }
    Clock& stopwatch() override { return stopwatch_; }
    FrameService& frames() override { return *watch_; }
    LayerLuminance default_luminance() const override { return facts_.luminance; }
    void recommended_eye_size(std::uint32_t& width, std::uint32_t& height) const override;
    std::array<double, 2> resolved_angles_rad() const override;
    Quirks quirks() const override;
    void report_error(const std::string& message) override;

    // Writes the report and takes the status away; once, also when the process exits with the instance still open.
    void finish();

private:
    Host() = default;
    Result<void> start(const ApplicationIdentity& application, const Config& config);
    Result<void> open_compositor();
    void start_publishing();
    void publish_until_stopped();
    void publish();
    // Takes and answers a request of `entoptic set`; true when there was one.
    bool adjust();
    Result<void> apply(const SettingsRequest& request);
    // The wearer looks at the centre now. What has changed, in words.
    Result<std::string> recentre_gaze(bool save);
    // The window's key for it.
    void answer_key();
    SessionFacts facts_now() const;
    std::vector<std::string> errors(const compositor::RunReport& report) const;
    void judge(const compositor::RunReport& report) const;
    void write_report(const compositor::RunReport& report) const;

    SessionFacts facts_;
    std::unique_ptr<Clock> clock_;
    MonotonicClock stopwatch_;
    Headset headset_;
    std::shared_ptr<drivers::CalibratedEyes> eyes_;  // the headset's eye tracker
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<compositor::CompositorService> frames_;
    std::unique_ptr<PanelPresence> panel_presence_;
    std::unique_ptr<LayerWatch> watch_;
    StatusFile status_;

    mutable std::mutex mutex_;
    std::condition_variable stop_publishing_;
    std::vector<std::string> errors_;  // of the runtime; the compositor keeps its own
    bool finished_ = false;
    std::atomic<bool> acuity_simulated_ = false;  // of facts_.selection, for the application's threads
    std::thread publisher_;
};

}  // namespace entoptic::app
