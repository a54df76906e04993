#include "drivers/pupil_labs/eye_model.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace entoptic::drivers {

namespace {

constexpr int outline_points = 8;                                         // of a modelled pupil; an ellipse has five numbers
constexpr std::uint64_t improve_every = 20, improve_settled_every = 200;  // pictures
constexpr int settled_steps = 40;
constexpr std::size_t most_directions = 60;  // remembered; the oldest goes
constexpr int steps_to_settle = 6;           // improvements before a new model is used
constexpr double widest_angle = 80 * M_PI / 180;
constexpr double largest_residual_px = 3;  // an ellipse farther from any pupil of this eye is something else

using Residuals = Eigen::Matrix<double, outline_points, 1>;

Eigen::Vector3d axis_of(const Eigen::Vector2d& angles) {
    const double c = std::cos(angles.y());
    return {std::sin(angles.x()) * c, std::sin(angles.y()), -std::cos(angles.x()) * c};
}

Eigen::Vector2d angles_of(const Eigen::Vector3d& axis) {
    return {std::atan2(axis.x(), -axis.z()), std::asin(std::clamp(axis.y(), -1.0, 1.0))};
}

// Signed distance of a point to an ellipse, px: exact on it, first order near it.
class DistanceToEllipse {
public:
    explicit DistanceToEllipse(const Ellipse& e)
        : x_(e.x), y_(e.y), cos_(std::cos(e.angle)), sin_(std::sin(e.angle)), a_(0.5 * e.major), b_(0.5 * e.minor) {}
    double operator()(const Eigen::Vector2d& p) const {
        const double u = (cos_ * (p.x() - x_) + sin_ * (p.y() - y_)) / a_, v = (-sin_ * (p.x() - x_) + cos_ * (p.y() - y_)) / b_;
        const double r = std::sqrt(u * u + v * v), slope = std::sqrt(u * u / (a_ * a_) + v * v / (b_ * b_));
        return slope > 1e-9 ? (r - 1) * r / slope : -b_;
    }

private:
    double x_, y_, cos_, sin_, a_, b_;
};

struct Unknowns {
    Eigen::Vector2d angles;
    double radius;
};

bool residuals_of(const EyeModelParameters& p, const DistanceToEllipse& distance, const Eigen::Vector3d& centre, const Unknowns& x,
                  Residuals& out) {
    std::array<Eigen::Vector2d, outline_points> points;
    if (!pupil_outline(p.camera, p.eye, {centre, axis_of(x.angles), x.radius}, points)) return false;
    for (int i = 0; i < outline_points; ++i) out[i] = distance(points[static_cast<std::size_t>(i)]);
    return true;
}

bool sensible(const Unknowns& x) {
    return std::abs(x.angles.x()) < widest_angle && std::abs(x.angles.y()) < widest_angle && x.radius > 0.3 && x.radius < 5.5;
}

constexpr double angle_step = 1e-5, length_step = 1e-4;

// Columns: two angles, radius.
bool jacobian_of(const EyeModelParameters& p, const DistanceToEllipse& distance, const Eigen::Vector3d& centre, const Unknowns& x,
                 const Residuals& at, Eigen::Matrix<double, outline_points, 3>& out) {
    Residuals moved;
    for (int k = 0; k < 3; ++k) {
        Unknowns y = x;
        (k < 2 ? y.angles[k] : y.radius) += k < 2 ? angle_step : length_step;
        if (!residuals_of(p, distance, centre, y, moved)) return false;
        out.col(k) = (moved - at) / (k < 2 ? angle_step : length_step);
    }
    return true;
}

// Levenberg and Marquardt on direction and radius of one picture. Returns the mean square residual, px²; none when it does not settle.
std::optional<double> fit_picture(const EyeModelParameters& p, const Ellipse& ellipse, const Eigen::Vector3d& centre, int most_steps,
                                  Unknowns& x) {
    const DistanceToEllipse distance(ellipse);
    Residuals r, next_r;
    if (!sensible(x) || !residuals_of(p, distance, centre, x, r)) return std::nullopt;
    double damping = 1e-3;
    Eigen::Matrix<double, outline_points, 3> j;
    for (int i = 0; i < most_steps; ++i) {
        if (!jacobian_of(p, distance, centre, x, r, j)) return std::nullopt;
        Eigen::Matrix3d normal = j.transpose() * j;
        normal.diagonal() *= 1 + damping;
        const Eigen::Vector3d step = -normal.ldlt().solve(j.transpose() * r);
        const Unknowns next{x.angles + step.head<2>(), x.radius + step[2]};
        if (!sensible(next) || !residuals_of(p, distance, centre, next, next_r) || next_r.squaredNorm() > r.squaredNorm()) {
            damping *= 10;
            if (damping > 1e4) break;
            continue;
        }
        const double gain = r.squaredNorm() - next_r.squaredNorm();
        x = next;
        r = next_r;
        damping = std::max(1e-6, 0.1 * damping);
        if (gain < 1e-7 || step.squaredNorm() < 1e-12) break;
    }
    return r.squaredNorm() / outline_points;
}

// Where the pupil's centre would be on the sphere around `centre`, without refraction: the nearer crossing of the ray through the ellipse's centre.
std::optional<Unknowns> first_guess(const EyeModelParameters& p, const Ellipse& ellipse, const Eigen::Vector3d& centre) {
    // The image of the pupil lies a little before the pupil: about half a millimetre.
    const double radius = p.eye.pupil_distance_mm + 0.5;
    const Eigen::Vector3d ray = p.camera.direction(ellipse.x, ellipse.y);
    const double along = ray.dot(centre), miss = along * along - centre.squaredNorm() + radius * radius;
    const Eigen::Vector3d pupil = (along - std::sqrt(std::max(0.0, miss))) * ray;
    const Unknowns x{angles_of((pupil - centre).normalized()),
                     0.5 * ellipse.major / p.camera.focal_px * pupil.norm() / p.eye.entrance_magnification()};
    return sensible(x) ? std::optional(x) : std::nullopt;
}

}  // namespace

EyeModel::EyeModel(const EyeModelParameters& parameters) : parameters_(parameters), centre_(0, 0, parameters.expected_depth_mm) {}

void EyeModel::observe(const Ellipse& ellipse, double confidence) {
    ++pictures_;
    if (!(confidence >= parameters_.min_confidence)) return;
    remember(ellipse, confidence);
    if (pictures_ % (steps_ < settled_steps ? improve_every : improve_settled_every) != 0) return;
    forget();
    if (memory_.size() < parameters_.min_directions) return;
    if (!spread_enough()) return;
    if (steps_ == 0 && !start()) return;
    if (!improve()) {
        steps_ = 0;
        fitted_ = false;
        return;
    }
    ++steps_;
    fitted_ = steps_ >= steps_to_settle && residual_px_ < largest_residual_px;
}

// One place for every direction, told by where in the picture the ellipse is: the sphere's own angles need a model first.
void EyeModel::remember(const Ellipse& ellipse, double confidence) {
    const double pixels =
        parameters_.bin_deg * M_PI / 180 * parameters_.eye.pupil_distance_mm / parameters_.expected_depth_mm * parameters_.camera.focal_px;
    Observation seen;
    seen.ellipse = ellipse;
    seen.weight = confidence;
    seen.picture = pictures_;
    seen.bin = {static_cast<int>(std::floor(ellipse.x / pixels)), static_cast<int>(std::floor(ellipse.y / pixels))};
    const auto same = std::find_if(memory_.begin(), memory_.end(), [&](const Observation& o) { return o.bin == seen.bin; });
    if (same == memory_.end()) {
        if (steps_ > 0) {
            const auto guess = first_guess(parameters_, ellipse, centre_);
            if (!guess) return;
            seen.angles = guess->angles;
            seen.radius = guess->radius;
        }
        if (memory_.size() == most_directions)
            memory_.erase(std::min_element(memory_.begin(), memory_.end(),
                                           [](const Observation& a, const Observation& b) { return a.picture < b.picture; }));
        memory_.push_back(seen);
        return;
    }
    seen.angles = same->angles;
    seen.radius = same->radius;
    *same = seen;
}

void EyeModel::forget() {
    std::erase_if(memory_, [&](const Observation& o) { return pictures_ - o.picture > parameters_.forget_after; });
}

bool EyeModel::spread_enough() const {
    Eigen::Vector2d low(1e9, 1e9), high(-1e9, -1e9);
    for (const Observation& o : memory_) {
        low = low.cwiseMin(Eigen::Vector2d(o.ellipse.x, o.ellipse.y));
        high = high.cwiseMax(Eigen::Vector2d(o.ellipse.x, o.ellipse.y));
    }
    const double px_per_rad = parameters_.eye.pupil_distance_mm / parameters_.expected_depth_mm * parameters_.camera.focal_px;
    return (high - low).maxCoeff() >= parameters_.min_spread_deg * M_PI / 180 * px_per_rad;
}

// The centre in the picture: where the minor axes of the ellipses, which are the pictures of the pupils' normals, come nearest to each
// other (Swirski and Dodgson 2013). Rounder ellipses say less. Its distance is the expected one; improve() finds it.
bool EyeModel::start() {
    Eigen::Matrix2d normal = Eigen::Matrix2d::Identity() * 1e-3;
    Eigen::Vector2d right = 1e-3 * Eigen::Vector2d(parameters_.camera.centre_x, parameters_.camera.centre_y);
    for (const Observation& o : memory_) {
        const Eigen::Vector2d major(std::cos(o.ellipse.angle), std::sin(o.ellipse.angle));
        const double weight = o.weight * (1 - o.ellipse.axis_ratio());
        const Eigen::Matrix2d across = weight * major * major.transpose();  // distance from the line along the minor axis
        normal += across;
        right += across * Eigen::Vector2d(o.ellipse.x, o.ellipse.y);
    }
    const Eigen::Vector2d at = normal.ldlt().solve(right);
    const double z = parameters_.expected_depth_mm, f = parameters_.camera.focal_px;
    centre_ = {z * (at.x() - parameters_.camera.centre_x) / f, z * (at.y() - parameters_.camera.centre_y) / f, z};
    for (Observation& o : memory_) {
        const auto guess = first_guess(parameters_, o.ellipse, centre_);
        if (!guess) return false;
        o.angles = guess->angles;
        o.radius = guess->radius;
    }
    return true;
}

// One Gauss-Newton step on the centre with every picture's own unknowns eliminated (Schur complement), after these have been fitted.
bool EyeModel::improve() {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    double squares = 0, weights = 0;
    std::size_t used = 0;
    for (Observation& o : memory_) {
        Unknowns x{o.angles, o.radius};
        const auto mean_square = fit_picture(parameters_, o.ellipse, centre_, 3, x);
        if (!mean_square) continue;
        o.angles = x.angles;
        o.radius = x.radius;
        const DistanceToEllipse distance(o.ellipse);
        Residuals r, moved;
        Eigen::Matrix<double, outline_points, 3> own, of_centre;
        if (!residuals_of(parameters_, distance, centre_, x, r) || !jacobian_of(parameters_, distance, centre_, x, r, own)) continue;
        bool good = true;
        for (int k = 0; k < 3 && good; ++k) {
            Eigen::Vector3d c = centre_;
            c[k] += length_step;
            good = residuals_of(parameters_, distance, c, x, moved);
            of_centre.col(k) = (moved - r) / length_step;
        }
        if (!good) continue;
        const double weight = o.weight / (1 + *mean_square);  // Cauchy: an ellipse that never fits says little
        const Eigen::Matrix3d coupling = own.transpose() * of_centre;
        const Eigen::LDLT<Eigen::Matrix3d> inverse(own.transpose() * own);
        normal += weight * (of_centre.transpose() * of_centre - coupling.transpose() * inverse.solve(coupling));
        right += weight * (of_centre.transpose() * r - coupling.transpose() * inverse.solve(own.transpose() * r));
        squares += weight * *mean_square;
        weights += weight;
        ++used;
    }
    if (used < parameters_.min_directions) return false;
    // What is known of the distance beforehand, with an outline's noise of about a third of a pixel.
    const double prior = 0.1 / (parameters_.depth_sigma_mm * parameters_.depth_sigma_mm);
    normal(2, 2) += prior;
    right[2] += prior * (centre_.z() - parameters_.expected_depth_mm);
    normal.diagonal().array() += 1e-9 * normal.trace();
    Eigen::Vector3d step = -normal.ldlt().solve(right);
    if (!step.allFinite()) return false;
    const double length = step.norm();
    if (length > 4) step *= 4 / length;
    const Eigen::Vector3d next = centre_ + step;
    if (!(next.z() > 15 && next.z() < 90 && std::abs(next.x()) < 30 && std::abs(next.y()) < 30)) return false;
    centre_ = next;
    residual_px_ = std::sqrt(squares / weights);
    return true;
}

std::optional<EyeEstimate> EyeModel::estimate(const Ellipse& ellipse) const {
    if (!fitted_) return std::nullopt;
    auto x = first_guess(parameters_, ellipse, centre_);
    if (!x) return std::nullopt;
    const auto mean_square = fit_picture(parameters_, ellipse, centre_, 12, *x);
    if (!mean_square || *mean_square > largest_residual_px * largest_residual_px) return std::nullopt;
    const Eigen::Vector3d axis = axis_of(x->angles);
    return EyeEstimate{axis, centre_ + parameters_.eye.pupil_distance_mm * axis, 2 * x->radius * parameters_.eye.entrance_magnification(),
                       std::sqrt(*mean_square)};
}

}  // namespace entoptic::drivers
