#include "compositor/service.h"

#include "base/log.h"

#include <algorithm>
#include <exception>
#include <utility>

namespace entoptic::compositor {
namespace {

RefreshGrid refresh_grid(const Clock& clock, const DisplayIdentity& display) {
    return {clock.now(), display.period, display.vblank_to_photon};
}

// Promises of frames that were never ended are forgotten after so many.
constexpr std::size_t kept_promises = 64;

}  // namespace

CompositorService::CompositorService(gpu::Device& device, Clock& clock, Headset& headset, ServiceOptions options)
    : device_(device),
      clock_(clock),
      headset_(headset),
      options_(std::move(options)),
      pool_(device),
      dumper_(options_.dump),
      pacing_(refresh_grid(clock, headset.display)) {}

Result<std::unique_ptr<CompositorService>> CompositorService::create(gpu::Device& device, Clock& clock, Headset& headset,
                                                                     std::unique_ptr<DisplayTarget> target, ServiceOptions options) {
    options.path.eyes = headset.eyes;
    options.path.repeatable = options.lockstep;
    std::unique_ptr<CompositorService> service(new CompositorService(device, clock, headset, std::move(options)));
    ENTOPTIC_TRY(path, FramePath::create(device, service->options_.path));
    service->path_ = std::move(path);
    service->target_ = std::move(target);
    service->thread_ = std::thread([raw = service.get()] { raw->run(); });
    return service;
}

CompositorService::~CompositorService() {
    end_session();
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
        changed_.notify_all();
    }
    if (thread_.joinable()) thread_.join();
}

void CompositorService::begin_session() {
    const std::lock_guard lock(mutex_);
    session_ = true;
    ending_ = false;
    last_promised_ = std::max(last_promised_, clock_.now());
    last_light_ = 0;  // the eyes begin anew
    last_begun_ = next_frame_id_ - 1;
    changed_.notify_all();
}

void CompositorService::end_session() {
    std::unique_ptr<Submitted> last;
    Lock lock(mutex_);
    if (!session_) return;
    ending_ = true;
    changed_.notify_all();
    changed_.wait(lock, [&] { return stop_ || (queue_.empty() && !composing_); });
    session_ = ending_ = false;
    last = std::move(current_);
    promises_.clear();
    log_.cleared();
    changed_.notify_all();
}

FrameTiming CompositorService::wait_frame() {
    Lock lock(mutex_);
    const auto running = [&] { return session_ && !ending_ && !stop_; };
    const std::uint64_t id = next_frame_id_++;
    changed_.wait(lock, [&] { return !running() || last_begun_ + 1 >= id; });
    changed_.wait(lock, [&] { return !running() || (queue_.empty() && (!options_.lockstep || !composing_)); });
    Promise promise;
    TimeNs start = 0;
    DurationNs period = pacing_.grid().period;
    if (options_.lockstep || !running()) {
        promise.display_time = std::max(last_promised_, options_.lockstep ? TimeNs(0) : clock_.now()) + period;
    } else {
        const FramePacing::Prediction prediction = pacing_.predict(clock_.now());
        promise.refresh = prediction.refresh;
        promise.display_time = prediction.display_time;
        start = prediction.start_time;
        period = prediction.period;
    }
    last_promised_ = promise.display_time;
    promises_[id] = promise;
    if (promises_.size() > kept_promises) promises_.erase(promises_.begin());
    log_.predicted(id, promise.display_time);
    const FrameTiming timing{id, promise.display_time, period, running()};
    lock.unlock();
    if (timing.should_render && !options_.lockstep) clock_.sleep_until(start);
    return timing;
}

void CompositorService::begin_frame(std::uint64_t frame_id) {
    const std::lock_guard lock(mutex_);
    last_begun_ = std::max(last_begun_, frame_id);
    if (const auto promise = promises_.find(frame_id); promise != promises_.end()) promise->second.begun = clock_.now();
    changed_.notify_all();
}

CompositorService::Promise CompositorService::take_promise(std::uint64_t frame_id, TimeNs fallback) {
    Promise promise;
    promise.display_time = fallback;
    if (const auto found = promises_.find(frame_id); found != promises_.end()) {
        promise = found->second;
        promises_.erase(found);
    }
    return promise;
}

void CompositorService::submit_frame(FrameSubmission frame) {
    ImageUse images = pool_.use(frame.layers);
    std::deque<Submitted> replaced;  // goes after the lock
    const std::lock_guard lock(mutex_);
    if (!session_) return;
    Submitted submitted;
    submitted.promise = take_promise(frame.frame_id, frame.display_time);
    submitted.submitted_time = clock_.now();
    submitted.images = std::move(images);
    submitted.frame = std::move(frame);
    log_.submitted(submitted.frame.frame_id, submitted.submitted_time);
    if (!options_.lockstep) {
        if (submitted.promise.begun) pacing_.application_took(submitted.submitted_time - submitted.promise.begun);
        replaced.swap(queue_);
    }
    queue_.push_back(std::move(submitted));
    changed_.notify_all();
}

void CompositorService::discard_frame(std::uint64_t frame_id) {
    const std::lock_guard lock(mutex_);
    log_.discarded(frame_id);
    Submitted nothing;
    nothing.discarded = true;
    nothing.promise = take_promise(frame_id, 0);
    last_begun_ = std::max(last_begun_, frame_id);
    if (options_.lockstep && session_) queue_.push_back(std::move(nothing));  // time passes in order
    changed_.notify_all();
}

bool CompositorService::exit_wanted() const {
    if (target_->close_wanted()) return true;
    const std::lock_guard lock(mutex_);
    return options_.frame_limit > 0 && log_.counts().displayed >= options_.frame_limit;
}

std::optional<std::array<float, 2>> CompositorService::adaptation_cd_m2() const {
    const std::lock_guard lock(mutex_);
    const std::array<float, 2> cd_m2{last_outcome_.views[0].adaptation_cd_m2, last_outcome_.views[1].adaptation_cd_m2};
    return cd_m2[0] > 0 && cd_m2[1] > 0 ? std::optional(cd_m2) : std::nullopt;
}

std::vector<PresentationRecord> CompositorService::presentation_records(std::size_t count) const {
    const std::lock_guard lock(mutex_);
    return log_.records(count);
}

void CompositorService::add_cpu_time(const std::string& stage, double ms) {
    const std::lock_guard lock(mutex_);
    statistics_.add_cpu(stage, ms);
}

void CompositorService::select(perception::Selection selection) {
    const std::lock_guard lock(mutex_);
    new_selection_ = std::move(selection);
}

FrameOutcome CompositorService::last_outcome() const {
    const std::lock_guard lock(mutex_);
    return last_outcome_;
}

RunReport CompositorService::report() const {
    const std::lock_guard lock(mutex_);
    RunReport report;
    report.device = device_.name();
    report.driver = device_.driver();
    report.target = target_->description();
    report.lockstep = options_.lockstep;
    report.frames = log_.counts();
    report.effects = effects_;
    statistics_.write(report);
    return report;
}

void CompositorService::report_error(const std::string& message) {
    {
        const std::lock_guard lock(mutex_);
        if (!statistics_.add_error(message)) return;
    }
    log::error("{}", message);
    options_.on_error(message);
}

void CompositorService::run() {
    Lock lock(mutex_);
    while (!stop_) {
        if (options_.lockstep)
            run_lockstep(lock);
        else
            run_real(lock);
    }
}

// One turn: waits for a submitted frame, passes the time until its light, and composes it.
void CompositorService::run_lockstep(Lock& lock) {
    changed_.wait(lock, [&] { return stop_ || !queue_.empty(); });
    if (stop_) return;
    Submitted next = std::move(queue_.front());
    queue_.pop_front();
    composing_ = true;
    lock.unlock();
    clock_.sleep_until(next.promise.display_time);
    FrameDescription frame;
    FrameOutcome outcome;
    const bool done = !next.discarded && compose(next, frame = describe(next, next.promise.display_time), outcome);
    next.images.release();
    const bool shown = done && wait_shown().shown;  // its refreshes are not this clock's
    lock.lock();
    if (done && !shown) unseen(outcome);
    if (shown) finish(next, frame, outcome, static_cast<std::int64_t>(frame.index), frame.display_time);
    composing_ = false;
    changed_.notify_all();
}

// One turn: waits until there is something to show, sleeps until it is time for the next refresh, and composes for it.
void CompositorService::run_real(Lock& lock) {
    changed_.wait(lock, [&] { return stop_ || !queue_.empty() || (current_ && pacing_.keeps_up() && !ending_); });
    if (stop_) return;
    const FramePacing::Plan plan = pacing_.plan(clock_.now());
    if (plan.wake_time > clock_.now()) {
        lock.unlock();
        clock_.sleep_until(plan.wake_time);
        lock.lock();
        if (stop_ || !session_) return;
    }
    compose_for_refresh(lock, plan.refresh);
}

void CompositorService::compose_for_refresh(Lock& lock, std::int64_t refresh) {
    std::unique_ptr<Submitted> before;
    if (!queue_.empty() && (ending_ || pacing_.may_show(queue_.front().promise.refresh, refresh))) {
        before = std::exchange(current_, std::make_unique<Submitted>(std::move(queue_.front())));
        queue_.pop_front();
    }
    const bool something = current_ && (before || !current_->shown || pacing_.keeps_up());
    pacing_.taken(refresh, clock_.now(), something);
    if (!something) return;
    composing_ = true;
    changed_.notify_all();  // the queue is free: the application may go on
    lock.unlock();
    before.reset();
    FrameOutcome outcome;
    FrameDescription frame = describe(*current_, pacing_.grid().light(refresh));
    const bool done = compose(*current_, frame, outcome);
    const TimeNs composed = clock_.now();
    const PresentFeedback feedback = done ? wait_shown() : PresentFeedback{false, 0, 0};
    lock.lock();
    const std::int64_t shown_at = pacing_.composed(composed, feedback.vblank_time, feedback.period);
    if (feedback.shown)
        finish(*current_, frame, outcome, shown_at, pacing_.grid().light(shown_at));
    else if (done)
        unseen(outcome);
    current_->shown = true;
    composing_ = false;
    changed_.notify_all();
}

FrameDescription CompositorService::describe(const Submitted& submitted, TimeNs display_time) {
    FrameDescription frame;
    frame.index = composition_index_++;
    frame.frame_id = submitted.frame.frame_id;
    frame.reprojected = submitted.shown;
    frame.predicted_display_time = submitted.promise.display_time;
    frame.submitted_time = submitted.submitted_time;
    frame.layers = submitted.frame.layers;
    const TimeNs started = options_.path.stopwatch ? options_.path.stopwatch->now() : 0;
    predict(frame, headset_, clock_.now(), display_time, last_light_);
    // Until an application has shown its first layer there is nothing to be adapted to: the eyes begin with the first picture.
    if (last_light_ > 0 || !frame.layers.empty()) last_light_ = display_time;
    if (options_.path.stopwatch) {
        const std::lock_guard lock(mutex_);
        statistics_.add_cpu("predict", static_cast<double>(options_.path.stopwatch->now() - started) * 1e-6);
    }
    return frame;
}

bool CompositorService::compose(Submitted& submitted, FrameDescription& frame, FrameOutcome& outcome) {
    try {
        apply_selection();
        auto composed = path_->compose(frame, submitted.images, dumper_.wanted(frame.index));
        if (!composed) {
            report_error(composed.error().message);
            return false;
        }
        outcome = std::move(*composed);
        if (!outcome.problem.empty()) report_error(outcome.problem);
        if (const auto written = dumper_.write(*path_, frame); !written) report_error(written.error().message);
        present(frame, outcome);
        return true;
    } catch (const std::exception& e) {  // out of memory, most likely: the frame is lost, the session is not
        report_error(std::string("A frame could not be composed: ") + e.what());
        return false;
    }
}

void CompositorService::apply_selection() {
    std::optional<perception::Selection> selection;
    {
        const std::lock_guard lock(mutex_);
        selection.swap(new_selection_);
    }
    if (!selection) return;
    if (const auto selected = path_->select(*selection); !selected) report_error(selected.error().message);
}

void CompositorService::present(const FrameDescription& frame, FrameOutcome& outcome) {
    const PresentState state{&frame, path_.get()};
    const Clock* stopwatch = options_.path.stopwatch;
    const TimeNs started = stopwatch ? stopwatch->now() : 0;
    auto shown = target_->test(state);
    if (shown) shown = target_->commit(state);
    presented_ = bool(shown);
    if (!shown) report_error(shown.error().message);
    if (stopwatch) outcome.cpu_ms.push_back({"present", static_cast<double>(stopwatch->now() - started) * 1e-6});
}

PresentFeedback CompositorService::wait_shown() {
    if (!presented_) return {false, 0, 0};
    const auto feedback = target_->wait_shown();
    if (feedback) return *feedback;
    report_error(feedback.error().message);
    return {false, 0, 0};
}

void CompositorService::unseen(const FrameOutcome& outcome) {
    log_.unseen();
    last_outcome_ = outcome;
}

void CompositorService::finish(Submitted& submitted, const FrameDescription& frame, const FrameOutcome& outcome, std::int64_t refresh,
                               TimeNs light) {
    log_.shown(submitted.frame.frame_id, refresh, light);
    statistics_.add(frame, outcome, light);
    if (options_.path.stopwatch) statistics_.presented(options_.path.stopwatch->now());
    if (path_->stage())
        for (const auto& [slot, totals] : path_->stage()->totals())
            effects_[slot] = {totals.recorded, totals.gated, totals.failed, totals.why};
    last_outcome_ = outcome;
}

}  // namespace entoptic::compositor
