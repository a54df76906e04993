// What a session was like, as JSON: the report of `entoptic run --report`, and what `entoptic status` shows while it runs.
#pragma once

#include "app/config.h"
#include "app/live_settings.h"
#include "compositor/report.h"
#include "compositor/service.h"
#include "interfaces/runtime_host.h"
#include "interfaces/sources.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace entoptic::app {

// What is known of a session beside the compositor's own report.
struct SessionFacts {
    ApplicationIdentity application;
    Config config;
    std::string hmd;  // DisplayIdentity::name
    HeadsetStatus headset;             // now
    bool eye_tracker_present = false;  // now
    std::string eye_tracker;   // what it is, how it does, or why it is absent
    LayerLuminance luminance;  // for layers that do not say
    perception::Selection selection;
    SettingsAnswer adjusted;  // to the last `entoptic set`
    TimeNs started = 0;       // xrCreateInstance, CLOCK_MONOTONIC
};

// Where the luminance of the layers comes from, in words.
std::string luminance_source(const SessionFacts& facts);

// `errors`: of the whole runtime; the report's own are among them.
nlohmann::ordered_json report_json(const SessionFacts& facts, const compositor::RunReport& report, const std::vector<std::string>& errors);
nlohmann::ordered_json status_json(const SessionFacts& facts, const compositor::RunReport& report, const compositor::FrameOutcome& last,
                                   const std::vector<std::string>& errors);

}  // namespace entoptic::app
