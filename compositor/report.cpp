#include "compositor/report.h"

#include <algorithm>

namespace entoptic::compositor {
namespace {

constexpr std::size_t kept_samples = 65536;  // of each stage's times: the last ones
constexpr std::size_t kept_adaptation = 8192;
constexpr std::size_t kept_errors = 100;

}  // namespace

void RunStatistics::Samples::push(double value) {
    last.push_back(static_cast<float>(value));
    if (last.size() > kept_samples) last.pop_front();
}

Distribution RunStatistics::Samples::summary() const {
    if (last.empty()) return {};
    std::vector<float> sorted(last.begin(), last.end());
    std::sort(sorted.begin(), sorted.end());
    const auto at = [&](double share) { return double(sorted[static_cast<std::size_t>(share * double(sorted.size() - 1) + 0.5)]); };
    return {at(0.5), at(0.95), at(0.99), double(sorted.back()), sorted.size()};
}

void RunStatistics::add(const FrameDescription& frame, const FrameOutcome& outcome, TimeNs light_time) {
    if (composed_ == 0) first_light_ = light_time;
    double total = 0;
    for (const StageMs& stage : outcome.gpu_ms) {
        gpu_[stage.name].push(stage.ms);
        total += stage.ms;
    }
    if (!outcome.gpu_ms.empty()) gpu_["total"].push(total);
    total = 0;
    for (const StageMs& stage : outcome.cpu_ms) {
        cpu_[stage.name].push(stage.ms);
        total += stage.ms;
    }
    if (!outcome.cpu_ms.empty()) cpu_["total"].push(total);
    latency_.push(static_cast<double>(light_time - frame.pose_time) * 1e-6);
    for (const auto& view : outcome.views) cleaned_ += view.cleaned;
    fused_ += outcome.fused;
    if (!outcome.fused && composed_ % adaptation_stride_ == 0) {
        adaptation_.push_back({seconds(light_time - first_light_), {outcome.views[0].adaptation_cd_m2, outcome.views[1].adaptation_cd_m2}});
        if (adaptation_.size() > kept_adaptation) {  // keep every second one from now on
            for (std::size_t i = 1; 2 * i < adaptation_.size(); ++i) adaptation_[i] = adaptation_[2 * i];
            adaptation_.resize((adaptation_.size() + 1) / 2);
            adaptation_stride_ *= 2;
        }
    }
    ++composed_;
}

bool RunStatistics::add_error(const std::string& message) {
    if (errors_.size() >= kept_errors || std::find(errors_.begin(), errors_.end(), message) != errors_.end()) return false;
    errors_.push_back(message);
    return true;
}

void RunStatistics::presented(TimeNs time) {
    if (first_present_ == 0) first_present_ = time;
    last_present_ = time;
}

void RunStatistics::write(RunReport& report) const {
    report.first_present = first_present_;
    report.last_present = last_present_;
    report.composed = composed_;
    report.fused = fused_;
    for (const auto& [stage, samples] : gpu_) report.gpu_ms[stage] = samples.summary();
    for (const auto& [stage, samples] : cpu_) report.cpu_ms[stage] = samples.summary();
    report.latency_ms = latency_.summary();
    report.pixels_cleaned = cleaned_;
    report.adaptation = adaptation_;
    report.errors = errors_;
}

}  // namespace entoptic::compositor
