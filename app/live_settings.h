// Parameters changed while a runtime runs: `entoptic set` leaves a request beside the runtime's status, `<pid>.set` in status_folder(); the
// runtime takes it, applies all of it or nothing, and answers in its status.
#pragma once

#include "base/result.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace entoptic::app {

struct SettingsRequest {
    std::string id;                     // the answer names it
    std::vector<std::string> settings;  // "glare.age=70"; they go on top of those that are in force
    bool reset = false;                 // first go back to what the runtime was started with
};

// Leaves a request for the runtime of this process, whole; an older one that it has not taken goes. Errors: the folder cannot be written.
Result<void> leave_request(int pid, const SettingsRequest& request);
// Takes the request that lies there away; none when there is none. Errors: what lies there is no request (and is gone now).
Result<std::optional<SettingsRequest>> take_request(int pid);

// The runtime's answer, part "adjusted" of its status.
struct SettingsAnswer {
    std::string id;
    std::vector<std::string> settings;  // in force on top of what the runtime was started with
    std::string error;                  // why the request changed nothing; empty: it was done
};
nlohmann::ordered_json answer_json(const SettingsAnswer& answer);
// None when the status has no such answer.
std::optional<SettingsAnswer> answer_of(const nlohmann::ordered_json& status);

}  // namespace entoptic::app
