// From one camera's compressed pictures to raw samples of one eye: decode, check, find the pupil, ask the eye's model.
#pragma once

#include "base/gray_image_io.h"
#include "drivers/pupil_labs/eye_model.h"
#include "drivers/pupil_labs/pupil_detector.h"
#include "drivers/v4l2_camera/frame_stream.h"
#include "interfaces/observer.h"

#include <cstdint>
#include <optional>
#include <string>

namespace entoptic::drivers {

// Of a Pupil Labs camera at one size, from its product's name ("Pupil Cam2 ID0"): Pupil Labs' published pinhole constants (facts/devices.md 3.2);
// sizes without one are scaled from the nearest.
PinholeCamera pupil_labs_camera(const std::string& product, int width, int height);

// True when rows jump from one to the next far more than columns do: a picture whose lines were mixed up on the way. Any size.
bool is_striped(GrayView image);

// Turns optical axes in camera coordinates into head coordinates without knowing how the camera sits: where the eye looks on average is
// straight ahead, and the camera's up is up. Good to some degrees; a calibration takes the rest (eye_tracking/gaze_calibration.h).
class RestingDirection {
public:
    explicit RestingDirection(bool upside_down) : up_(0, upside_down ? 1 : -1, 0) {}
    // `seconds` since the last call. Unit vector, head coordinates (x right, y up, -z forward).
    Eigen::Vector3d head_direction(const Eigen::Vector3d& optical_axis, double seconds);

private:
    Eigen::Vector3d up_, mean_{0, 0, 0};
    double weight_ = 0;
};

struct EyeCounts {
    std::uint64_t pictures = 0, corrupt = 0, striped = 0, with_pupil = 0;
};

class EyeProcessor {
public:
    // `eye`: 0 left, 1 right (whose camera is mounted upside down, facts/devices.md 3.6).
    EyeProcessor(int eye, const PinholeCamera& camera);

    // None for a picture that is corrupt or striped. A sample without a pupil or before the model is ready has no direction and no diameter
    // (NaN, never zero), and the confidence of what was seen. `arrival`: when the picture came.
    std::optional<RawEyeSample> process(const CompressedFrame& frame, TimeNs arrival);

    const EyeCounts& counts() const { return counts_; }
    const EyeModel& model() const { return model_; }
    int striped_in_a_row() const { return striped_in_a_row_; }
    double mean_level() const { return mean_level_; }  // of the newest picture, grey levels, its middle weighing most

private:
    RawEyeSample sample_of(const PupilDetection& pupil, TimeNs time, TimeNs arrival);

    JpegLumaDecoder decoder_;
    Image8 image_;
    PupilDetector detector_;
    EyeModel model_;
    RestingDirection rest_;
    EyeCounts counts_;
    TimeNs newest_ = 0;
    int striped_in_a_row_ = 0;
    double mean_level_ = 0;
};

// The exposure (in the camera's steps of 100 us) that brings `mean_level` towards the middle of 90 to 150 grey levels, a third of the way at
// a time; `present` inside that range. 1 to 10000 / rate (facts/devices.md 3.3).
int next_exposure(int present, double mean_level, double rate_hz);

}  // namespace entoptic::drivers
