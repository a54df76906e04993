#include "drivers/pupil_labs/pupil_labs_tracker.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <linux/v4l2-controls.h>

namespace entoptic::drivers {

namespace {

constexpr int wait_ms = 100;                          // for a picture, so that stopping is quick
constexpr DurationNs no_picture_for = 4'000'000'000;  // a camera that got no bandwidth is silent (facts/devices.md 3.4): open it anew
constexpr int most_striped = 10;                      // pictures in a row: restart the stream
constexpr std::uint64_t exposure_every = 100;         // pictures: a control takes 50 to 100 ms
const char* const side_names[2] = {"left", "right"};

std::size_t index(int eye) { return static_cast<std::size_t>(eye); }

}  // namespace

std::optional<int> eye_of(const std::string& product) {
    if (product.rfind("Pupil Cam", 0) != 0) return std::nullopt;
    if (product.ends_with("ID0")) return 1;
    if (product.ends_with("ID1")) return 0;
    return std::nullopt;
}

PupilLabsTracker::PupilLabsTracker(Clock& clock, PupilLabsOptions options)
    : clock_(clock),
      options_(std::move(options)),
      video_(options_.video ? *options_.video : linux_video_system()),
      filter_(options_.filter) {
    for (int eye = 0; eye < 2; ++eye) eyes_[index(eye)].thread = std::thread([this, eye] { run(eye); });
}

PupilLabsTracker::~PupilLabsTracker() {
    {
        const std::lock_guard lock(mutex_);
        stop_ = true;
    }
    wake_.notify_all();
    for (Eye& eye : eyes_) eye.thread.join();
}

bool PupilLabsTracker::stopping() const {
    const std::lock_guard lock(mutex_);
    return stop_;
}

void PupilLabsTracker::set_state(int eye, const std::string& state) {
    const std::lock_guard lock(mutex_);
    eyes_[index(eye)].state = state;
}

void PupilLabsTracker::run(int eye) {
    while (!stopping()) {
        if (auto camera = open(eye)) {
            const CameraError ended = stream(eye, **camera);
            set_state(eye, ended.message);
            const std::lock_guard closing(opening_);
            camera->reset();
        } else {
            set_state(eye, camera.error().message);
        }
        std::unique_lock lock(mutex_);
        wake_.wait_for(lock, std::chrono::nanoseconds(options_.retry), [this] { return stop_; });
    }
}

CameraResult<std::unique_ptr<FrameStream>> PupilLabsTracker::open(int eye) {
    const std::lock_guard opening(opening_);
    const auto nodes = find_cameras(video_);
    const auto node = std::find_if(nodes.begin(), nodes.end(), [&](const CameraNode& n) { return eye_of(n.name) == eye; });
    if (node == nodes.end())
        return tl::make_unexpected(
            CameraError{CameraFault::gone, fmt::format("no camera \"Pupil Cam... ID{}\" is plugged in", eye == 1 ? 0 : 1)});
    std::string note;
    CameraResult<std::unique_ptr<FrameStream>> camera = V4l2Camera::open(video_, *node, options_.mode);
    if (!camera && camera.error().fault == CameraFault::no_bandwidth && options_.bypass) {
        note = "through libusb, because the kernel's driver finds no room for it on the bus";
        const std::string why = camera.error().message;
        camera = options_.bypass(node->name, options_.mode);
        if (!camera) return tl::make_unexpected(CameraError{camera.error().fault, why + " That was tried: " + camera.error().message});
    }
    if (!camera) return camera;
    set_up(**camera);
    const std::lock_guard lock(mutex_);
    Eye& e = eyes_[index(eye)];
    e.state.clear();
    e.product = node->name;
    e.note = note;
    e.mode = (*camera)->mode();
    ever_opened_ = true;
    return camera;
}

// Automatic switches first, then the values they own (facts/devices.md 3.3). Cameras without a control keep what they have.
void PupilLabsTracker::set_up(FrameStream& camera) {
    camera.set_control(V4L2_CID_EXPOSURE_AUTO_PRIORITY, 0);
    camera.set_control(V4L2_CID_EXPOSURE_AUTO, V4L2_EXPOSURE_MANUAL);
    camera.set_control(V4L2_CID_SATURATION, 0);
    camera.set_control(V4L2_CID_GAMMA, 200);
    camera.set_control(V4L2_CID_EXPOSURE_ABSOLUTE, next_exposure(32, 120, camera.mode().rate_hz));
}

void PupilLabsTracker::adjust_exposure(FrameStream& camera, const EyeProcessor& processor, int& exposure) {
    const int wanted = next_exposure(exposure, processor.mean_level(), camera.mode().rate_hz);
    if (wanted == exposure) return;
    if (camera.set_control(V4L2_CID_EXPOSURE_ABSOLUTE, wanted)) exposure = wanted;
}

void PupilLabsTracker::publish(int eye, const FrameStream& camera, const EyeProcessor& processor) {
    const std::lock_guard lock(mutex_);
    Eye& e = eyes_[index(eye)];
    e.counts = {camera.counts(), processor.counts()};
    e.modelled = processor.model().fitted();
}

// The filter wants arrivals that never go back over both eyes: the clock is read and the sample given under one lock.
void PupilLabsTracker::give(int eye, RawEyeSample sample) {
    const std::lock_guard lock(mutex_);
    sample.arrival = std::max(newest_arrival_, clock_.now());
    newest_arrival_ = sample.arrival;
    sample.time = std::min(sample.time, sample.arrival);
    filter_.add(eye, sample);
}

CameraError PupilLabsTracker::stream(int eye, FrameStream& camera) {
    std::string product;
    {
        const std::lock_guard lock(mutex_);
        product = eyes_[index(eye)].product;
    }
    EyeProcessor processor(eye, pupil_labs_camera(product, camera.mode().width, camera.mode().height));
    int exposure = next_exposure(32, 120, camera.mode().rate_hz);
    TimeNs newest_picture = clock_.now();
    while (!stopping()) {
        const auto frame = camera.next(wait_ms);
        if (!frame) return frame.error();
        if (!*frame) {
            if (clock_.now() - newest_picture > no_picture_for)
                return {CameraFault::broken, fmt::format("{} sends no pictures; opening it anew", product)};
            continue;
        }
        newest_picture = clock_.now();
        if (options_.tap) options_.tap(eye, product, camera.mode(), **frame, newest_picture);
        if (const auto sample = processor.process(**frame, newest_picture)) give(eye, *sample);
        publish(eye, camera, processor);
        if (processor.striped_in_a_row() >= most_striped)
            if (const auto again = camera.restart(); !again) return again.error();
        if (processor.counts().pictures % exposure_every == 0) adjust_exposure(camera, processor, exposure);
    }
    return {};
}

Observer PupilLabsTracker::observer_at(TimeNs time) { return filter_.observer_at(clock_.now(), time); }

std::optional<RawEyeSample> PupilLabsTracker::raw_at(int eye, TimeNs time) { return filter_.raw_at(eye, time); }

bool PupilLabsTracker::present() const {
    const std::lock_guard lock(mutex_);
    return ever_opened_;
}

std::string PupilLabsTracker::camera_status(int eye) const {
    const std::lock_guard lock(mutex_);
    const Eye& e = eyes_[index(eye)];
    if (!e.state.empty()) return e.state;
    std::string text = fmt::format("{}, {} x {} at {:.0f} Hz{}{}", e.product, e.mode.width, e.mode.height, e.mode.rate_hz,
                                   e.note.empty() ? "" : ", ", e.note);
    text += fmt::format("; {} pictures, {} lost, {} corrupt, {} striped", e.counts.camera.frames, e.counts.camera.lost,
                        e.counts.camera.corrupt + e.counts.pictures.corrupt, e.counts.pictures.striped);
    if (!e.modelled) text += "; look around: the eye's model needs different directions";
    return text;
}

EyeCameraCounts PupilLabsTracker::counts(int eye) const {
    const std::lock_guard lock(mutex_);
    return eyes_[index(eye)].counts;
}

std::string PupilLabsTracker::description() const {
    return fmt::format("Pupil Labs eye cameras ({}); {}: {}; {}: {}", filter_.status(clock_.now()), side_names[0], camera_status(0),
                       side_names[1], camera_status(1));
}

}  // namespace entoptic::drivers
