// From bearings to a tracked head: finds where the base stations stand, then corrects the head filter with every bearing at its own time.
//
// A station is found by a pose solution from 50 ms of bearings and gravity; it then has a place in the world and stays there. The first one
// found fixes the world's position (the head stays where the neck model had it).
#pragma once

#include "base/time.h"
#include "drivers/fusion/head_filter.h"
#include "drivers/lighthouse/lighthouse_pose.h"

#include <array>
#include <deque>

namespace entoptic::drivers::lighthouse {

struct TrackerReport {
    int stations = 0;                      // with a place in the world
    std::uint64_t used = 0, rejected = 0;  // bearings
    std::uint64_t lost = 0;                // times the position was lost and had to be found again
    double last_rms_mrad = 0;              // of the last pose solution
};

class LighthouseTracker {
public:
    // `sensors` in head coordinates, by the numbers that bearings have.
    explicit LighthouseTracker(std::vector<Sensor> sensors) : sensors_(std::move(sensors)) {}

    // A bearing of `station` (0 or 1) at `time`; the filter must be started. Cheap.
    void add(const Hit& hit, TimeNs time, HeadFilter& filter);
    void set_station(int station, const StationInfo& info);

    // Work that takes milliseconds and needs no filter: call with nothing locked. `due` is cheap and says whether there is any.
    struct Search {
        int station = 0;
        PoseProblem problem;
        TimeNs time = 0;                     // of the pose that is wanted: the filter's newest
        Eigen::Quaterniond world_from_head;  // the filter's then
        Eigen::Vector3d head, velocity;      // the filter's; the solution's velocity is added to this one
    };
    std::optional<Search> due(const HeadFilter& filter);
    void found(const Search& search, const Result<StationPose>& pose, HeadFilter& filter);

    // Position lost when no bearing has been believed for a second: back to the neck model, and to searching.
    void watch(HeadFilter& filter);

    TrackerReport report() const { return report_; }
    const std::vector<Sensor>& sensors() const { return sensors_; }

private:
    struct Station {
        StationInfo info;
        bool info_known = false;
        std::deque<std::pair<TimeNs, Bearing>> window;  // 50 ms
        std::optional<Eigen::Isometry3d> world_from_station;
        std::optional<Eigen::Isometry3d> last_solution;
        std::vector<Eigen::Isometry3d> candidates;  // of world_from_station
        TimeNs next_search = 0;
        int rejected_in_a_row = 0;
    };
    void place(Station& station, const Search& search, const StationPose& pose, HeadFilter& filter);

    std::vector<Sensor> sensors_;
    std::array<Station, 2> stations_;
    TimeNs last_used_ = 0;
    TrackerReport report_;
};

}  // namespace entoptic::drivers::lighthouse
