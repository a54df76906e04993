// What a person's calibration changes of an eye tracker's answers: where the eyes look, and between which widths their pupils move.
#pragma once

#include "base/result.h"
#include "drivers/eye_tracking/gaze_angles.h"
#include "interfaces/sources.h"

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <span>

namespace entoptic::drivers {

// From measured to true angles: a polynomial of the second degree in each axis (the terms 1, x, y, xy, x², y² of the 2-D calibration of
// facts/devices.md 4.6), x and y in units of 20 degrees.
struct GazeMap {
    static constexpr std::size_t terms = 6;
    std::array<double, terms> right{0, 20, 0, 0, 0, 0}, up{0, 0, 20, 0, 0, 0};  // degrees; this is the identity

    GazeAngles apply(GazeAngles measured) const;
    // Finite, and moves nothing within 30 degrees by more than 40.
    bool sensible() const;
};

struct GazePair {
    GazeAngles measured{0}, target{0};  // degrees
};

// Least squares with a weak pull to the identity (what few targets do not tell stays as it is), once more without the pairs that are more than
// 5 degrees off (a blink, a look elsewhere). Errors: fewer than 30 pairs or fewer than 5 different targets; most of the pairs wild.
Result<GazeMap> fit_gaze_map(std::span<const GazePair> pairs);

// Angle between where the map says and the target, degrees: the median over the pairs; NaN without any.
double median_error_deg(const GazeMap& map, std::span<const GazePair> pairs);

struct EyeCalibration {
    std::array<std::optional<GazeMap>, 2> gaze;               // left, right
    std::optional<std::pair<double, double>> pupil_range_mm;  // narrowest, widest of this person
    bool empty() const { return !gaze[0] && !gaze[1] && !pupil_range_mm; }
};

// `source`, whose answers go through the calibration: filtered gaze and raw samples alike; diameters outside the person's range (by more
// than a tenth) are brought back to it. `source` must outlive it. An empty calibration changes nothing.
class CalibratedEyes final : public EyeSource {
public:
    CalibratedEyes(EyeSource& source, EyeCalibration calibration) : source_(source), calibration_(std::move(calibration)) {}

    Observer observer_at(TimeNs time) override;
    std::optional<RawEyeSample> raw_at(int eye, TimeNs time) override;
    bool present() const override { return source_.present(); }
    std::string description() const override;

    // A tracker that slips on the face is off by about the same angle everywhere. The wearer looks at `targets` (of each eye): what was measured
    // in the 0.4 s before `now` means these from now on, in the calibrated eyes and in calibration(). Returns how far each eye's gaze has moved by
    // that, degrees; none for an eye that was not seen. Errors, and nothing changes: neither eye was seen; one moved; one was farther than
    // 20 degrees off, which is no slip.
    Result<std::array<std::optional<GazeAngles>, 2>> recentre(TimeNs now, const std::array<GazeAngles, 2>& targets);

    EyeCalibration calibration() const;

private:
    Result<std::optional<GazeAngles>> fixation(int eye, TimeNs now) const;

    EyeSource& source_;
    mutable std::mutex mutex_;
    EyeCalibration calibration_;
};

}  // namespace entoptic::drivers
