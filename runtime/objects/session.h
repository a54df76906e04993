// XrSession: its state machine and its frame loop. Thread-safe; xrWaitFrame and the wait for the application's GPU work in xrEndFrame
// block without a lock that other calls need.
//
//   IDLE → READY → (begin) → SYNCHRONIZED and VISIBLE with the first finished frame → FOCUSED with the second
//   without graphics (XR_MND_headless): all three at begin, for such an application need not submit frames
//   exit wanted: → VISIBLE → SYNCHRONIZED → STOPPING → (end) → IDLE → EXITING
#pragma once

#include "interfaces/runtime_host.h"
#include "runtime/objects/action_input.h"
#include "runtime/objects/graphics.h"
#include "runtime/objects/handle_table.h"
#include "runtime/objects/outcome.h"

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

namespace entoptic::runtime {

class Session final : public Object {
public:
    Session(std::shared_ptr<Instance> instance, std::unique_ptr<GraphicsDevice> graphics);
    Instance& instance() override { return *instance_; }
    void retire() override;

    XrSession xr() const { return to_handle<XrSession>(handle()); }
    RuntimeHost& host() const;
    // Null for a headless session.
    GraphicsDevice* graphics() { return graphics_.get(); }
    ActionInput& input() { return input_; }
    bool focused() const;
    // LOCAL's origin: where the head was when the session was made, level with gravity.
    const Pose& world_from_local() const { return world_from_local_; }

    // Tells IDLE and READY. Once, when the handle exists.
    void announce();
    // XR_ERROR_SESSION_RUNNING, XR_ERROR_SESSION_NOT_READY.
    Outcome begin(XrViewConfigurationType views);
    // What the session was begun with; stereo before.
    XrViewConfigurationType view_configuration() const;
    // XR_ERROR_SESSION_NOT_RUNNING, XR_ERROR_SESSION_NOT_STOPPING.
    Outcome end();
    // XR_ERROR_SESSION_NOT_RUNNING.
    Outcome request_exit();
    // Follows the host's wish to stop, and tells when the headset was put on or taken off.
    void follow_host();

    Outcome wait_frame(XrFrameState& state);
    // XR_FRAME_DISCARDED when the frame begun before was never ended.
    Outcome begin_frame();
    // `resolve` turns the application's layers into the submission (it may block); called only when a frame is begun.
    Outcome end_frame(const std::function<Outcome(FrameSubmission&)>& resolve);

private:
    void enter(XrSessionState state);  // with mutex_
    void advance_after_frame();        // with mutex_
    void stop();                       // with mutex_
    void drop_frames();                // with mutex_
    void tell_presence(bool present);  // with mutex_
    bool renders() const { return state_ == XR_SESSION_STATE_VISIBLE || state_ == XR_SESSION_STATE_FOCUSED; }

    const std::shared_ptr<Instance> instance_;
    const std::unique_ptr<GraphicsDevice> graphics_;
    const Pose world_from_local_;
    ActionInput input_;

    mutable std::mutex mutex_;
    std::condition_variable frame_begun_;
    XrSessionState state_ = XR_SESSION_STATE_UNKNOWN;
    XrViewConfigurationType views_ = XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO;
    std::optional<bool> told_presence_;  // what the application knows
    bool running_ = false;
    bool exiting_ = false;  // asked to; leads to EXITING
    bool retired_ = false;
    std::uint64_t run_ = 0;  // counts begin(): a call that blocked across an end does not touch the next run
    bool waiting_ = false;   // a thread is in FrameService::wait_frame()
    std::optional<FrameTiming> waited_, begun_;
};

}  // namespace entoptic::runtime
