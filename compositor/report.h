// What a session was like, for `--report` and `entoptic status`: app/ writes it as JSON under the names of docs (design/interface.md).
#pragma once

#include "compositor/frame.h"
#include "compositor/pacing.h"

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <vector>

namespace entoptic::compositor {

struct Distribution {
    double median = 0, p95 = 0, p99 = 0, max = 0;
    std::size_t samples = 0;
};

struct AdaptationSample {
    double time_s = 0;  // of the light, since the session's first
    std::array<float, eye_count> adaptation_cd_m2{};
};

struct EffectReport {
    std::uint64_t recorded = 0, gated = 0, failed = 0;  // frames
    std::string why;
};

struct RunReport {
    std::string device, driver, target;
    bool lockstep = false;
    FrameCounts frames;
    std::uint64_t composed = 0, fused = 0;               // compositions, and those that took the one-pass way
    std::map<std::string, Distribution> gpu_ms, cpu_ms;  // by stage; "total" too
    Distribution latency_ms;                             // pose sample to photons
    std::map<std::string, EffectReport> effects;         // by slot
    std::uint64_t pixels_cleaned = 0;                    // over all frames and eyes
    std::vector<AdaptationSample> adaptation;            // thinned evenly in long sessions; empty when nothing is simulated
    std::vector<std::string> errors;                     // each message once
    TimeNs first_present = 0, last_present = 0;          // when a composed frame had gone to the target, by the stopwatch; 0 without one
};

// Collects what a RunReport says. Not thread-safe.
class RunStatistics {
public:
    void add(const FrameDescription& frame, const FrameOutcome& outcome, TimeNs light_time);
    void add_cpu(const std::string& stage, double ms) { cpu_[stage].push(ms); }
    // The frame that add() took has gone to the target, at this time of a stopwatch.
    void presented(TimeNs time);
    // True when this message is new.
    bool add_error(const std::string& message);
    // Fills all that this class knows.
    void write(RunReport& report) const;

private:
    struct Samples {
        std::deque<float> last;
        void push(double value);
        Distribution summary() const;
    };
    std::map<std::string, Samples> gpu_, cpu_;
    Samples latency_;
    std::vector<AdaptationSample> adaptation_;
    std::uint64_t adaptation_stride_ = 1, composed_ = 0, fused_ = 0, cleaned_ = 0;
    TimeNs first_light_ = 0, first_present_ = 0, last_present_ = 0;
    std::vector<std::string> errors_;
};

}  // namespace entoptic::compositor
