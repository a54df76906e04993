// `entoptic replay`: a recording through the code of the device it was made with; what comes out, and how it differs from what came out then.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "drivers/replay/replay_device.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <memory>

namespace entoptic::app {
namespace {

struct ReplayOptions {
    std::string file, csv;
    double rate_hz = 90;
    bool json = false;
};

double degrees_between(const glm::quat& a, const glm::quat& b) {
    const double dot =
        std::abs(double(a.w) * double(b.w) + double(a.x) * double(b.x) + double(a.y) * double(b.y) + double(a.z) * double(b.z));
    return 2 * std::acos(std::min(1.0, dot)) * 180 / M_PI;
}

struct Differences {
    std::size_t poses = 0;
    double orientation_deg = 0, position_mm = 0;  // largest
};

// Recorded poses against those that the same samples give now.
Differences compare(const drivers::RecordedSession& session, Headset& headset) {
    Differences out;
    for (const drivers::RecordedPose& recorded : session.poses) {
        const PoseState now = headset.head->pose_at(recorded.time);
        if (!now.orientation_valid || !recorded.state.orientation_valid) continue;
        ++out.poses;
        out.orientation_deg = std::max(out.orientation_deg, degrees_between(now.pose.orientation, recorded.state.pose.orientation));
        out.position_mm = std::max(out.position_mm, 1e3 * double(glm::length(now.pose.position - recorded.state.pose.position)));
    }
    return out;
}

Result<void> write_csv(const ReplayOptions& o, const drivers::RecordedSession& session, Headset& headset) {
    std::ofstream out(o.csv);
    out << "time_s,x_m,y_m,z_m,qx,qy,qz,qw,orientation_tracked,position_tracked,gaze_x,gaze_y,gaze_z,pupil_left_mm,pupil_right_mm\n";
    const double length = seconds(session.end - session.start);
    for (std::int64_t k = 0; static_cast<double>(k) / o.rate_hz <= length; ++k) {
        const TimeNs t = session.start + nanoseconds(static_cast<double>(k) / o.rate_hz);
        const PoseState p = headset.head->pose_at(t);
        const Observer e = headset.eye_tracker->observer_at(t);
        const glm::quat& q = p.pose.orientation;
        out << fmt::format("{:.6f},{:.6f},{:.6f},{:.6f},{:.7f},{:.7f},{:.7f},{:.7f},{:d},{:d},{:.6f},{:.6f},{:.6f},{:.4f},{:.4f}\n",
                           static_cast<double>(k) / o.rate_hz, p.pose.position.x, p.pose.position.y, p.pose.position.z, q.x, q.y, q.z, q.w,
                           p.orientation_tracked, p.position_tracked, e.gaze_direction.x, e.gaze_direction.y, e.gaze_direction.z,
                           e.eyes[0].pupil_diameter_mm, e.eyes[1].pupil_diameter_mm);
    }
    out.close();
    if (!out) return failure(fmt::format("{} cannot be written. Choose another place.", o.csv));
    return {};
}

Json summary(const drivers::RecordedSession& s, const Differences& d) {
    return {{"hmd", s.hmd},
            {"seconds", seconds(s.end - s.start)},
            {"poses", s.poses.size()},
            {"eye_samples", s.eyes.size()},
            {"eye_pictures", s.pictures.size()},
            {"eye_pictures_left_out", s.pictures_left_out},
            {"reports", s.reports.size()},
            {"events", s.events.size()},
            {"malformed", s.malformed},
            {"lost_bytes", s.lost_bytes},
            {"compared_poses", d.poses},
            {"orientation_difference_deg", d.orientation_deg},
            {"position_difference_mm", d.position_mm}};
}

void print_summary(const Json& s) {
    fmt::print("{:.3f} s of {}: {} poses, {} eye samples, {} reports, {} events.\n", s["seconds"].get<double>(),
               s["hmd"].get<std::string>(), s["poses"].get<std::size_t>(), s["eye_samples"].get<std::size_t>(),
               s["reports"].get<std::size_t>(), s["events"].get<std::size_t>());
    if (s["eye_pictures_left_out"].get<bool>())
        fmt::print("The eye cameras' pictures take more than a gigabyte: the samples they gave when they were recorded stand for them.\n");
    else if (s["eye_pictures"].get<std::size_t>() > 0)
        fmt::print("{} pictures of eye cameras went through the detector again.\n", s["eye_pictures"].get<std::size_t>());
    if (s["lost_bytes"].get<std::uint64_t>() > 0)
        fmt::print("The file was cut short or is damaged: its last {} bytes are no whole sample.\n", s["lost_bytes"].get<std::uint64_t>());
    if (s["malformed"].get<std::uint64_t>() > 0)
        fmt::print("{} samples are malformed or out of order, and were left out.\n", s["malformed"].get<std::uint64_t>());
    if (s["compared_poses"].get<std::size_t>() > 0)
        fmt::print("Poses again: at most {:.4f} degrees and {:.3f} mm from the recorded ones.\n",
                   s["orientation_difference_deg"].get<double>(), s["position_difference_mm"].get<double>());
}

Result<int> replay(const ReplayOptions& o) {
    ENTOPTIC_TRY(loaded, drivers::load_session(o.file));
    const auto session = std::make_shared<const drivers::RecordedSession>(std::move(loaded));
    ENTOPTIC_TRY(headset, drivers::replay_headset(session, session->start));
    const Json result = summary(*session, compare(*session, headset));
    if (!o.csv.empty()) {
        ENTOPTIC_TRY(again, drivers::replay_headset(session, session->start));
        ENTOPTIC_CHECK(write_csv(o, *session, again));
    }
    if (o.json)
        print_json(result);
    else
        print_summary(result);
    return 0;
}

}  // namespace

void add_replay(CLI::App& app, Action& action) {
    auto o = std::make_shared<ReplayOptions>();
    CLI::App* c =
        app.add_subcommand("replay", "Run a recording through the same code again (under an application: entoptic run --hmd replay)");
    c->add_option("file", o->file, "The recording")->required();
    c->add_option("--csv", o->csv, "Write what comes out: head, gaze and pupils over time");
    c->add_option("--rate", o->rate_hz, "Rows a second of it")->check(CLI::Range(1.0, 1000.0));
    c->add_flag("--json", o->json, "One JSON document on standard output");
    c->callback([o, &action] { action = [o] { return replay(*o); }; });
}

}  // namespace entoptic::app
