// `entoptic record`: what head, eyes and headset send, with one clock, into a file.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "drivers/driver.h"
#include "drivers/pupil_labs/pupil_labs_device.h"
#include "drivers/recording/recorded_samples.h"
#include "drivers/recording/recording.h"
#include "drivers/vive_pro/vive_pro_device.h"

#include <array>
#include <atomic>
#include <csignal>
#include <fmt/format.h>
#include <memory>

namespace entoptic::app {
namespace {

using drivers::RecordingWriter;
using drivers::Stream;

struct RecordOptions {
    std::string file, hmd = "virtual", script = "still", clock = "real", eye_tracker = "auto";
    double seconds = 10, rate_hz = 250;
    bool progress = false, no_eye_pictures = false;
};

std::atomic<bool> interrupted = false;
void interrupt(int) { interrupted = true; }

// The headset with what its recording needs to say of it.
struct Session {
    Headset headset;
    Json description;
    std::shared_ptr<EyeSource> cameras;  // when they are not the headset's own
};

Json described(const Headset& headset, const RecordOptions& o) {
    return {{"version", 1},
            {"entoptic", ENTOPTIC_VERSION},
            {"hmd", o.hmd},
            {"name", headset.display.name},
            {"clock", o.clock},
            {"panel_width", headset.display.panel_width},
            {"panel_height", headset.display.panel_height},
            {"ipd_mm", decimal(headset.eyes[1].head_from_eye.position.x - headset.eyes[0].head_from_eye.position.x) * 1e3},
            {"eye_tracker", headset.eye_tracker->present()},
            {"eye_tracker_name", headset.eye_tracker->description()}};
}

Result<Session> open_virtual(const RecordOptions& o, TimeNs start) {
    drivers::DriverOptions options;
    options.script = o.script;
    options.start_time = start;
    ENTOPTIC_TRY(headset, drivers::open_headset(options));
    return Session{headset, described(headset, o), nullptr};
}

// The eye cameras with their pictures, or another tracker that was named.
Result<std::shared_ptr<EyeSource>> open_eyes(const RecordOptions& o, Clock& clock,
                                             const std::shared_ptr<std::atomic<RecordingWriter*>>& writer) {
    const bool cameras = o.eye_tracker == "auto" || o.eye_tracker == drivers::pupil_labs_driver.name;
    if (!cameras || o.no_eye_pictures) return drivers::open_eye_tracker(o.eye_tracker, clock);
    return drivers::open_eye_cameras(clock, [writer](int eye, const std::string& product, const drivers::CameraMode& mode,
                                                     const drivers::CompressedFrame& frame, TimeNs arrival) {
        RecordingWriter* to = writer->load();
        if (!to) return;
        to->add(Stream::eye_picture, arrival,
                drivers::encode_eye_picture(
                    {eye, product, mode.width, mode.height, frame.time, frame.sequence, {frame.bytes.begin(), frame.bytes.end()}}));
    });
}

// `writer` is filled in once the headset has said what it is; reports before that are left out.
Result<Session> open_vive(const RecordOptions& o, Clock& clock, const std::shared_ptr<std::atomic<RecordingWriter*>>& writer) {
    const auto tap = [writer](drivers::vive_pro::Source source, drivers::vive_pro::Bytes report, TimeNs arrival) {
        RecordingWriter* to = writer->load();
        if (!to) return;
        drivers::Payload payload{static_cast<std::uint8_t>(source)};
        payload.insert(payload.end(), report.begin(), report.end());
        to->add(Stream::vive_report, arrival, payload);
    };
    ENTOPTIC_TRY(device, drivers::vive_pro::open_device(drivers::system_hid_bus(), clock, tap));
    const std::shared_ptr<drivers::vive_pro::Device> shared = std::move(device);
    Session session{drivers::vive_pro::headset_of(shared, shared->ipd_mm(300'000'000)), {}, nullptr};
    if (o.eye_tracker != "none") {
        auto eyes = open_eyes(o, clock, writer);
        if (eyes) {
            session.cameras = *eyes;
            session.headset.eye_tracker = eyes->get();
        } else if (o.eye_tracker != "auto" || eyes.error().kind != ErrorKind::missing) {
            return forward_error(eyes.error());
        }
    }
    session.description = described(session.headset, o);
    session.description["configuration"] = shared->configuration();
    session.description["ranges"] = {{"acceleration_m_s2", shared->ranges().acceleration},
                                     {"angular_rate_rad_s", shared->ranges().angular_rate}};
    return session;
}

// A millisecond after another: eye samples as they have arrived, poses at their rate.
class Sampler {
public:
    Sampler(Headset& headset, RecordingWriter& writer, double rate_hz, TimeNs begin)
        : headset_(headset), writer_(writer), pose_every_(nanoseconds(1 / rate_hz)), next_pose_(begin) {}
    void sample(TimeNs now) {
        for (int eye = 0; eye < 2; ++eye) {
            const auto raw = headset_.eye_tracker->present() ? headset_.eye_tracker->raw_at(eye, now) : std::nullopt;
            TimeNs& last = last_eye_[static_cast<std::size_t>(eye)];
            if (!raw || raw->time == last) continue;
            last = raw->time;
            writer_.add(Stream::eye, now, drivers::encode_eye(eye, *raw));
            ++eyes_;
        }
        if (now >= next_pose_) {
            writer_.add(Stream::pose, now, drivers::encode_pose(now, headset_.head->pose_at(now)));
            ++poses_;
            next_pose_ = std::max(next_pose_ + pose_every_, now + 1);
        }
        note_status(now);
    }
    std::uint64_t poses() const { return poses_; }
    std::uint64_t eyes() const { return eyes_; }

private:
    void note_status(TimeNs now) {
        if (!headset_.status) return;
        const HeadsetStatus status = headset_.status->status();
        if (status.present == present_) return;
        present_ = status.present;
        writer_.add(Stream::event, now, Json{{"event", present_ ? "headset present" : "headset absent"}, {"why", status.why}}.dump());
    }

    Headset& headset_;
    RecordingWriter& writer_;
    DurationNs pose_every_;
    TimeNs next_pose_;
    std::uint64_t poses_ = 0, eyes_ = 0;
    std::array<TimeNs, 2> last_eye_{};
    bool present_ = true;
};

Result<int> record(const RecordOptions& o) {
    const bool lockstep = o.clock == "lockstep";
    if (lockstep && o.hmd != "virtual") return usage_error("A real headset runs in real time. Use --clock real.");
    std::unique_ptr<Clock> clock;
    if (lockstep)
        clock = std::make_unique<VirtualClock>();
    else
        clock = std::make_unique<MonotonicClock>();
    const TimeNs start = clock->now();
    const auto tapped = std::make_shared<std::atomic<RecordingWriter*>>(nullptr);
    auto session = o.hmd == "virtual" ? open_virtual(o, start) : open_vive(o, *clock, tapped);
    if (!session) return forward_error(session.error());
    ENTOPTIC_TRY(writer, RecordingWriter::create(o.file, session->description.dump(), clock->now()));
    tapped->store(writer.get());
    std::signal(SIGINT, interrupt);
    std::signal(SIGTERM, interrupt);
    Progress progress("s recorded", o.progress);
    const TimeNs begin = clock->now(), end = begin + nanoseconds(o.seconds);
    Sampler sampler(session->headset, *writer, o.rate_hz, begin);
    for (TimeNs next = begin; next < end && !interrupted; next += 1'000'000) {
        clock->sleep_until(next);
        sampler.sample(clock->now());
        progress.update(static_cast<std::uint64_t>(seconds(next - begin)), static_cast<std::uint64_t>(o.seconds));
    }
    tapped->store(nullptr);
    session->headset = {};  // its threads end here, before the writer does
    ENTOPTIC_CHECK(writer->close());
    fmt::print("{}: {:.3f} s, {} poses, {} eye samples.\n", o.file, seconds(clock->now() - begin), sampler.poses(), sampler.eyes());
    return 0;
}

}  // namespace

void add_record(CLI::App& app, Action& action) {
    auto o = std::make_shared<RecordOptions>();
    CLI::App* c = app.add_subcommand("record", "Record what head, eyes and headset send, with one clock");
    c->add_option("file", o->file, "File to make; never overwritten")->required();
    c->add_option("--hmd", o->hmd, "virtual or vive-pro")->check(CLI::IsMember({"virtual", "vive-pro"}));
    c->add_option("--script", o->script, "What the virtual head and eyes do: a built-in script or a file");
    c->add_option("--eye-tracker", o->eye_tracker, "With a real headset: auto, none, or a driver's name");
    c->add_option("--seconds", o->seconds, "How long; Ctrl-C ends it earlier")->check(CLI::Range(0.01, 86400.0));
    c->add_option("--rate", o->rate_hz, "Poses a second (a Vive Pro's reports are kept whole besides)")->check(CLI::Range(1.0, 1000.0));
    c->add_option("--clock", o->clock, "real, or lockstep: as fast as it goes, the same bits every time")
        ->check(CLI::IsMember({"real", "lockstep"}));
    c->add_flag("--no-eye-pictures", o->no_eye_pictures,
                "Leave the eye cameras' pictures out: samples are recorded anyway");
    c->add_flag("--progress", o->progress, "Tell progress even without a terminal");
    c->callback([o, &action] { action = [o] { return record(*o); }; });
}

}  // namespace entoptic::app
