// The compositor as the runtime sees it: swapchains, frame pacing, and a thread that composes. See compositor/compositor.md.
#pragma once

#include "compositor/dump.h"
#include "compositor/frame.h"
#include "compositor/images.h"
#include "compositor/pacing.h"
#include "compositor/report.h"
#include "compositor/targets/target.h"
#include "interfaces/frame_service.h"

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

namespace entoptic::compositor {

struct ServiceOptions {
    FramePathOptions path;
    bool lockstep = false;          // the clock is virtual: every submitted frame is composed exactly once, at its predicted time
    std::uint64_t frame_limit = 0;  // exit_wanted() after so many displayed frames; 0: never
    DumpOptions dump;
    // Problems that a user should know of, each message once. Called from any thread, without locks held.
    std::function<void(const std::string&)> on_error = [](const std::string&) {};
};

class CompositorService final : public FrameService {
public:
    // `device`, `clock` and `headset` outlive the service. ServiceOptions::path.eyes is taken from the headset.
    static Result<std::unique_ptr<CompositorService>> create(gpu::Device& device, Clock& clock, Headset& headset,
                                                             std::unique_ptr<DisplayTarget> target, ServiceOptions options);
    ~CompositorService() override;  // ends the session and the thread

    std::array<std::uint8_t, 16> device_uuid() const override { return device_.device_uuid(); }
    std::array<std::uint8_t, 16> driver_uuid() const override { return device_.driver_uuid(); }
    std::vector<std::int64_t> swapchain_formats() const override { return pool_.formats(); }
    Result<SwapchainAllocation> create_swapchain(const SwapchainRequest& request) override { return pool_.create(request); }
    void destroy_swapchain(std::uint64_t id) override { pool_.destroy(id); }
    bool wait_image_idle(std::uint64_t swapchain, std::uint32_t image_index, DurationNs timeout) override {
        return pool_.wait_idle(swapchain, image_index, timeout);
    }
    void begin_session() override;
    void end_session() override;
    FrameTiming wait_frame() override;
    void begin_frame(std::uint64_t frame_id) override;
    void submit_frame(FrameSubmission frame) override;
    void discard_frame(std::uint64_t frame_id) override;
    bool exit_wanted() const override;
    std::optional<std::array<float, 2>> adaptation_cd_m2() const override;
    std::vector<PresentationRecord> presentation_records(std::size_t count) const override;
    void add_cpu_time(const std::string& stage, double ms) override;

    RunReport report() const;
    // Somebody could see pictures now: the display is not away.
    bool display_lit() const { return target_->lit(); }
    // The user pressed the window's key for it since this was asked last.
    bool take_recentre_wish() { return target_->take_recentre_wish(); }
    // What the last composition found, for `entoptic status`.
    FrameOutcome last_outcome() const;
    // Replaces models and parameters from the next frame on.
    void select(perception::Selection selection);

private:
    // A frame between wait_frame() and its end.
    struct Promise {
        std::int64_t refresh = 0;
        TimeNs display_time = 0, begun = 0;
    };
    struct Submitted {
        FrameSubmission frame;
        ImageUse images;
        Promise promise;
        TimeNs submitted_time = 0;
        bool discarded = false;  // lockstep: only time passes
        bool shown = false;      // was composed before
    };
    using Lock = std::unique_lock<std::mutex>;

    CompositorService(gpu::Device& device, Clock& clock, Headset& headset, ServiceOptions options);
    void run();
    void run_lockstep(Lock& lock);
    void run_real(Lock& lock);
    void compose_for_refresh(Lock& lock, std::int64_t refresh);
    FrameDescription describe(const Submitted& submitted, TimeNs display_time);
    // Composes, dumps and presents without the lock. False when no picture came of it.
    bool compose(Submitted& submitted, FrameDescription& frame, FrameOutcome& outcome);
    void apply_selection();
    void present(const FrameDescription& frame, FrameOutcome& outcome);
    // After compose(): waits until the picture comes to light, where the display tells. Without the lock.
    PresentFeedback wait_shown();
    void finish(Submitted& submitted, const FrameDescription& frame, const FrameOutcome& outcome, std::int64_t refresh, TimeNs light);
    // A picture that nobody can have seen, as the display is away.
    void unseen(const FrameOutcome& outcome);
    void report_error(const std::string& message);
    Promise take_promise(std::uint64_t frame_id, TimeNs fallback);

    gpu::Device& device_;
    Clock& clock_;
    Headset& headset_;
    ServiceOptions options_;
    SwapchainPool pool_;
    std::unique_ptr<DisplayTarget> target_;
    std::unique_ptr<FramePath> path_;  // the compositor's thread only
    FrameDumper dumper_;

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    FramePacing pacing_;
    PresentationLog log_;
    RunStatistics statistics_;
    std::map<std::string, EffectReport> effects_;
    FrameOutcome last_outcome_;
    std::deque<Submitted> queue_;         // submitted, not yet taken up; on a real clock the newest only
    std::unique_ptr<Submitted> current_;  // real clock: shown now, to be reprojected
    std::optional<perception::Selection> new_selection_;
    std::map<std::uint64_t, Promise> promises_;
    std::uint64_t next_frame_id_ = 1, last_begun_ = 0, composition_index_ = 0;
    TimeNs last_promised_ = 0, last_light_ = 0;
    bool presented_ = false;  // the last picture was handed to the display; the compositor's thread only
    bool session_ = false, ending_ = false, composing_ = false, stop_ = false;
    std::thread thread_;
};

}  // namespace entoptic::compositor
