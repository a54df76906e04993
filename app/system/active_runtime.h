// Which OpenXR runtime applications of this user get, as the loader looks for it, and making it this one with a way back.
#pragma once

#include "base/result.h"

#include <optional>
#include <string>
#include <vector>

namespace entoptic::app {

struct RuntimeChoice {
    std::string file;     // the manifest the loader reads: XR_RUNTIME_JSON, or an active_runtime.json; empty when there is none
    std::string target;   // where it leads, links followed
    std::string library;  // its library_path, absolute where it is a path; empty when the file cannot be read
    std::string source;   // "XR_RUNTIME_JSON", or the folder's role, for people
    bool ours = false;    // it is this build's manifest
};

class ActiveRuntime {
public:
    // The user's own folders and the system's, from the environment.
    static ActiveRuntime of_user();
    // `user_folder` is what XDG_CONFIG_HOME stands for; `system_folders` in the loader's order.
    ActiveRuntime(std::string user_folder, std::vector<std::string> system_folders, std::optional<std::string> forced);

    // The first of the loader's places that holds one.
    RuntimeChoice current(const std::string& our_manifest) const;
    // Makes `our_manifest` the user's; what was there is kept beside it. Nothing to do is no error.
    Result<void> set(const std::string& our_manifest) const;
    // Puts back what set() found: a file, a link, or nothing. False: this runtime had not been set.
    Result<bool> restore(const std::string& our_manifest) const;

    std::string user_file() const;  // active_runtime.json
    std::string kept_file() const;  // what was there before

private:
    std::string user_folder_;
    std::vector<std::string> system_folders_;
    std::optional<std::string> forced_;
};

}  // namespace entoptic::app
