// Running an application under this build's runtime, with nothing installed and nothing left behind.
#pragma once

#include "base/result.h"

#include <functional>
#include <string>
#include <vector>

namespace entoptic::app {

// The runtime's manifest that belongs to this executable: in the build tree, or installed beside it. ErrorKind::missing when neither is there.
Result<std::string> find_manifest();

// A folder of mode 0700 that goes away, with all in it, when this does.
class PrivateFolder {
public:
    static Result<PrivateFolder> create();
    ~PrivateFolder();
    PrivateFolder(PrivateFolder&& other) noexcept;
    PrivateFolder& operator=(PrivateFolder&&) = delete;
    const std::string& path() const { return path_; }

private:
    explicit PrivateFolder(std::string path) : path_(std::move(path)) {}
    std::string path_;
};

// Files in the launcher's folder by which the runtime speaks to `entoptic run`.
inline constexpr const char* failure_file = "failure";       // why the runtime failed, in words
inline constexpr const char* progress_file = "progress.json";  // the report so far, written anew twice a second

struct Application {
    std::vector<std::string> command;                              // program (looked for in PATH) and arguments
    std::vector<std::pair<std::string, std::string>> environment;  // set for it, over this process's
    bool output_to_error = false;   // its standard output goes to standard error
};

struct Ending {
    int status = 0;  // its exit code, or 128 + n when signal n ended it
    bool signalled = false;
};

// Runs it to its end. It has this process's standard input and output. SIGINT and SIGTERM that come to this process alone are passed on.
// `poll` is called about ten times a second. Errors: it cannot be started.
Result<Ending> run_application(const Application& application, const std::function<void()>& poll);

}  // namespace entoptic::app
