// `entoptic export`: a recording as tables that others read: BIDS eye tracking and motion, or CSV.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "drivers/eye_tracking/gaze_angles.h"
#include "drivers/replay/replay_device.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <zlib.h>

namespace entoptic::app {
namespace {

struct ExportOptions {
    std::string file, output, format = "bids";
};

constexpr const char* absent = "n/a";  // BIDS's word for a value that is not there

// One eye sample in the units of the tables.
struct EyeRow {
    double time_s = 0, x_deg = 0, y_deg = 0, pupil_mm = 0, confidence = 0;
    bool gaze = false, pupil = false;
};
EyeRow row_of(const drivers::RecordedEye& eye, TimeNs start) {
    const RawEyeSample& s = eye.sample;
    EyeRow row;
    row.time_s = seconds(s.time - start);
    const glm::dvec3 g(s.gaze_direction);
    row.confidence = std::isfinite(s.confidence) ? double(s.confidence) : 0;
    row.gaze = std::isfinite(g.x) && std::isfinite(g.y) && std::isfinite(g.z) && g.z < 0 && row.confidence > 0;
    if (row.gaze) {
        const drivers::GazeAngles angles = drivers::angles_of(g);
        row.x_deg = angles.x;
        row.y_deg = angles.y;
    }
    row.pupil = std::isfinite(s.pupil_diameter_mm) && s.pupil_diameter_mm > 0 && row.confidence > 0;
    row.pupil_mm = double(s.pupil_diameter_mm);
    return row;
}

std::string cell(bool known, double value, int digits) { return known ? fmt::format("{:.{}f}", value, digits) : absent; }

double sampling_hz(std::vector<double> times) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < times.size(); ++i) steps.push_back(times[i] - times[i - 1]);
    if (steps.empty()) return 0;
    std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2), steps.end());
    const double middle = steps[steps.size() / 2];
    return middle > 0 ? 1 / middle : 0;
}

Result<void> write_text(const std::string& path, const std::string& text) {
    std::ofstream out(path, std::ios::binary);
    out << text;
    out.close();
    if (!out) return failure(fmt::format("{} cannot be written. Choose another place with -o.", path));
    fmt::print("{}\n", path);
    return {};
}
Result<void> write_gzip(const std::string& path, const std::string& text) {
    gzFile file = gzopen(path.c_str(), "wb9");
    bool written = file != nullptr;
    for (std::size_t at = 0; written && at < text.size(); at += 1 << 20) {
        const auto length = static_cast<unsigned>(std::min<std::size_t>(1 << 20, text.size() - at));
        written = gzwrite(file, text.data() + at, length) == static_cast<int>(length);
    }
    if (file) written = gzclose(file) == Z_OK && written;
    if (!written) return failure(fmt::format("{} cannot be written. Choose another place with -o.", path));
    fmt::print("{}\n", path);
    return {};
}

// ---- BIDS: physiological recordings of type eyetrack, motion of the head ------------------------------------------------------------

Json column(const char* name, const char* description, const char* units) {
    return {{"LongName", name}, {"Description", description}, {"Units", units}};
}

Result<void> bids_eye(const drivers::RecordedSession& session, int eye, const std::string& prefix) {
    std::string rows;
    std::vector<double> times;
    for (const drivers::RecordedEye& sample : session.eyes) {
        if (sample.eye != eye) continue;
        const EyeRow r = row_of(sample, session.start);
        times.push_back(r.time_s);
        rows += fmt::format("{:.6f}\t{}\t{}\t{}\t{:.3f}\n", r.time_s, cell(r.gaze, r.x_deg, 4), cell(r.gaze, r.y_deg, 4),
                            cell(r.pupil, r.pupil_mm, 4), r.confidence);
    }
    if (times.empty()) return {};
    const std::string name = fmt::format("{}_recording-eye{}_physio", prefix, eye + 1);
    const Json sidecar = {
        {"PhysioType", "eyetrack"},
        {"RecordedEye", eye == 0 ? "left" : "right"},
        {"SampleCoordinateSystem", "eye-in-head"},
        {"SamplingFrequency", sampling_hz(times)},
        {"StartTime", times.front()},
        {"Columns", {"timestamp", "x_coordinate", "y_coordinate", "pupil_size", "confidence"}},
        {"Manufacturer", session.hmd == "virtual" ? "Entoptic (simulated)" : "Pupil Labs"},
        {"SoftwareVersions", fmt::format("Entoptic {}", ENTOPTIC_VERSION)},
        {"timestamp",
         {{"Description", "When the light of the sample fell on the tracker's sensor"},
          {"Units", "s"},
          {"Origin", "first sample of the recording"}}},
        {"x_coordinate",
         column("Gaze, horizontal", "Azimuth of the eye's direction in the head (Fick's angles), positive to the right", "degree")},
        {"y_coordinate", column("Gaze, vertical", "Elevation of the eye's direction in the head (Fick's angles), positive up", "degree")},
        {"pupil_size", column("Pupil", "Diameter of the entrance pupil", "mm")},
        {"confidence", column("Confidence", "Of the tracker in this sample, 0 to 1; 0: no pupil was found", "1")}};
    ENTOPTIC_CHECK(write_gzip(name + ".tsv.gz", rows));
    return write_text(name + ".json", sidecar.dump(2) + "\n");
}

struct HeadColumn {
    const char *name, *component, *type, *units;
};
constexpr HeadColumn head_columns[] = {{"head_pos_x", "x", "POS", "m"},          {"head_pos_y", "y", "POS", "m"},
                                       {"head_pos_z", "z", "POS", "m"},          {"head_ornt_x", "quat_x", "ORNT", "n/a"},
                                       {"head_ornt_y", "quat_y", "ORNT", "n/a"}, {"head_ornt_z", "quat_z", "ORNT", "n/a"},
                                       {"head_ornt_w", "quat_w", "ORNT", "n/a"}, {"latency", "n/a", "LATENCY", "s"}};

std::string head_row(const drivers::RecordedPose& pose, TimeNs start, char separator) {
    const PoseState& s = pose.state;
    const glm::quat& q = s.pose.orientation;
    std::string out;
    for (const float p : {s.pose.position.x, s.pose.position.y, s.pose.position.z}) out += cell(s.position_valid, double(p), 6) + separator;
    for (const float c : {q.x, q.y, q.z, q.w}) out += cell(s.orientation_valid, double(c), 7) + separator;
    return out + fmt::format("{:.6f}", seconds(pose.time - start));
}

Result<void> bids_head(const drivers::RecordedSession& session, const std::string& prefix) {
    if (session.poses.empty()) return {};
    std::string rows, channels = "name\tcomponent\ttype\ttracked_point\tunits\treference_frame\n";
    std::vector<double> times;
    for (const drivers::RecordedPose& pose : session.poses) {
        rows += head_row(pose, session.start, '\t') + '\n';
        times.push_back(seconds(pose.time - session.start));
    }
    for (const HeadColumn& c : head_columns) channels += fmt::format("{}\t{}\t{}\thead\t{}\tstage\n", c.name, c.component, c.type, c.units);
    const Json sidecar = {{"SamplingFrequency", sampling_hz(times)},
                          {"TrackingSystemName", session.hmd},
                          {"MotionChannelCount", 8},
                          {"POSChannelCount", 3},
                          {"ORNTChannelCount", 4},
                          {"MissingValues", absent},
                          {"SoftwareVersions", fmt::format("Entoptic {}", ENTOPTIC_VERSION)}};
    ENTOPTIC_CHECK(write_text(prefix + "_tracksys-head_motion.tsv", rows));
    // OpenXR's axes: x right, y up, z back.
    const Json frames = {{"reference_frame",
                          {{"Levels",
                            {{"stage",
                              {{"SpatialAxes", "RSP"},
                               {"RotationRule", "right-hand"},
                               {"Description",
                                "The room: x to the right, y up, z backward; the floor is at y = 0. Quaternions turn the head's axes into "
                                "the room's."}}}}}}}};
    ENTOPTIC_CHECK(write_text(prefix + "_tracksys-head_channels.tsv", channels));
    ENTOPTIC_CHECK(write_text(prefix + "_tracksys-head_channels.json", frames.dump(2) + "\n"));
    return write_text(prefix + "_tracksys-head_motion.json", sidecar.dump(2) + "\n");
}

Result<void> export_bids(const drivers::RecordedSession& session, const std::string& prefix) {
    for (int eye = 0; eye < 2; ++eye) ENTOPTIC_CHECK(bids_eye(session, eye, prefix));
    return bids_head(session, prefix);
}

// ---- CSV ---------------------------------------------------------------------------------------------------------------------------------

Result<void> export_csv(const drivers::RecordedSession& session, const std::string& prefix) {
    std::string eyes = "time_s,eye,x_deg,y_deg,pupil_mm,confidence,arrival_s\n";
    for (const drivers::RecordedEye& sample : session.eyes) {
        const EyeRow r = row_of(sample, session.start);
        const auto known = [](bool is, double value) { return is ? fmt::format("{:.4f}", value) : std::string("nan"); };
        eyes +=
            fmt::format("{:.6f},{},{},{},{},{:.3f},{:.6f}\n", r.time_s, sample.eye == 0 ? "left" : "right", known(r.gaze, r.x_deg),
                        known(r.gaze, r.y_deg), known(r.pupil, r.pupil_mm), r.confidence, seconds(sample.sample.arrival - session.start));
    }
    std::string head = "x_m,y_m,z_m,qx,qy,qz,qw,time_s\n";
    for (const drivers::RecordedPose& pose : session.poses) head += head_row(pose, session.start, ',') + '\n';
    ENTOPTIC_CHECK(write_text(prefix + "_eyes.csv", eyes));
    return write_text(prefix + "_head.csv", head);
}

// ---- Pictures ----------------------------------------------------------------------------------------------------------------------------

// A field of a table with commas.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

// One after the other, straight from the file: there may be more of them than memory.
Result<void> export_pictures(const std::string& file, TimeNs start, const std::string& prefix) {
    ENTOPTIC_TRY(reader, drivers::RecordingReader::open(file));
    std::string list = "file,eye,time_s,arrival_s,sequence,camera\n";
    std::size_t count = 0;
    while (const auto record = reader.next()) {
        if (record->stream != drivers::Stream::eye_picture) continue;
        const auto picture = drivers::decode_eye_picture(record->payload);
        if (!picture) continue;
        const char* side = picture->eye == 0 ? "left" : "right";
        const std::string path = fmt::format("{}_{:06}_{}.jpg", prefix, count++, side);
        std::ofstream out(path, std::ios::binary);
        out.write(reinterpret_cast<const char*>(picture->jpeg.data()), static_cast<std::streamsize>(picture->jpeg.size()));
        out.close();
        if (!out) return failure(fmt::format("{} cannot be written. Choose another place with -o.", path));
        list += fmt::format("{},{},{:.6f},{:.6f},{},{}\n", quoted(std::filesystem::path(path).filename().string()), side,
                            seconds(picture->time - start), seconds(record->time - start), picture->sequence, quoted(picture->product));
    }
    if (count == 0)
        return failure(
            "The recording holds no pictures of eye cameras. They are recorded from real cameras, unless with --no-eye-pictures.");
    return write_text(prefix + "_pictures.csv", list);
}

Result<int> run_export(const ExportOptions& o) {
    ENTOPTIC_TRY(session, drivers::load_session(o.file, 0));  // without pictures
    const std::string prefix = o.output.empty() ? std::filesystem::path(o.file).replace_extension().string() : o.output;
    ENTOPTIC_CHECK(o.format == "bids"       ? export_bids(session, prefix)
                   : o.format == "pictures" ? export_pictures(o.file, session.start, prefix)
                                            : export_csv(session, prefix));
    if (session.lost_bytes > 0)
        fmt::print(stderr, "entoptic: the recording was cut short; what came before its last {} bytes was exported.\n", session.lost_bytes);
    return 0;
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
    auto o = std::make_shared<ExportOptions>();
    CLI::App* c = app.add_subcommand("export", "Write a recording as tables: BIDS (TSV and JSON) or CSV, with units");
    c->add_option("file", o->file, "The recording")->required();
    c->add_option("-o", o->output, "Beginning of the files' names: sub-01_task-driving; default: the recording's");
    c->add_option("--format", o->format,
                  "bids: eye tracking (physio) and motion; csv; or pictures: the eye cameras', for `entoptic eye detect`")
        ->check(CLI::IsMember({"bids", "csv", "pictures"}));
    c->callback([o, &action] { action = [o] { return run_export(*o); }; });
}

}  // namespace entoptic::app
