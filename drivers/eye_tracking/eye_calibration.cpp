#include "drivers/eye_tracking/eye_calibration.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <set>
#include <vector>

namespace entoptic::drivers {

namespace {

constexpr double unit_deg = 20, wild_deg = 5, widest_deg = 75;
constexpr std::size_t fewest_pairs = 30, fewest_targets = 5;
constexpr double range_slack = 0.1;
// A look at the centre: 0.4 s is a long fixation; four fifths of it within 1.5 degrees, several times a tracker's noise. choice:
constexpr DurationNs look = 400'000'000, look_step = 1'000'000;
constexpr double restless_deg = 1.5, mostly = 0.8, largest_slip_deg = 20;
constexpr std::size_t fewest_looks = 5;
constexpr float sure = 0.8f;  // confidence of a sample that counts (facts/devices.md 4.6)

using Terms = Eigen::Matrix<double, GazeMap::terms, 1>;

Terms terms_of(GazeAngles a) {
    const double x = a.x / unit_deg, y = a.y / unit_deg;
    Terms t;
    t << 1, x, y, x * y, x * x, y * y;
    return t;
}

double sum(const std::array<double, GazeMap::terms>& weights, const Terms& terms) {
    double total = 0;
    for (std::size_t i = 0; i < GazeMap::terms; ++i) total += weights[i] * terms[static_cast<Eigen::Index>(i)];
    return total;
}

double angle_between(GazeAngles a, GazeAngles b) {
    const glm::dvec3 u = direction_of(a), v = direction_of(b);
    return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v)) * degrees_per_radian;
}

bool finite(GazeAngles a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::abs(a.x) < widest_deg && std::abs(a.y) < widest_deg; }

// The value that `share` of the others are below; NaN of nothing.
double quantile(std::vector<double> values, double share) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto at = values.begin() + static_cast<long>(share * static_cast<double>(values.size()));
    std::nth_element(values.begin(), at, values.end());
    return *at;
}
double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

bool is_direction(glm::dvec3 d) { return glm::length(d) > 0.5 && glm::length(d) < 2 && d.z < 0; }  // not so: NaN

glm::vec3 mapped(const std::optional<GazeMap>& map, glm::vec3 direction) {
    if (!map || !is_direction(direction)) return direction;  // NaN stays NaN
    return glm::normalize(glm::vec3(direction_of(map->apply(angles_of(direction)))));
}

float in_range(const std::optional<std::pair<double, double>>& range_mm, float diameter_mm) {
    if (!range_mm || !(diameter_mm > 0)) return diameter_mm;
    const auto [narrowest, widest] = *range_mm;
    return std::clamp(diameter_mm, static_cast<float>((1 - range_slack) * narrowest), static_cast<float>((1 + range_slack) * widest));
}

GazeMap solved(const std::vector<GazePair>& pairs) {
    // A pull as strong as a hundredth of the pairs for the linear terms, a thirtieth for the bends, on the change against the identity.
    const double n = static_cast<double>(pairs.size());
    Eigen::Matrix<double, GazeMap::terms, GazeMap::terms> normal = Eigen::Matrix<double, GazeMap::terms, GazeMap::terms>::Zero();
    Eigen::Matrix<double, GazeMap::terms, 2> right = Eigen::Matrix<double, GazeMap::terms, 2>::Zero();
    for (const GazePair& pair : pairs) {
        const Terms t = terms_of(pair.measured);
        normal += t * t.transpose();
        right.col(0) += t * (pair.target.x - pair.measured.x);
        right.col(1) += t * (pair.target.y - pair.measured.y);
    }
    for (int i = 0; i < 6; ++i) normal(i, i) += n * (i == 0 ? 1e-6 : i < 3 ? 1e-4 : 1e-3);
    const Eigen::Matrix<double, GazeMap::terms, 2> change = normal.ldlt().solve(right);
    GazeMap map;
    for (std::size_t i = 0; i < GazeMap::terms; ++i) {
        map.right[i] += change(static_cast<Eigen::Index>(i), 0);
        map.up[i] += change(static_cast<Eigen::Index>(i), 1);
    }
    return map;
}

}  // namespace

GazeAngles GazeMap::apply(GazeAngles measured) const {
    const Terms t = terms_of(measured);
    return {std::clamp(sum(right, t), -widest_deg, widest_deg), std::clamp(sum(up, t), -widest_deg, widest_deg)};
}

bool GazeMap::sensible() const {
    for (const double x : {-30.0, 0.0, 30.0}) {
        for (const double y : {-30.0, 0.0, 30.0}) {
            const Terms t = terms_of({x, y});
            const double dx = sum(right, t) - x, dy = sum(up, t) - y;
            if (!(std::hypot(dx, dy) <= 40)) return false;
        }
    }
    return true;
}

double median_error_deg(const GazeMap& map, std::span<const GazePair> pairs) {
    std::vector<double> errors;
    for (const GazePair& pair : pairs)
        if (finite(pair.measured)) errors.push_back(angle_between(map.apply(pair.measured), pair.target));
    return median(std::move(errors));
}

Result<GazeMap> fit_gaze_map(std::span<const GazePair> pairs) {
    std::vector<GazePair> good;
    std::set<std::pair<double, double>> targets;
    for (const GazePair& pair : pairs) {
        if (!finite(pair.measured) || !finite(pair.target)) continue;
        good.push_back(pair);
        targets.insert({std::round(pair.target.x), std::round(pair.target.y)});
    }
    if (good.size() < fewest_pairs || targets.size() < fewest_targets)
        return failure(fmt::format(
            "The eye was seen in {} pictures at {} targets; {} and {} are needed. Look at the target, and see that the cameras see your "
            "eyes (entoptic status).",
            good.size(), targets.size(), fewest_pairs, fewest_targets));
    // The median takes a constant error out before anything is called wild.
    GazeMap map = solved(good);
    std::vector<GazePair> kept;
    for (const GazePair& pair : good)
        if (angle_between(map.apply(pair.measured), pair.target) <= wild_deg) kept.push_back(pair);
    if (2 * kept.size() < good.size())
        return failure(
            "Most of the time the eye was not where the target was: nothing was learnt. Follow the target with your eyes and try again.");
    map = solved(kept);
    if (!map.sensible())
        return failure("The measured gaze does not follow the target. Check that the cameras are not swapped, and try again.");
    return map;
}

std::string CalibratedEyes::description() const { return source_.description() + (calibration().empty() ? "" : "; calibrated"); }

EyeCalibration CalibratedEyes::calibration() const {
    const std::lock_guard lock(mutex_);
    return calibration_;
}

Observer CalibratedEyes::observer_at(TimeNs time) {
    Observer observer = source_.observer_at(time);
    const EyeCalibration now = calibration();
    if (now.empty()) return observer;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        EyeState& state = observer.eyes[eye];
        // What is not measured is the filters' fallback, which needs no correction.
        if (state.gaze_provenance == Provenance::measured) state.gaze_direction = mapped(now.gaze[eye], state.gaze_direction);
        if (state.pupil_provenance == Provenance::measured) state.pupil_diameter_mm = in_range(now.pupil_range_mm, state.pupil_diameter_mm);
    }
    observer.gaze_direction = glm::normalize(observer.eyes[0].gaze_direction + observer.eyes[1].gaze_direction);
    return observer;
}

std::optional<RawEyeSample> CalibratedEyes::raw_at(int eye, TimeNs time) {
    auto sample = source_.raw_at(eye, time);
    if (sample) sample->gaze_direction = mapped(calibration().gaze[static_cast<std::size_t>(eye)], sample->gaze_direction);
    return sample;
}

// Where an eye rested in the time before `now`, as measured, without the calibration; none when it was hardly seen.
Result<std::optional<GazeAngles>> CalibratedEyes::fixation(int eye, TimeNs now) const {
    std::vector<double> right, up;
    TimeNs newest = now - look;
    for (TimeNs time = now - look; time <= now; time += look_step) {
        const auto raw = source_.raw_at(eye, time);
        if (!raw || raw->time <= newest) continue;
        newest = raw->time;
        if (!(raw->confidence >= sure) || !is_direction(raw->gaze_direction)) continue;
        const GazeAngles angles = angles_of(raw->gaze_direction);
        right.push_back(angles.x);
        up.push_back(angles.y);
    }
    if (right.size() < fewest_looks) return std::nullopt;
    const GazeAngles middle{median(right), median(up)};
    std::vector<double> distances;
    for (std::size_t i = 0; i < right.size(); ++i) distances.push_back(std::hypot(right[i] - middle.x, up[i] - middle.y));
    if (!(quantile(std::move(distances), mostly) <= restless_deg)) return failure("The eyes moved. Keep looking at the centre, and re-centre again.");
    return middle;
}

Result<std::array<std::optional<GazeAngles>, 2>> CalibratedEyes::recentre(TimeNs now, const std::array<GazeAngles, 2>& targets) {
    EyeCalibration changed = calibration();
    std::array<std::optional<GazeAngles>, 2> shifts;
    for (std::size_t eye = 0; eye < 2; ++eye) {
        ENTOPTIC_TRY(seen, fixation(static_cast<int>(eye), now));
        if (!seen) continue;
        GazeMap map = changed.gaze[eye].value_or(GazeMap{});
        const GazeAngles shift = targets[eye] - map.apply(*seen);
        map.right[0] += shift.x;
        map.up[0] += shift.y;
        if (glm::length(shift) > largest_slip_deg || !map.sensible())
            return failure(
                fmt::format("The gaze was {:.0f} degrees from the centre: the eye tracker has not slipped that far. Look at the centre and "
                            "re-centre again, or calibrate: entoptic calibrate gaze",
                            glm::length(shift)));
        changed.gaze[eye] = map;
        shifts[eye] = shift;
    }
    if (!shifts[0] && !shifts[1])
        return failure("Neither eye was seen well enough to re-centre. Keep them open, and see what the eye tracker says: entoptic status");
    const std::lock_guard lock(mutex_);
    calibration_ = changed;
    return shifts;
}

}  // namespace entoptic::drivers
