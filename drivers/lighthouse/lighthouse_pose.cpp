#include "drivers/lighthouse/lighthouse_pose.h"

#include <Eigen/Dense>
#include <algorithm>
#include <ceres/ceres.h>
#include <ceres/rotation.h>
#include <fmt/format.h>
#include <memory>

namespace entoptic::drivers::lighthouse {

namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double bearing_scale = 1e-3;  // rad: residuals in units of a milliradian
constexpr double up_sd = 0.035;         // rad: the station's accelerometer has steps of 0.5 degrees, the head is not at rest
constexpr double accepted_rms = 4e-3;   // rad; real windows have 0.03 to 0.4 mrad
constexpr double nearest_m = 0.2, farthest_m = 12;
constexpr double least_noise = 5e-5;  // rad; repeatability of a sensor's bearing in recordings

// pose: angle-axis rotation and translation, station from body. velocity: m/s, station coordinates.
struct BearingCost {
    BearingCost(const Vector3d& sensor, const Bearing& bearing, const StationInfo& station)
        : sensor_(sensor), bearing_(bearing), station_(station) {}
    template <class T> bool operator()(const T* pose, const T* velocity, T* residual) const {
        const T in[3] = {T(sensor_.x()), T(sensor_.y()), T(sensor_.z())};
        T out[3];
        ceres::AngleAxisRotatePoint(pose, in, out);
        for (int i = 0; i < 3; ++i) out[i] += pose[3 + i] - velocity[i] * bearing_.age;
        residual[0] = (sweep_reading(bearing_.axis, out[0], out[1], out[2], station_) - bearing_.angle) / bearing_scale;
        return true;
    }
    Vector3d sensor_;
    Bearing bearing_;
    const StationInfo& station_;
};

struct VelocityCost {
    explicit VelocityCost(double sd) : sd_(sd) {}
    template <class T> bool operator()(const T* velocity, T* residual) const {
        for (int i = 0; i < 3; ++i) residual[i] = velocity[i] / sd_;
        return true;
    }
    double sd_;
};

// The body's axes where they are known to point.
struct TurnCost {
    TurnCost(const Quaterniond& turn, double sd) : axes_(turn.toRotationMatrix()), sd_(sd) {}
    template <class T> bool operator()(const T* pose, T* residual) const {
        for (int axis = 0; axis < 3; ++axis) {
            T in[3] = {T(axis == 0 ? 1 : 0), T(axis == 1 ? 1 : 0), T(axis == 2 ? 1 : 0)}, out[3];
            ceres::AngleAxisRotatePoint(pose, in, out);
            for (int i = 0; i < 3; ++i)
                residual[3 * axis + i] = (out[i] - axes_(i, axis)) / (sd_ * std::numbers::sqrt2);  // each angle moves two axes
        }
        return true;
    }
    Eigen::Matrix3d axes_;
    double sd_;
};

struct UpCost {
    UpCost(const Vector3d& body, const Vector3d& station) : body_(body), station_(station) {}
    template <class T> bool operator()(const T* pose, T* residual) const {
        const T in[3] = {T(body_.x()), T(body_.y()), T(body_.z())};
        T out[3];
        ceres::AngleAxisRotatePoint(pose, in, out);
        for (int i = 0; i < 3; ++i) residual[i] = (out[i] - station_[i]) / up_sd;
        return true;
    }
    Vector3d body_, station_;
};

using Pose = std::array<double, 9>;  // angle-axis, translation, velocity

Pose pose_of(const Quaterniond& q, const Vector3d& t) {
    const Eigen::AngleAxisd turn(q);
    const Vector3d r = turn.axis() * turn.angle();
    return {r.x(), r.y(), r.z(), t.x(), t.y(), t.z(), 0, 0, 0};
}
Isometry3d isometry(const Pose& p) {
    const Vector3d r(p[0], p[1], p[2]);
    Isometry3d out = Isometry3d::Identity();
    if (r.norm() > 1e-12) out.linear() = Eigen::AngleAxisd(r.norm(), r.normalized()).toRotationMatrix();
    out.translation() = Vector3d(p[3], p[4], p[5]);
    return out;
}

const Vector3d& point_of(const PoseProblem& problem, const Bearing& b) {
    return b.point ? *b.point : (*problem.sensors)[b.sensor].position;
}

void build(const PoseProblem& problem, Pose& pose, ceres::Problem& out) {
    for (const Bearing& b : problem.bearings) {
        auto* cost = new ceres::AutoDiffCostFunction<BearingCost, 1, 6, 3>(new BearingCost(point_of(problem, b), b, problem.station));
        out.AddResidualBlock(cost, new ceres::HuberLoss(3.0), pose.data(), pose.data() + 6);  // 3 mrad: reflections
    }
    if (problem.up_in_body && problem.up_in_station)
        out.AddResidualBlock(new ceres::AutoDiffCostFunction<UpCost, 3, 6>(new UpCost(*problem.up_in_body, *problem.up_in_station)),
                             nullptr, pose.data());
    if (problem.turn)
        out.AddResidualBlock(new ceres::AutoDiffCostFunction<TurnCost, 9, 6>(new TurnCost(*problem.turn, problem.turn_sd)), nullptr,
                             pose.data());
    if (problem.velocity_sd > 0)
        out.AddResidualBlock(new ceres::AutoDiffCostFunction<VelocityCost, 3, 3>(new VelocityCost(problem.velocity_sd)), nullptr,
                             pose.data() + 6);
    else
        out.SetParameterBlockConstant(pose.data() + 6);
}

double refine(const PoseProblem& problem, Pose& pose, int iterations) {
    ceres::Problem least_squares;
    build(problem, pose, least_squares);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = iterations;
    options.logging_type = ceres::SILENT;
    options.function_tolerance = 1e-9;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &least_squares, &summary);
    return summary.IsSolutionUsable() ? summary.final_cost : 1e300;
}

double rms(const PoseProblem& problem, const Isometry3d& pose, const Vector3d& velocity) {
    double sum = 0;
    for (const Bearing& b : problem.bearings) {
        const Vector3d p = pose * point_of(problem, b) - velocity * b.age;
        const double r = sweep_reading(b.axis, p.x(), p.y(), p.z(), problem.station) - b.angle;
        sum += r * r;
    }
    return std::sqrt(sum / static_cast<double>(problem.bearings.size()));
}

std::vector<std::uint8_t> seen_sensors(const PoseProblem& problem) {
    std::vector<std::uint8_t> seen;
    for (const Bearing& b : problem.bearings) seen.push_back(b.sensor);
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    return seen;
}

// A sensor sees nothing behind itself: of those that were hit, most must face the station.
double facing(const PoseProblem& problem, const Isometry3d& pose) {
    int facing = 0;
    const auto seen = seen_sensors(problem);
    for (const std::uint8_t i : seen) {
        const Sensor& s = (*problem.sensors)[i];
        if ((pose.linear() * s.normal).dot(pose * s.position) < 0) ++facing;
    }
    return double(facing) / double(seen.size());
}

bool in_front(const Isometry3d& pose) {
    const double distance = pose.translation().norm();
    return pose.translation().z() < 0 && distance > nearest_m && distance < farthest_m;
}

// Where the middle of the bearings points.
Vector3d mean_ray(const PoseProblem& problem) {
    double sum[2] = {0, 0}, count[2] = {0, 0};
    for (const Bearing& b : problem.bearings) sum[b.axis] += b.angle, count[b.axis] += 1;
    const double x = count[0] > 0 ? std::tan(-sum[0] / count[0]) : 0, y = count[1] > 0 ? std::tan(sum[1] / count[1]) : 0;
    return Vector3d(x, y, -1).normalized();
}

// Turns to begin from: the one that is known; with up known only the heading is open; else 24 turns of a cube and 24 between them.
std::vector<Quaterniond> starting_turns(const PoseProblem& problem) {
    std::vector<Quaterniond> turns;
    if (problem.turn) return {*problem.turn};
    if (problem.up_in_body && problem.up_in_station) {
        const Quaterniond upright = Quaterniond::FromTwoVectors(*problem.up_in_body, *problem.up_in_station);
        for (int i = 0; i < 12; ++i)
            turns.push_back(Quaterniond(Eigen::AngleAxisd(i * std::numbers::pi / 6, problem.up_in_station->normalized())) * upright);
        return turns;
    }
    for (int tip = 0; tip < 6; ++tip) {
        const Quaterniond tipped = tip < 4 ? Quaterniond(Eigen::AngleAxisd(tip * std::numbers::pi / 2, Vector3d::UnitX()))
                                           : Quaterniond(Eigen::AngleAxisd((tip * 2 - 9) * std::numbers::pi / 2, Vector3d::UnitZ()));
        for (int turn = 0; turn < 8; ++turn)
            turns.push_back(tipped * Quaterniond(Eigen::AngleAxisd(turn * std::numbers::pi / 4, Vector3d::UnitY())));
    }
    return turns;
}

// Noise of the bearings carried through the solution's normal equations.
Result<void> add_uncertainty(const PoseProblem& problem, Pose pose, StationPose& out) {
    ceres::Problem least_squares;
    build(problem, pose, least_squares);
    ceres::CRSMatrix sparse;
    using Normal = Eigen::Matrix<double, 9, 9>;
    Normal normal = Normal::Zero();
    if (!least_squares.Evaluate({}, nullptr, nullptr, nullptr, &sparse))
        return failure("The bearings' equations cannot be evaluated at their solution.");
    for (int row = 0; row < sparse.num_rows; ++row) {
        Eigen::Matrix<double, 9, 1> j = Eigen::Matrix<double, 9, 1>::Zero();
        for (auto k = static_cast<std::size_t>(sparse.rows[static_cast<std::size_t>(row)]);
             k < static_cast<std::size_t>(sparse.rows[static_cast<std::size_t>(row) + 1]); ++k)
            j[sparse.cols[k]] = sparse.values[k];
        normal += j * j.transpose();
    }
    if (problem.velocity_sd <= 0) normal.diagonal().tail<3>().setConstant(1e12);  // known to be at rest
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(normal.topLeftCorner<6, 6>());
    if (!(eigen.eigenvalues().minCoeff() > 1e-9 * eigen.eigenvalues().maxCoeff()))
        return failure("The bearings do not determine a pose: too few sensors, or all on a line.");
    const Normal covariance = normal.inverse();
    const double noise = std::max(out.rms, least_noise) / bearing_scale;
    out.orientation_sd = noise * std::sqrt(covariance.diagonal().head<3>().maxCoeff());
    out.position_sd = noise * std::sqrt(covariance.diagonal().segment<3>(3).maxCoeff());
    return {};
}

}  // namespace

Result<StationPose> solve_pose(const PoseProblem& problem) {
    for (const Bearing& b : problem.bearings)
        if (b.sensor >= problem.sensors->size() || b.axis < 0 || b.axis > 1 || !std::isfinite(b.angle))
            return failure(fmt::format("A bearing names sensor {}, axis {}; there are {} sensors and two axes.", b.sensor, b.axis,
                                       problem.sensors->size()));
    const auto seen = seen_sensors(problem);
    if (problem.bearings.size() < 6 || seen.size() < 3)
        return failure(
            fmt::format("{} bearings of {} sensors are too few for a pose; 6 of 3 are needed.", problem.bearings.size(), seen.size()));
    const auto horizontal = std::count_if(problem.bearings.begin(), problem.bearings.end(), [](const Bearing& b) { return b.axis == 0; });
    if (horizontal < 2 || static_cast<std::size_t>(horizontal) + 2 > problem.bearings.size())
        return failure("All bearings are of one sweep; both are needed for a pose.");
    Pose best{};
    double best_cost = 1e300;
    const auto consider = [&](Pose pose, int iterations) {
        const double cost = refine(problem, pose, iterations);
        const Isometry3d solution = isometry(pose);
        if (cost < best_cost && in_front(solution) && facing(problem, solution) >= 0.75) {
            best_cost = cost;
            best = pose;
        }
    };
    if (problem.start) consider(pose_of(Quaterniond(problem.start->linear()), problem.start->translation()), 30);
    if (!problem.start || best_cost > double(problem.bearings.size())) {  // a milliradian each: the old pose does not hold any more
        const Vector3d ray = mean_ray(problem);
        for (const Quaterniond& turn : starting_turns(problem)) consider(pose_of(turn, ray * 2.0), 40);
    }
    if (best_cost == 1e300) return failure("No pose before the station explains the bearings.");
    StationPose out;
    out.station_from_body = isometry(best);
    out.velocity = Vector3d(best[6], best[7], best[8]);
    out.rms = rms(problem, out.station_from_body, out.velocity);
    out.sensors = static_cast<int>(seen.size());
    if (out.rms > accepted_rms)
        return failure(fmt::format("The best pose leaves {:.1f} mrad; {:.0f} are accepted.", out.rms * 1e3, accepted_rms * 1e3));
    ENTOPTIC_CHECK(add_uncertainty(problem, best, out));
    return out;
}

}  // namespace entoptic::drivers::lighthouse
