#include "drivers/vive_pro/vive_pro_tracker.h"

namespace entoptic::drivers::vive_pro {

namespace {

constexpr double ipd_least_mm = 55, ipd_most_mm = 80;  // the slider has 60 to 75

Eigen::Vector3d eigen(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

HeadFilterParameters filter_parameters(const Calibration& calibration) {
    HeadFilterParameters parameters;
    parameters.sensor_in_head = eigen(calibration.imu.position_in_head);
    return parameters;
}

std::vector<lighthouse::Sensor> sensors_of(const Calibration& calibration) {
    std::vector<lighthouse::Sensor> out;
    for (const LighthouseSensor& s : calibration.sensors) out.push_back({eigen(s.position), eigen(s.normal)});
    return out;
}

}  // namespace

Tracker::Tracker(const Calibration& calibration, const ImuRanges& ranges)
    : calibration_(calibration),
      ranges_(ranges),
      clock_(ticks_per_second),
      filter_(filter_parameters(calibration)),
      lighthouse_(sensors_of(calibration)) {}

void Tracker::imu_report(Bytes report, TimeNs arrival) {
    const auto parsed = parse_imu(report);
    const std::lock_guard lock(mutex_);
    if (!parsed) {
        ++statistics_.malformed;
        return;
    }
    const NewSamples fresh = stream_.take(*parsed);
    for (std::size_t i = 0; i < fresh.count; ++i) {
        const ImuSample& sample = fresh.samples[i];
        const TimeNs time = clock_.sample(sample.ticks, arrival);
        statistics_.newest_sample = time;
        filter_.inertial(
            {time, eigen(calibration_.imu.acceleration(sample, ranges_)), eigen(calibration_.imu.angular_rate(sample, ranges_))});
        if (filter_.started()) history_.push(time, filter_.state());
    }
    lighthouse_.watch(filter_);
}

void Tracker::light_report(Bytes report, TimeNs) {
    const auto parsed = parse_light(report);
    std::optional<lighthouse::LighthouseTracker::Search> search;
    {
        const std::lock_guard lock(mutex_);
        if (!parsed) {
            ++statistics_.malformed;
            return;
        }
        for (std::size_t i = 0; i < parsed->count; ++i) {
            const LightEvent& event = parsed->events[i];
            if (event.id >= light_channels) continue;  // time stamps of display and camera
            const int sensor = calibration_.channel_map[event.id];
            if (sensor < 0) continue;
            ++statistics_.light_events;
            sweeps_.add({static_cast<std::uint8_t>(sensor), event.duration, event.ticks});
        }
        decoded(sweeps_.take_hits());
        search = lighthouse_.due(filter_);
    }
    if (!search) return;
    const auto pose = lighthouse::solve_pose(search->problem);  // milliseconds: nobody waits for it
    const std::lock_guard lock(mutex_);
    lighthouse_.found(*search, pose, filter_);
}

void Tracker::decoded(std::vector<lighthouse::Hit> hits) {
    if (!clock_.started()) return;  // no motion yet: nothing says when this was
    for (int s = 0; s < 2; ++s)
        if (const auto& info = sweeps_.station(s)) lighthouse_.set_station(s, *info);
    for (const lighthouse::Hit& hit : hits) lighthouse_.add(hit, clock_.host_time(hit.ticks), filter_);
    statistics_.hits += hits.size();
}

void Tracker::mainboard_report(Bytes report, TimeNs arrival) {
    const auto parsed = parse_mainboard(report);
    const std::lock_guard lock(mutex_);
    if (!parsed) {
        if (!report.empty() && report[0] == report_mainboard) return;  // another type of the same id
        ++statistics_.malformed;
        return;
    }
    const double ipd_mm = parsed->ipd_10um / 100.0;
    mainboard_.worn = worn_.update(parsed->proximity);
    mainboard_.system_button = parsed->system_button;
    mainboard_.ipd_mm = ipd_mm >= ipd_least_mm && ipd_mm <= ipd_most_mm ? ipd_mm : 0;
    mainboard_.proximity = parsed->proximity;
    mainboard_.time = arrival;
}

MainboardReading Tracker::mainboard() const {
    const std::lock_guard lock(mutex_);
    return mainboard_;
}

TrackerStatistics Tracker::statistics() const {
    const std::lock_guard lock(mutex_);
    TrackerStatistics out = statistics_;
    out.samples = stream_.received();
    out.lost_samples = stream_.lost();
    out.gaps = stream_.gaps();
    out.restarts = stream_.restarts();
    out.clock_jumps = clock_.jumps();
    out.drift_ppm = clock_.drift_ppm();
    out.lighthouse = lighthouse_.report();
    return out;
}

}  // namespace entoptic::drivers::vive_pro
