// How running runtimes make themselves known: one file a process, `<pid>.json`, in $XDG_RUNTIME_DIR/entoptic (else /tmp/entoptic-<uid>),
// replaced whole and removed at the end.
#pragma once

#include "base/result.h"

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace entoptic::app {

// The folder, whether or not it exists.
std::string status_folder();

class StatusFile {
public:
    // Makes the folder if need be: mode 0700, and only if it belongs to this user.
    static Result<StatusFile> create();
    StatusFile() = default;
    ~StatusFile();
    StatusFile(StatusFile&& other) noexcept;
    StatusFile& operator=(StatusFile&& other) noexcept;

    Result<void> publish(const nlohmann::ordered_json& status) const;

private:
    std::string path_;  // empty: nothing to remove
};

struct RunningRuntime {
    int pid = 0;
    nlohmann::ordered_json status;  // as published
};
// Those whose process lives; files of dead ones are removed.
std::vector<RunningRuntime> running_runtimes();

}  // namespace entoptic::app
