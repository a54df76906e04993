#include "drivers/lighthouse/lighthouse_tracker.h"

#include <Eigen/Dense>
#include <algorithm>

namespace entoptic::drivers::lighthouse {

namespace {

using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr DurationNs window_length = 50'000'000;  // six half-rotations of each rotor pair
constexpr DurationNs search_every = 50'000'000, give_up_after = ns_per_s;
constexpr std::size_t candidates_needed = 5;
constexpr double candidates_agree_m = 0.05, candidates_agree_rad = 0.02;
constexpr double useful_sd_m = 0.1, useful_sd_rad = 0.1;
constexpr double expected_speed = 0.5;                  // m/s, of a head that walks about
constexpr DurationNs heading_holds = 60 * ns_per_s;     // the gyroscope's heading drifts by less than heading_sd meanwhile
constexpr double heading_sd = 0.03;                     // rad
constexpr double known_sd = 1.5e-4, unknown_sd = 4e-4;  // rad, of a bearing with and without the station's calibration (facts 1.9)
constexpr int rejected_before_search = 60;              // a station that was moved: half a second of its bearings

Isometry3d isometry(const Quaterniond& q, const Vector3d& t) {
    Isometry3d out = Isometry3d::Identity();
    out.linear() = q.toRotationMatrix();
    out.translation() = t;
    return out;
}

double distance(const Isometry3d& a, const Isometry3d& b) { return (a.translation() - b.translation()).norm(); }
double angle(const Isometry3d& a, const Isometry3d& b) { return Quaterniond(a.linear()).angularDistance(Quaterniond(b.linear())); }

}  // namespace

void LighthouseTracker::set_station(int index, const StationInfo& info) {
    Station& station = stations_[static_cast<std::size_t>(index)];
    if (station.info_known && station.info.id == info.id) return;
    station.world_from_station.reset();  // another station in its place, or the same one, which is not where it seemed without calibration
    station.info = info;
    station.info_known = true;
    station.candidates.clear();
}

void LighthouseTracker::add(const Hit& hit, TimeNs time, HeadFilter& filter) {
    if (hit.station < 0 || hit.station > 1 || hit.sensor >= sensors_.size()) return;
    Station& station = stations_[static_cast<std::size_t>(hit.station)];
    station.window.emplace_back(time, Bearing{hit.axis, hit.sensor, hit.angle});
    while (time - station.window.front().first > window_length || station.window.size() > 256) station.window.pop_front();
    if (!station.world_from_station || !filter.tracks_position() || !filter.past_at(time)) return;
    const Isometry3d station_from_world = station.world_from_station->inverse();
    const Vector3d sensor = sensors_[hit.sensor].position;
    const bool believed =
        filter.bearing(time, hit.angle, station.info_known ? known_sd : unknown_sd, [&](const Quaterniond& q, const Vector3d& head) {
            const Vector3d p = station_from_world * (head + q * sensor);
            return sweep_reading(hit.axis, p.x(), p.y(), p.z(), station.info);
        });
    (believed ? report_.used : report_.rejected) += 1;
    if (believed) {
        last_used_ = std::max(last_used_, time);
        station.rejected_in_a_row = 0;
    } else if (++station.rejected_in_a_row > rejected_before_search) {
        station.rejected_in_a_row = 0;
        station.world_from_station.reset();
        station.candidates.clear();
    }
}

std::optional<LighthouseTracker::Search> LighthouseTracker::due(const HeadFilter& filter) {
    if (!filter.started()) return std::nullopt;
    for (std::size_t i = 0; i < stations_.size(); ++i) {
        Station& station = stations_[i];
        const bool wanted = !station.world_from_station || !filter.tracks_position();
        if (!wanted || station.window.size() < 8 || filter.time() < station.next_search) continue;
        station.next_search = filter.time() + search_every;
        Search search;
        search.station = static_cast<int>(i);
        // The head moved meanwhile, as the filter knows: every sensor to where it was.
        const Isometry3d head_from_world = isometry(filter.orientation(), filter.head_position()).inverse();
        for (const auto& [time, bearing] : station.window) {
            const auto past = filter.past_at(time);
            if (!past) continue;
            search.problem.bearings.push_back(bearing);
            search.problem.bearings.back().age = seconds(filter.time() - time);
            search.problem.bearings.back().point = head_from_world * (past->head + past->q * sensors_[bearing.sensor].position);
        }
        search.problem.sensors = &sensors_;
        search.problem.station = station.info;
        search.problem.start = station.last_solution;
        search.time = filter.time();
        search.world_from_head = filter.orientation();
        search.head = filter.head_position();
        search.velocity = filter.tracks_position() ? Vector3d(Vector3d::Zero()) : filter.velocity();
        if (!filter.tracks_position()) search.problem.velocity_sd = expected_speed;
        if (station.world_from_station && filter.time() - last_used_ < heading_holds) {
            search.problem.turn = Quaterniond(station.world_from_station->linear()).conjugate() * search.world_from_head;
            search.problem.turn_sd = heading_sd;
        }
        if (station.info_known) {
            search.problem.up_in_body = search.world_from_head.conjugate() * Vector3d::UnitY();
            search.problem.up_in_station = Vector3d(station.info.up[0], station.info.up[1], station.info.up[2]);
        }
        return search;
    }
    return std::nullopt;
}

void LighthouseTracker::found(const Search& search, const Result<StationPose>& pose, HeadFilter& filter) {
    Station& station = stations_[static_cast<std::size_t>(search.station)];
    if (!pose) {
        station.last_solution.reset();
        station.candidates.clear();
        return;
    }
    report_.last_rms_mrad = pose->rms * 1e3;
    if (pose->position_sd > useful_sd_m || pose->orientation_sd > useful_sd_rad) return;
    station.last_solution = pose->station_from_body;
    place(station, search, *pose, filter);
}

// Known station, lost head: the head is put back. Unknown station: where it stands is asked five times.
void LighthouseTracker::place(Station& station, const Search& search, const StationPose& pose, HeadFilter& filter) {
    const auto start = [&](const Isometry3d& world_from_station) {
        const Isometry3d world_from_head = world_from_station * pose.station_from_body;
        filter.start_position({Quaterniond(world_from_head.linear()), world_from_head.translation(),
                               search.velocity + world_from_station.linear() * pose.velocity, std::max(0.005, pose.position_sd),
                               std::max(0.01, pose.orientation_sd)});
        last_used_ = search.time;
    };
    if (station.world_from_station) {
        if (!filter.tracks_position()) start(*station.world_from_station);
        return;
    }
    station.candidates.push_back(isometry(search.world_from_head, search.head) * pose.station_from_body.inverse());
    const auto agrees = [&](const Isometry3d& other) {
        return distance(other, station.candidates.back()) < candidates_agree_m + 2 * pose.position_sd &&
               angle(other, station.candidates.back()) < candidates_agree_rad + 2 * pose.orientation_sd;
    };
    if (!std::all_of(station.candidates.begin(), station.candidates.end(), agrees))
        station.candidates.erase(station.candidates.begin(), station.candidates.end() - 1);
    if (station.candidates.size() < candidates_needed) return;
    // The middle one by position stands for all: no mean of rotations is needed, and one bad solution does not pull it.
    std::vector<Isometry3d> sorted = station.candidates;
    Vector3d mean = Vector3d::Zero();
    for (const Isometry3d& c : sorted) mean += c.translation() / double(sorted.size());
    std::sort(sorted.begin(), sorted.end(),
              [&](const Isometry3d& a, const Isometry3d& b) { return (a.translation() - mean).norm() < (b.translation() - mean).norm(); });
    station.world_from_station = sorted.front();
    station.candidates.clear();
    report_.stations = static_cast<int>(
        std::count_if(stations_.begin(), stations_.end(), [](const Station& s) { return s.world_from_station.has_value(); }));
    if (!filter.tracks_position()) start(*station.world_from_station);
}

void LighthouseTracker::watch(HeadFilter& filter) {
    if (!filter.tracks_position() || filter.time() - last_used_ < give_up_after) return;
    filter.stop_position();
    ++report_.lost;
    for (Station& station : stations_) {
        station.last_solution.reset();
        station.candidates.clear();
        station.window.clear();
    }
}

}  // namespace entoptic::drivers::lighthouse
