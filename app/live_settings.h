// Models and parameters changed while a runtime runs: `entoptic set` leaves a request beside the runtime's status, `<pid>.set` in status_folder(); the
// runtime takes it, applies all of it or nothing, and answers in its status.
#pragma once

#include "base/result.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace entoptic::app {

// On top of the choice that a runtime was started with.
struct LiveChoice {
    std::string preset;                 // instead of that whole choice; empty: it stands
    std::vector<std::string> models;    // "glare=cie135"
    std::vector<std::string> settings;  // "glare.age=70"
};
// `more` on top of `now`: a preset ends all before it, a model the settings of its slot, a setting the one of the same name.
LiveChoice joined(LiveChoice now, const LiveChoice& more);
// A choice in words, as one would type it; empty for none.
std::string text_of(const LiveChoice& choice);

struct SettingsRequest {
    std::string id;                                 // the answer names it
    LiveChoice choice;                              // goes on top of what is in force
    bool reset = false;                             // first go back to what the runtime was started with
    bool recentre_gaze = false, save_gaze = false;  // what the wearer looks at now is the centre; and keep that in the observer's file
};

// Leaves a request for the runtime of this process, whole; an older one that it has not taken goes. Errors: the folder cannot be written.
Result<void> leave_request(int pid, const SettingsRequest& request);
// Takes the request that lies there away; none when there is none. Errors: what lies there is no request (and is gone now).
Result<std::optional<SettingsRequest>> take_request(int pid);

// The runtime's answer, part "adjusted" of its status.
struct SettingsAnswer {
    std::string id;
    LiveChoice choice;  // in force
    std::string error;  // why the request changed nothing; empty: it was done
    std::string gaze;   // what re-centring changed; empty: it was not asked for
};
nlohmann::ordered_json answer_json(const SettingsAnswer& answer);
// None when the status has no such answer.
std::optional<SettingsAnswer> answer_of(const nlohmann::ordered_json& status);

}  // namespace entoptic::app
