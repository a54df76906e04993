#include "app/host/session_report.h"

#include "app/choice_json.h"
#include "app/cli/output.h"

#include <algorithm>
#include <fmt/format.h>
#include <sys/resource.h>

namespace entoptic::app {
namespace {

Json distribution_json(const compositor::Distribution& d) {
    return {{"median", d.median}, {"p95", d.p95}, {"p99", d.p99}, {"max", d.max}, {"samples", d.samples}};
}

Json timing_json(const compositor::RunReport& report) {
    Json stages = Json::object();
    for (const auto& [stage, times] : report.cpu_ms) stages[stage]["cpu"] = distribution_json(times);
    for (const auto& [stage, times] : report.gpu_ms) stages[stage]["gpu"] = distribution_json(times);
    return stages;
}

Json application_json(const ApplicationIdentity& application) {
    return {{"name", application.name},
            {"engine", application.engine},
            {"application_version", application.application_version},
            {"engine_version", application.engine_version},
            {"api_version", fmt::format("{}.{}.{}", application.api_version >> 48, (application.api_version >> 32) & 0xffff,
                                        application.api_version & 0xffffffff)},
            {"extensions", application.extensions}};
}

Json frames_json(const compositor::RunReport& report) {
    return {{"submitted", report.frames.submitted},
            {"displayed", report.frames.displayed},
            {"reused", report.frames.reused},
            {"missed", report.frames.missed},
            {"discarded", report.frames.discarded},
            {"unseen", report.frames.unseen},
            {"composed", report.composed},
            {"fused", report.fused}};
}

Json photometry_json(const SessionFacts& facts, const compositor::RunReport& report) {
    Json photometry = {{"scale", decimal(facts.luminance.cd_per_unit)},
                       {"offset", decimal(facts.luminance.offset_cd)},
                       {"source", luminance_source(facts)},
                       {"display", facts.config.display.value.empty() ? "nominal panel: BT.709, sRGB" : facts.config.display.value},
                       {"pixels_cleaned", report.pixels_cleaned}};
    if (facts.luminance.source == LuminanceSource::default_sdr)
        photometry["note"] = "nothing in an SDR picture is brighter than the panel: lamps that the application tone-mapped cannot glare";
    return photometry;
}

// Every effect that was chosen, also those of which no frame ever asked.
Json effect_totals_json(const SessionFacts& facts, const compositor::RunReport& report) {
    Json effects = Json::object();
    const auto add = [&](const std::string& slot, std::string_view model) {
        const auto found = report.effects.find(slot);
        const compositor::EffectReport total =
            found == report.effects.end() ? compositor::EffectReport{0, 0, 0, "no frame needed it"} : found->second;
        effects[slot] = {{"model", model},
                         {"recorded", total.recorded},
                         {"gated", total.gated},
                         {"failed", total.failed},
                         {"why", total.why}};
    };
    for (const perception::Choice& choice : facts.selection.choices) add(std::string(choice.entry->slot), choice.entry->name);
    if (facts.selection.foveation.inverse != perception::FoveationInverse::off) add("foveation", name_of(facts.selection.foveation.inverse));
    return effects;
}

Json state_json(const compositor::RunReport& report) {
    Json samples = Json::array();
    for (const compositor::AdaptationSample& s : report.adaptation)
        samples.push_back({{"time_s", s.time_s}, {"left", decimal(s.adaptation_cd_m2[0])}, {"right", decimal(s.adaptation_cd_m2[1])}});
    return {{"adaptation_cd_m2", samples}};
}

Json effects_now_json(const SessionFacts& facts, const compositor::FrameOutcome& last) {
    Json effects = Json::array();
    // The last frame may be older than the choice.
    const auto chosen = [&](const perception::EffectOutcome& e) {
        const perception::Choice* choice = facts.selection.find(e.slot);
        return choice ? choice->entry->name == e.model : e.slot == "foveation";
    };
    for (const perception::EffectOutcome& e : last.effects)
        if (chosen(e)) effects.push_back({{"slot", e.slot}, {"model", e.model}, {"on", e.recorded && !e.gated}, {"why", e.why}});
    const auto told = [&](std::string_view slot) {
        return std::any_of(last.effects.begin(), last.effects.end(),
                           [&](const perception::EffectOutcome& e) { return e.slot == slot && chosen(e); });
    };
    for (const perception::Choice& choice : facts.selection.choices)
        if (!told(choice.entry->slot))
            effects.push_back(
                {{"slot", choice.entry->slot}, {"model", choice.entry->name}, {"on", false}, {"why", "no frame has needed it yet"}});
    for (const auto slot : perception::slots())
        if (!facts.selection.find(slot))
            effects.push_back(
                {{"slot", slot}, {"model", "none"}, {"on", false}, {"why", fmt::format("not chosen (preset {})", facts.selection.preset)}});
    return effects;
}

// Of the whole process, application and runtime.
Json process_json(const SessionFacts& facts, const compositor::RunReport& report) {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    Json process = {{"peak_memory_mib", static_cast<double>(usage.ru_maxrss) / 1024}};  // ru_maxrss is in KiB on Linux
    if (report.first_present > 0) process["first_frame_s"] = seconds(report.first_present - facts.started);
    if (report.composed > 1) process["frames_per_s"] = static_cast<double>(report.composed - 1) / seconds(report.last_present - report.first_present);
    return process;
}

std::string device_text(const compositor::RunReport& report) { return fmt::format("{} ({})", report.device, report.driver); }

}  // namespace

std::string luminance_source(const SessionFacts& facts) {
    if (facts.luminance.source == LuminanceSource::layer_extension) return "layer: XR_ENTOPTICX_scene_luminance";
    if (facts.luminance.source == LuminanceSource::default_sdr) return "default: white of an SDR layer is the panel's white";
    return facts.config.luminance.origin;
}

Json report_json(const SessionFacts& facts, const compositor::RunReport& report, const std::vector<std::string>& errors) {
    return {{"version", ENTOPTIC_VERSION},
            {"device", device_text(report)},
            {"hmd", facts.hmd},
            {"target", report.target},
            {"clock", report.lockstep ? "lockstep" : "real"},
            {"preset", facts.selection.preset},
            {"observer", facts.config.observer.value},
            {"models", facts.config.model_names()},
            {"settings", facts.config.setting_texts()},
            {"chosen", choice_json(facts.selection)},
            {"script", facts.config.script.value},
            {"seed", facts.config.seed.value},
            {"application", application_json(facts.application)},
            {"frames", frames_json(report)},
            {"timing_ms", timing_json(report)},
            {"latency_ms", distribution_json(report.latency_ms)},
            {"process", process_json(facts, report)},
            {"effects", effect_totals_json(facts, report)},
            {"adjusted", answer_json(facts.adjusted)},
            {"photometry", photometry_json(facts, report)},
            {"state", state_json(report)},
            {"errors", errors}};
}

Json status_json(const SessionFacts& facts, const compositor::RunReport& report, const compositor::FrameOutcome& last,
                 const std::vector<std::string>& errors) {
    return {{"version", ENTOPTIC_VERSION},
            {"application", {{"name", facts.application.name}, {"engine", facts.application.engine}}},
            {"device", device_text(report)},
            {"hmd", facts.hmd},
            {"headset", {{"present", facts.headset.present}, {"why", facts.headset.present ? facts.hmd : facts.headset.why}}},
            {"target", report.target},
            {"clock", report.lockstep ? "lockstep" : "real"},
            {"eye_tracker", {{"present", facts.eye_tracker_present}, {"why", facts.eye_tracker}}},
            {"cameras", {{"present", false}, {"why", "eye cameras are under eye_tracker; other cameras have no driver yet"}}},
            {"frames", frames_json(report)},
            {"effects", effects_now_json(facts, last)},
            {"adjusted", answer_json(facts.adjusted)},
            {"photometry", photometry_json(facts, report)},
            {"errors", errors}};
}

}  // namespace entoptic::app
