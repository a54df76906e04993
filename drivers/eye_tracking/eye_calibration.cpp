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
    if (errors.empty()) return std::numeric_limits<double>::quiet_NaN();
    const auto middle = errors.begin() + static_cast<long>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle;
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

glm::vec3 CalibratedEyes::mapped(std::size_t eye, glm::vec3 direction) const {
    const glm::dvec3 d = direction;
    if (!calibration_.gaze[eye] || !(glm::length(d) > 0.5 && glm::length(d) < 2) || d.z >= 0) return direction;  // NaN stays NaN
    return glm::normalize(glm::vec3(direction_of(calibration_.gaze[eye]->apply(angles_of(d)))));
}

float CalibratedEyes::in_range(float diameter_mm) const {
    if (!calibration_.pupil_range_mm || !(diameter_mm > 0)) return diameter_mm;
    const auto [narrowest, widest] = *calibration_.pupil_range_mm;
    return std::clamp(diameter_mm, static_cast<float>((1 - range_slack) * narrowest), static_cast<float>((1 + range_slack) * widest));
}

Observer CalibratedEyes::observer_at(TimeNs time) {
    Observer observer = source_.observer_at(time);
    for (std::size_t eye = 0; eye < 2; ++eye) {
        EyeState& state = observer.eyes[eye];
        // What is not measured is the filters' fallback, which needs no correction.
        if (state.gaze_provenance == Provenance::measured) state.gaze_direction = mapped(eye, state.gaze_direction);
        if (state.pupil_provenance == Provenance::measured) state.pupil_diameter_mm = in_range(state.pupil_diameter_mm);
    }
    observer.gaze_direction = glm::normalize(observer.eyes[0].gaze_direction + observer.eyes[1].gaze_direction);
    return observer;
}

std::optional<RawEyeSample> CalibratedEyes::raw_at(int eye, TimeNs time) {
    auto sample = source_.raw_at(eye, time);
    if (sample) sample->gaze_direction = mapped(static_cast<std::size_t>(eye), sample->gaze_direction);
    return sample;
}

}  // namespace entoptic::drivers
