#include "app/launch.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

constexpr std::array forwarded_signals{SIGINT, SIGTERM, SIGHUP};

// This process's environment with the application's own on top.
std::vector<std::string> environment_for(const Application& application) {
    std::vector<std::string> all;
    for (char** entry = environ; *entry; ++entry) {
        const std::string text = *entry;
        const bool replaced = std::any_of(application.environment.begin(), application.environment.end(),
                                          [&](const auto& e) { return text.starts_with(e.first + "="); });
        if (!replaced) all.push_back(text);
    }
    for (const auto& [name, value] : application.environment) all.push_back(name + "=" + value);
    return all;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> out;
    for (std::string& text : texts) out.push_back(text.data());
    out.push_back(nullptr);
    return out;
}

// Blocks the signals that run_application() waits for, until it ends.
class BlockedSignals {
public:
    BlockedSignals() {
        sigemptyset(&set_);
        sigaddset(&set_, SIGCHLD);
        for (const int signal : forwarded_signals) sigaddset(&set_, signal);
        pthread_sigmask(SIG_BLOCK, &set_, &before_);
    }
    ~BlockedSignals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    BlockedSignals(const BlockedSignals&) = delete;
    BlockedSignals& operator=(const BlockedSignals&) = delete;
    const sigset_t& set() const { return set_; }
    const sigset_t& before() const { return before_; }

private:
    sigset_t set_{}, before_{};
};

Result<pid_t> spawn(const Application& application, const sigset_t& mask) {
    auto command = application.command;
    auto environment = environment_for(application);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &mask);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    if (application.output_to_error) posix_spawn_file_actions_adddup2(&files, STDERR_FILENO, STDOUT_FILENO);
    pid_t pid = 0;
    const int error =
        posix_spawnp(&pid, command[0].c_str(), &files, &attributes, pointers(command).data(), pointers(environment).data());
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
    if (error != 0) return failure(fmt::format("Cannot start '{}': {}. Check the name and the path.", command[0], std::strerror(error)));
    return pid;
}

// The terminal sends its signals to the application itself, as it is in the same process group; what a process sent, only this one got.
void pass_on(pid_t pid, const siginfo_t& info) {
    if (info.si_code <= 0) kill(pid, info.si_signo);
}

}  // namespace

Result<std::string> find_manifest() {
    std::error_code error;
    const fs::path executable = fs::read_symlink("/proc/self/exe", error);
    const fs::path root = executable.parent_path().parent_path();
    for (const fs::path& path : {root / "openxr_entoptic-dev.json", root / "share/openxr/1/openxr_entoptic.json"})
        if (fs::exists(path, error)) return path.string();
    return missing(fmt::format(
        "The runtime's manifest is neither '{0}/openxr_entoptic-dev.json' (build tree) nor '{0}/share/openxr/1/openxr_entoptic.json' "
        "(installed). Build the target openxr_entoptic, or install again.",
        root.string()));
}

Result<PrivateFolder> PrivateFolder::create() {
    const char* runtime = std::getenv("XDG_RUNTIME_DIR");
    std::string path = fmt::format("{}/entoptic-run-XXXXXX", runtime && runtime[0] == '/' && fs::is_directory(runtime) ? runtime : "/tmp");
    if (!mkdtemp(path.data()))
        return failure(
            fmt::format("Cannot make a folder like '{}': {}. Free some room, or set XDG_RUNTIME_DIR.", path, std::strerror(errno)));
    return PrivateFolder(std::move(path));
}

PrivateFolder::~PrivateFolder() {
    std::error_code error;
    if (!path_.empty()) fs::remove_all(path_, error);
}
PrivateFolder::PrivateFolder(PrivateFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}

Result<Ending> run_application(const Application& application, const std::function<void()>& poll) {
    const BlockedSignals blocked;
    ENTOPTIC_TRY(pid, spawn(application, blocked.before()));
    const timespec tick{0, 100'000'000};
    while (true) {
        int status = 0;
        if (waitpid(pid, &status, WNOHANG) == pid) {
            if (WIFSIGNALED(status)) return Ending{128 + WTERMSIG(status), true};
            return Ending{WEXITSTATUS(status), false};
        }
        siginfo_t info{};
        const int signal = sigtimedwait(&blocked.set(), &info, &tick);
        if (signal > 0 && signal != SIGCHLD) pass_on(pid, info);
        poll();
    }
}

}  // namespace entoptic::app
