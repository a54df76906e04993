// Both eye cameras as one eye tracker: a thread an eye keeps its camera open, whatever is plugged, unplugged or broken, and feeds the common
// filter. The frame never waits for any of it.
#pragma once

#include "base/time.h"
#include "drivers/eye_tracking/eye_filter.h"
#include "drivers/pupil_labs/eye_processor.h"
#include "drivers/v4l2_camera/v4l2_camera.h"
#include "interfaces/sources.h"

#include <array>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

namespace entoptic::drivers {

// How to reach a camera that the kernel's driver cannot open for want of room on the bus.
using BypassCamera = std::function<CameraResult<std::unique_ptr<FrameStream>>(const std::string& product, const CameraMode& mode)>;

// Hears of every picture before anything looks at it, on its camera's thread; `arrival` is the tracker's clock.
using PictureTap =
    std::function<void(int eye, const std::string& product, const CameraMode& mode, const CompressedFrame& frame, TimeNs arrival)>;

struct PupilLabsOptions {
    CameraMode mode{192, 192, 200};
    EyeFilterParameters filter;
    VideoSystem* video = nullptr;  // null: the machine's own
    BypassCamera bypass;           // empty: none
    PictureTap tap;                // empty: none
    DurationNs retry = 1'000'000'000;
};

// Of one eye's pictures, since its camera was opened last.
struct EyeCameraCounts {
    CameraCounts camera;  // on the way from the camera
    EyeCounts pictures;   // and what was in them
};

// Which eye a product's name belongs to: "... ID0" is the right eye (1), "... ID1" the left (0); none for other cameras.
std::optional<int> eye_of(const std::string& product);

class PupilLabsTracker final : public EyeSource {
public:
    // `clock` must be CLOCK_MONOTONIC's (the kernel stamps pictures with it) and outlive the tracker.
    PupilLabsTracker(Clock& clock, PupilLabsOptions options);
    ~PupilLabsTracker() override;

    Observer observer_at(TimeNs time) override;
    std::optional<RawEyeSample> raw_at(int eye, TimeNs time) override;
    bool present() const override;
    std::string description() const override;

    // Of one eye: pictures lost on the way and dropped, as words for the user; and why there is no camera.
    std::string camera_status(int eye) const;
    EyeCameraCounts counts(int eye) const;

private:
    struct Eye {
        std::thread thread;
        std::string state = "not looked for yet";  // why there are no pictures; empty: there are
        std::string product, note;                 // note: what the user should know though it works
        EyeCameraCounts counts;
        CameraMode mode;
        bool modelled = false;
    };

    void run(int eye);
    CameraResult<std::unique_ptr<FrameStream>> open(int eye);
    CameraError stream(int eye, FrameStream& camera);
    void set_up(FrameStream& camera);
    void adjust_exposure(FrameStream& camera, const EyeProcessor& processor, int& exposure);
    void publish(int eye, const FrameStream& camera, const EyeProcessor& processor);
    void give(int eye, RawEyeSample sample);
    bool stopping() const;
    void set_state(int eye, const std::string& state);

    Clock& clock_;
    PupilLabsOptions options_;
    VideoSystem& video_;
    EyeFilter filter_;
    mutable std::mutex mutex_;  // of what follows
    std::condition_variable wake_;
    bool stop_ = false;
    bool ever_opened_ = false;
    TimeNs newest_arrival_ = 0;
    std::array<Eye, 2> eyes_;
    std::mutex opening_;  // opening and closing are serialised over the cameras (facts/devices.md 3.4)
};

}  // namespace entoptic::drivers
