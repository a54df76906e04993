#include "runtime/objects/session.h"

#include "runtime/objects/instance.h"

#include <cmath>

namespace entoptic::runtime {

namespace {

Outcome not_running() {
    return error(XR_ERROR_SESSION_NOT_RUNNING, "the session is not running; wait for XR_SESSION_STATE_READY and call xrBeginSession");
}

// The head's place, turned about the vertical only. A head that looks straight up or down keeps the world's heading.
Pose levelled(const Pose& head) {
    const glm::vec3 forward = head.rotate({0, 0, -1});
    const bool level_enough = forward.x * forward.x + forward.z * forward.z > 1e-6f;
    const float yaw = level_enough ? std::atan2(-forward.x, -forward.z) : 0.0f;
    return {glm::angleAxis(yaw, glm::vec3(0, 1, 0)), head.position};
}

}  // namespace

Session::Session(std::shared_ptr<Instance> instance, std::unique_ptr<GraphicsDevice> graphics)
    : Object(ObjectType::session),
      instance_(std::move(instance)),
      graphics_(std::move(graphics)),
      world_from_local_(levelled(instance_->host().headset().head->pose_at(instance_->host().clock().now()).pose)),
      input_(*instance_) {}

RuntimeHost& Session::host() const { return instance_->host(); }

bool Session::focused() const {
    std::lock_guard lock(mutex_);
    return state_ == XR_SESSION_STATE_FOCUSED;
}

void Session::retire() {
    {
        std::lock_guard lock(mutex_);
        retired_ = true;
        if (running_) {
            drop_frames();
            running_ = false;
            host().frames().end_session();
        }
        frame_begun_.notify_all();
    }
    instance_->events().forget(xr());
    instance_->debug().forget_session(handle());
    instance_->free_session();
}

void Session::enter(XrSessionState state) {
    if (state_ == XR_SESSION_STATE_FOCUSED) input_.release_all();
    state_ = state;
    const XrEventDataSessionStateChanged event{XR_TYPE_EVENT_DATA_SESSION_STATE_CHANGED, nullptr, xr(), state, host().clock().now()};
    instance_->events().push(xr(), event);
}

void Session::announce() {
    std::lock_guard lock(mutex_);
    enter(XR_SESSION_STATE_IDLE);
    enter(XR_SESSION_STATE_READY);
}

Outcome Session::begin(XrViewConfigurationType views) {
    std::lock_guard lock(mutex_);
    if (running_) return error(XR_ERROR_SESSION_RUNNING, "the session runs already");
    if (state_ != XR_SESSION_STATE_READY || retired_) {
        return error(XR_ERROR_SESSION_NOT_READY, "the session is not in XR_SESSION_STATE_READY; wait for that event");
    }
    running_ = true;
    views_ = views;
    ++run_;
    host().frames().begin_session();
    if (PresenceSource* presence = host().headset().presence) tell_presence(presence->user_present());
    if (!graphics_) {
        for (const auto state : {XR_SESSION_STATE_SYNCHRONIZED, XR_SESSION_STATE_VISIBLE, XR_SESSION_STATE_FOCUSED}) enter(state);
    }
    return XR_SUCCESS;
}

XrViewConfigurationType Session::view_configuration() const {
    std::lock_guard lock(mutex_);
    return views_;
}

void Session::tell_presence(bool present) {
    told_presence_ = present;
    if (!instance_->enabled(XR_EXT_USER_PRESENCE_EXTENSION_NAME)) return;
    const XrEventDataUserPresenceChangedEXT event{XR_TYPE_EVENT_DATA_USER_PRESENCE_CHANGED_EXT, nullptr, xr(), XrBool32(present)};
    instance_->events().push(xr(), event);
}

void Session::follow_host() {
    PresenceSource* presence = host().headset().presence;
    const bool present = presence && presence->user_present();
    std::lock_guard lock(mutex_);
    if (!running_) return;
    if (presence && told_presence_ != present) tell_presence(present);
    if (!exiting_ && host().frames().exit_wanted()) stop();
}

void Session::drop_frames() {
    if (begun_) host().frames().discard_frame(begun_->frame_id);
    begun_.reset();
    waited_.reset();
}

Outcome Session::end() {
    std::lock_guard lock(mutex_);
    if (!running_) return not_running();
    if (state_ != XR_SESSION_STATE_STOPPING) {
        return error(XR_ERROR_SESSION_NOT_STOPPING, "call xrRequestExitSession and wait for XR_SESSION_STATE_STOPPING first");
    }
    drop_frames();
    running_ = false;
    host().frames().end_session();
    frame_begun_.notify_all();
    enter(XR_SESSION_STATE_IDLE);
    if (exiting_) enter(XR_SESSION_STATE_EXITING);
    return XR_SUCCESS;
}

// All steps down at once: every state between is told, as the state machine of the specification asks.
void Session::stop() {
    exiting_ = true;
    if (state_ == XR_SESSION_STATE_STOPPING) return;
    if (state_ == XR_SESSION_STATE_READY) enter(XR_SESSION_STATE_SYNCHRONIZED);
    if (state_ == XR_SESSION_STATE_FOCUSED) enter(XR_SESSION_STATE_VISIBLE);
    if (state_ == XR_SESSION_STATE_VISIBLE) enter(XR_SESSION_STATE_SYNCHRONIZED);
    enter(XR_SESSION_STATE_STOPPING);
}

Outcome Session::request_exit() {
    std::lock_guard lock(mutex_);
    if (!running_) return not_running();
    stop();
    return XR_SUCCESS;
}

void Session::advance_after_frame() {
    if (state_ == XR_SESSION_STATE_READY) {
        enter(XR_SESSION_STATE_SYNCHRONIZED);
        enter(XR_SESSION_STATE_VISIBLE);
    } else if (state_ == XR_SESSION_STATE_VISIBLE && !exiting_) {
        enter(XR_SESSION_STATE_FOCUSED);
    }
}

Outcome Session::wait_frame(XrFrameState& state) {
    FrameTiming timing;
    {
        std::unique_lock lock(mutex_);
        if (!running_) return not_running();
        const std::uint64_t run = run_;
        frame_begun_.wait(lock, [&] { return !running_ || run_ != run || (!waited_ && !waiting_); });
        if (!running_ || run_ != run) return not_running();
        waiting_ = true;
        lock.unlock();
        timing = host().frames().wait_frame();
        lock.lock();
        waiting_ = false;
        frame_begun_.notify_all();
        if (!running_ || run_ != run) return not_running();
        waited_ = timing;
        state.shouldRender = timing.should_render && renders() ? XR_TRUE : XR_FALSE;
    }
    state.predictedDisplayTime = timing.predicted_display_time;
    state.predictedDisplayPeriod = timing.period;
    follow_host();
    return XR_SUCCESS;
}

Outcome Session::begin_frame() {
    std::lock_guard lock(mutex_);
    if (!running_) return not_running();
    if (!waited_) return error(XR_ERROR_CALL_ORDER_INVALID, "no frame has been waited for; call xrWaitFrame before each xrBeginFrame");
    const bool discarded = begun_.has_value();
    if (discarded) host().frames().discard_frame(begun_->frame_id);
    begun_ = waited_;
    waited_.reset();
    host().frames().begin_frame(begun_->frame_id);
    frame_begun_.notify_all();
    return discarded ? XR_FRAME_DISCARDED : XR_SUCCESS;
}

Outcome Session::end_frame(const std::function<Outcome(FrameSubmission&)>& resolve) {
    const auto not_begun = [] { return error(XR_ERROR_CALL_ORDER_INVALID, "no frame is begun; call xrBeginFrame before xrEndFrame"); };
    FrameSubmission submission;
    {
        std::lock_guard lock(mutex_);
        if (!running_) return not_running();
        if (!begun_) return not_begun();
        submission.frame_id = begun_->frame_id;
    }
    ENTOPTIC_XR_TRY(resolve(submission));
    {
        std::lock_guard lock(mutex_);
        if (!running_) return not_running();
        if (!begun_ || begun_->frame_id != submission.frame_id) return not_begun();
        begun_.reset();
        host().frames().submit_frame(std::move(submission));
        advance_after_frame();
    }
    follow_host();
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime
