// A RuntimeHost for tests: scripted sources, a virtual (or the monotonic) clock, the fake frame service. Header-only, not in the library.
#pragma once

#include "interfaces/runtime_host.h"
#include "runtime/testing/fake_frame_service.h"

#include <functional>
#include <mutex>
#include <vector>

namespace entoptic::runtime::testing {

// A head that moves as a function of time says; at rest 1.2 m above the floor by default.
class FakePoseSource final : public PoseSource {
public:
    PoseState pose_at(TimeNs time) override {
        std::lock_guard lock(mutex);
        return script ? script(time) : still();
    }
    static PoseState still() {
        PoseState state;
        state.pose.position = {0, 1.2f, 0};  // seated
        state.orientation_valid = state.position_valid = state.orientation_tracked = state.position_tracked = state.velocity_valid = true;
        return state;
    }
    std::mutex mutex;
    std::function<PoseState(TimeNs)> script;
};

class FakeEyeSource final : public EyeSource {
public:
    Observer observer_at(TimeNs time) override {
        std::lock_guard lock(mutex);
        Observer observer = state;
        observer.time = time;
        return observer;
    }
    std::optional<RawEyeSample> raw_at(int eye, TimeNs) override {
        std::lock_guard lock(mutex);
        return raw[static_cast<std::size_t>(eye)];
    }
    bool present() const override { return is_present; }
    std::string description() const override { return "fake"; }
    std::mutex mutex;
    Observer state;
    std::array<std::optional<RawEyeSample>, 2> raw;
    bool is_present = true;
};

class FakeController final : public ControllerSource {
public:
    struct Vibration {
        TimeNs time;
        DurationNs duration;
        float frequency, amplitude;
    };
    FakeController() {
        state.active = true;
        state.grip = state.aim = FakePoseSource::still();
    }
    ControllerState state_at(TimeNs) override {
        std::lock_guard lock(mutex);
        return state;
    }
    void vibrate(TimeNs time, DurationNs duration, float frequency, float amplitude) override {
        std::lock_guard lock(mutex);
        vibrations.push_back({time, duration, frequency, amplitude});
    }
    void change(const std::function<void(ControllerState&)>& edit) {
        std::lock_guard lock(mutex);
        edit(state);
    }
    std::mutex mutex;
    ControllerState state;
    std::vector<Vibration> vibrations;
};

class FakeHost final : public RuntimeHost {
public:
    explicit FakeHost(bool real_time = false) : real_time_(real_time), service(clock()) {
        for (int eye = 0; eye < 2; ++eye) {
            const float side = eye == 0 ? -1.0f : 1.0f;
            headset_.eyes[static_cast<std::size_t>(eye)].head_from_eye.position = {side * 0.0315f, 0, 0};
            headset_.eyes[static_cast<std::size_t>(eye)].fov = {-0.9f, 0.9f, 0.9f, -0.9f};
        }
        headset_.display.name = "Fake headset";
        headset_.head = &head;
        headset_.eye_tracker = &eyes;
        headset_.controllers = {&left, &right};
        current() = this;
    }
    ~FakeHost() override {
        if (current() == this) current() = nullptr;
    }

    Headset& headset() override { return headset_; }
    Clock& clock() override { return real_time_ ? static_cast<Clock&>(monotonic_) : virtual_clock; }
    bool lockstep() const override { return !real_time_; }
    Clock& stopwatch() override { return monotonic_; }
    FrameService& frames() override { return service; }
    LayerLuminance default_luminance() const override { return luminance; }
    std::array<double, 2> resolved_angles_rad() const override { return {0.5e-3, 0.25e-3}; }
    void recommended_eye_size(std::uint32_t& width, std::uint32_t& height) const override {
        width = 256;
        height = 288;
    }
    Quirks quirks() const override { return application_quirks; }
    void report_error(const std::string& message) override {
        std::lock_guard lock(mutex_);
        errors.push_back(message);
    }

    // The host of the instance created last.
    static FakeHost*& current() {
        static FakeHost* host = nullptr;
        return host;
    }
    static Result<std::unique_ptr<RuntimeHost>> make(const ApplicationIdentity& application) {
        auto host = std::make_unique<FakeHost>();
        host->application = application;
        return std::unique_ptr<RuntimeHost>(std::move(host));
    }
    static Result<std::unique_ptr<RuntimeHost>> make_real_time(const ApplicationIdentity& application) {
        auto host = std::make_unique<FakeHost>(true);
        host->application = application;
        return std::unique_ptr<RuntimeHost>(std::move(host));
    }

private:
    const bool real_time_;
    MonotonicClock monotonic_;
    Headset headset_;
    std::mutex mutex_;

public:
    VirtualClock virtual_clock;
    FakePoseSource head;
    FakeEyeSource eyes;
    FakeController left, right;
    LayerLuminance luminance{129.96f, 0.04f, LuminanceSource::default_sdr};
    ApplicationIdentity application;
    std::vector<std::string> errors;
    Quirks application_quirks;
    FakeFrameService service;
};

}  // namespace entoptic::runtime::testing
