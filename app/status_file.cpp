#include "app/status_file.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

std::string file_of(int pid) { return fmt::format("{}/{}.json", status_folder(), pid); }

// In /tmp anybody may have made the folder first: take it only if it is this user's own, and no link.
Result<void> make_private_folder(const std::string& path) {
    if (mkdir(path.c_str(), 0700) != 0 && errno != EEXIST)
        return failure(
            fmt::format("Cannot make the folder '{}': {}. `entoptic status` will not see this runtime.", path, std::strerror(errno)));
    struct stat info {};
    if (lstat(path.c_str(), &info) != 0 || !S_ISDIR(info.st_mode) || info.st_uid != getuid() || (info.st_mode & 0022) != 0)
        return failure(fmt::format("'{}' is not a private folder of this user. Remove it, or set XDG_RUNTIME_DIR.", path));
    return {};
}

bool alive(int pid) { return kill(pid, 0) == 0 || errno == EPERM; }

// The process a file of the folder belongs to: <pid>.json, its unfinished successor <pid>.json.part, a request <pid>.set. 0: no such file.
int pid_of(const fs::path& path) {
    const std::string name = path.filename();
    const std::string number = name.substr(0, name.find('.'));
    const std::string_view rest = std::string_view(name).substr(number.size());
    if (rest != ".json" && rest != ".json.part" && rest != ".set") return 0;
    if (number.empty() || number.size() > 9 || number.find_first_not_of("0123456789") != std::string::npos) return 0;
    return std::stoi(number);
}

}  // namespace

std::string status_folder() {
    const char* runtime = std::getenv("XDG_RUNTIME_DIR");
    return runtime && runtime[0] == '/' ? fmt::format("{}/entoptic", runtime) : fmt::format("/tmp/entoptic-{}", getuid());
}

Result<StatusFile> StatusFile::create() {
    ENTOPTIC_CHECK(make_private_folder(status_folder()));
    StatusFile file;
    file.path_ = file_of(getpid());
    return file;
}

StatusFile::~StatusFile() {
    if (!path_.empty()) unlink(path_.c_str());
}
StatusFile::StatusFile(StatusFile&& other) noexcept : path_(std::exchange(other.path_, {})) {}
StatusFile& StatusFile::operator=(StatusFile&& other) noexcept {
    std::swap(path_, other.path_);
    return *this;
}

Result<void> StatusFile::publish(const nlohmann::ordered_json& status) const {
    const std::string part = path_ + ".part";
    {
        std::ofstream out(part, std::ios::trunc);
        out << status.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) << '\n';
        out.close();
        if (!out) return failure(fmt::format("Cannot write '{}'. Check that there is room.", part));
    }
    if (std::rename(part.c_str(), path_.c_str()) != 0) return failure(fmt::format("Cannot write '{}': {}.", path_, std::strerror(errno)));
    return {};
}

std::vector<RunningRuntime> running_runtimes() {
    std::vector<RunningRuntime> found;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(status_folder(), error)) {
        const int pid = pid_of(entry.path());
        if (pid <= 0) continue;
        if (!alive(pid)) {
            fs::remove(entry.path(), error);
            continue;
        }
        if (entry.path().extension() != ".json") continue;
        std::ifstream in(entry.path());
        auto status = nlohmann::ordered_json::parse(in, nullptr, false);
        if (status.is_object()) found.push_back({pid, std::move(status)});
    }
    return found;
}

}  // namespace entoptic::app
