// `entoptic stimulus`: what people were shown in published experiments, as numbered OpenEXR pictures in cd/m² and a gaze trace, for
// `entoptic simulate`.
#include "app/cli/command.h"
#include "app/cli/output.h"
#include "app/parse.h"
#include "app/simulation/stimuli.h"
#include "base/image_io.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <memory>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;
constexpr int most_frames = 10000;

struct Options {
    std::string name, output, size = "320x240";
    StimulusOptions stimulus;
    double fov_deg = 40;
    double fps = 40;   // every phase of the papers' stimuli is a whole number of frames
    std::optional<double> seconds;
    bool progress = false;
};

// A phase as it is shown: its picture, from when to when.
struct Shown {
    ImageF picture;
    double from_s = 0, to_s = 0;
    const Phase* phase = nullptr;
};

class Writer {
public:
    Writer(const Options& options, const StimulusEntry& entry) : o_(options), entry_(entry), phases_(entry.phases(options.stimulus)) {}

    Result<void> run() {
        ENTOPTIC_CHECK(plan());
        Progress progress("frames", o_.progress);
        for (int i = 0; i < frames_; ++i) {
            ENTOPTIC_CHECK(write(i));
            progress.update(static_cast<std::uint64_t>(i + 1), static_cast<std::uint64_t>(frames_));
        }
        ENTOPTIC_CHECK(write_trace());
        fmt::print("{}\n{}\n", pattern_, trace_);
        fmt::print(stderr, "Look at it: entoptic simulate {} --fps {:g} --fov {:g} --trace {} -o seen_%04d.png --preset {}\n", pattern_,
                   o_.fps, o_.fov_deg, trace_, entry_.preset);
        return {};
    }

private:
    Result<void> plan() {
        const auto size = size_from(o_.size);
        if (!size) return usage_error(fmt::format("--size {}: write the width and height in pixels, such as 320x240.", o_.size));
        double now = 0;
        for (const Phase& phase : phases_) {
            shown_.push_back({painted(phase.paint, size->first, size->second, o_.fov_deg), now, now + phase.seconds, &phase});
            now += phase.seconds;
        }
        // The last phase goes on for as long as wanted.
        const double end = o_.seconds.value_or(now);
        shown_.back().to_s = std::max(shown_.back().to_s, end) + 1 / o_.fps;
        const double frames = std::ceil(end * o_.fps - 1e-6);
        if (frames < 1 || frames > most_frames)
            return usage_error(fmt::format("{:g} frames are asked for; there can be 1 to {}. Change --seconds or --fps.", frames, most_frames));
        frames_ = static_cast<int>(frames);
        return plan_names();
    }
    // A folder gets names by the stimulus; else the name has a frame number in it.
    Result<void> plan_names() {
        const bool numbered = o_.output.find('%') != std::string::npos;
        pattern_ = numbered ? o_.output : (fs::path(o_.output) / fmt::format("{}_%04d.exr", entry_.name)).string();
        ENTOPTIC_TRY(name, NumberedName::parse(pattern_));
        name_ = name;
        if (!name_.has_number() || name_.has_time() || fs::path(pattern_).extension() != ".exr")
            return usage_error(fmt::format("'{}': name a folder, or pictures with a frame number such as {}_%04d.exr.", o_.output, entry_.name));
        const fs::path folder = fs::path(pattern_).parent_path();
        std::error_code error;
        if (!folder.empty() && !fs::is_directory(folder) && (numbered || !fs::create_directories(folder, error)))
            return failure(fmt::format("There is no folder '{}' to write to. Make it first.", folder.string()));
        trace_ = (folder / fmt::format("{}_trace.csv", entry_.name)).string();
        return {};
    }
    // The light of a frame is the mean over its time, so that a flash has its energy at any frame rate.
    ImageF light(int frame) const {
        const double from = frame / o_.fps, to = (frame + 1) / o_.fps;
        ImageF sum(shown_[0].picture.width, shown_[0].picture.height, 3);
        for (const Shown& s : shown_) {
            const double share = (std::min(to, s.to_s) - std::max(from, s.from_s)) * o_.fps;
            if (share < 1e-6) continue;
            if (share > 1 - 1e-6) return s.picture;
            for (std::size_t i = 0; i < sum.data.size(); ++i) sum.data[i] += static_cast<float>(share) * s.picture.data[i];
        }
        return sum;
    }
    Result<void> write(int frame) const {
        ExrAttributes attributes;
        attributes.white_luminance = 1.0f;
        attributes.text = {{"entopticVersion", ENTOPTIC_VERSION}, {"entopticStimulus", entry_.name}, {"entopticSource", entry_.source}};
        attributes.numbers = {{"entopticTime", static_cast<float>(frame / o_.fps)}, {"entopticFov", static_cast<float>(o_.fov_deg)}};
        return write_exr(name_.with(frame, 0), light(frame), attributes);
    }
    Result<void> write_trace() const {
        std::ofstream out(trace_);
        out << fmt::format("# {}: {}\ntime_s,gaze_x_deg,gaze_y_deg,blink\n", entry_.name, entry_.source);
        for (int i = 0; i < frames_; ++i) {
            const double now = i / o_.fps;
            const auto shown = std::find_if(shown_.begin(), shown_.end(), [&](const Shown& s) { return now < s.to_s - 1e-6; });
            out << fmt::format("{:.9g},{:g},{:g},0\n", now, shown->phase->gaze_x_deg, shown->phase->gaze_y_deg);
        }
        if (!out.flush()) return failure(fmt::format("Cannot write '{}'. Check the permissions and the free space.", trace_));
        return {};
    }

    const Options& o_;
    const StimulusEntry& entry_;
    std::vector<Phase> phases_;
    std::vector<Shown> shown_;
    int frames_ = 0;
    std::string pattern_, trace_;
    NumberedName name_;
};

Result<int> stimulus(const Options& options) {
    if (options.name == "list") {
        for (const StimulusEntry& entry : stimuli()) fmt::print("{:18} {} ({})\n", entry.name, entry.summary, entry.source);
        return 0;
    }
    ENTOPTIC_TRY(entry, find_stimulus(options.name));
    if (options.output.empty()) return usage_error("-o is missing: name a folder, or pictures with a frame number such as in_%04d.exr.");
    ENTOPTIC_CHECK(Writer(options, *entry).run());
    return 0;
}

}  // namespace

void add_stimulus(CLI::App& app, Action& action) {
    auto o = std::make_shared<Options>();
    CLI::App* c = app.add_subcommand("stimulus", "Write what people saw in published experiments, for entoptic simulate");
    c->add_option("NAME", o->name, "Which one; 'list' tells")->required();
    c->add_option("-o,--output", o->output, "Folder, or numbered OpenEXR pictures such as in_%04d.exr; a gaze trace is written beside them");
    c->add_option("--size", o->size, "Width and height in pixels, such as 320x240");
    c->add_option("--fov", o->fov_deg, "Horizontal field of view, degrees")->check(CLI::Range(1.0, 150.0));
    c->add_option("--fps", o->fps, "Frames a second")->check(CLI::Range(1.0, 1000.0));
    c->add_option("--seconds", o->seconds, "Length; the last part goes on, or is cut")->check(CLI::Range(0.001, 3600.0));
    c->add_option("--luminance", o->stimulus.luminance, "Of the flash, field, lamp or white patch, cd/m²")->check(CLI::Range(1e-6, 1e8));
    c->add_option("--test", o->stimulus.test, "Of the second interval, cd/m² as the paper gives it")->check(CLI::Range(1e-6, 1e4));
    c->add_option("--filter", o->stimulus.filter, "Density filter before the flash: divides its light")->check(CLI::Range(1.0, 1e6));
    c->add_flag("--progress", o->progress, "Tell progress even without a terminal");
    c->callback([o, &action] { action = [o] { return stimulus(*o); }; });
}

}  // namespace entoptic::app
