// The pose of a set of sensors before one base station, from bearings within a short time: nonlinear least squares (Ceres) from many starts.
#pragma once

#include "base/result.h"
#include "drivers/lighthouse/lighthouse_v1.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <vector>

namespace entoptic::drivers::lighthouse {

struct Sensor {
    Eigen::Vector3d position, normal;  // body coordinates: m, unit
};

struct Bearing {
    int axis = 0;
    std::uint8_t sensor = 0;
    double angle = 0;  // rad
    // Where the sensor was at the bearing's time, in the coordinates that the body has at the problem's time, m. None: the body was at rest.
    std::optional<Eigen::Vector3d> point;
    double age = 0;  // s before the problem's time
};

struct PoseProblem {
    std::vector<Bearing> bearings;
    const std::vector<Sensor>* sensors = nullptr;  // never null
    StationInfo station;                           // default: a perfect one
    // Up in the body and in the station, if both are known: holds what few sensors leave open (two poses can explain four sensors).
    std::optional<Eigen::Vector3d> up_in_body, up_in_station;
    std::optional<Eigen::Isometry3d> start;  // station from body, from the last time
    // How the body stands, where something else (a gyroscope since it was seen last) knows it to `turn_sd` rad.
    std::optional<Eigen::Quaterniond> turn;
    double turn_sd = 0.03;
    double velocity_sd = 0;  // m/s: above 0, the body's own velocity is solved for, too, and expected to be of this size
};

struct StationPose {
    Eigen::Isometry3d station_from_body = Eigen::Isometry3d::Identity();
    double rms = 0;                                      // rad, of the bearings
    int sensors = 0;                                     // different ones
    double position_sd = 0;                              // m, largest axis, for bearings' noise of `rms`, at least 0.05 mrad
    double orientation_sd = 0;                           // rad
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, station coordinates
};

// Errors: fewer than 6 bearings, 3 sensors or 2 bearings of a sweep; no pose explains them within 4 mrad and 0.2 to 12 m before the station with most of the
// sensors facing it; the bearings do not determine one.
Result<StationPose> solve_pose(const PoseProblem& problem);

}  // namespace entoptic::drivers::lighthouse
