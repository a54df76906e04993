#include "app/system/active_runtime.h"

#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

#if defined(__x86_64__)
constexpr const char* architecture = "x86_64";
#elif defined(__aarch64__)
constexpr const char* architecture = "aarch64";
#else
constexpr const char* architecture = "unknown";
#endif

constexpr const char* place = "openxr/1";

bool is_there(const fs::path& path) {
    std::error_code error;
    return fs::symlink_status(path, error).type() != fs::file_type::not_found;
}

bool same_file(const std::string& a, const std::string& b) {
    std::error_code error;
    return fs::equivalent(a, b, error);
}

std::string library_of(const std::string& manifest) {
    std::ifstream in(manifest);
    const auto json = nlohmann::json::parse(in, nullptr, false);
    if (!json.is_object() || !json.contains("runtime") || !json["runtime"].is_object()) return "";
    const auto path = json["runtime"].value("library_path", nlohmann::json());
    if (!path.is_string()) return "";
    const fs::path library = path.get<std::string>();
    if (library.is_absolute() || library.string().find('/') == std::string::npos) return library.string();
    return (fs::path(manifest).parent_path() / library).lexically_normal().string();
}

RuntimeChoice choice(const std::string& file, const std::string& source, const std::string& ours) {
    RuntimeChoice out{file, "", "", source, same_file(file, ours)};
    std::error_code error;
    out.target = fs::canonical(file, error).string();
    if (!error) out.library = library_of(out.target);
    return out;
}

std::string text_variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

std::string why(const std::error_code& error) { return error.message(); }

}  // namespace

ActiveRuntime::ActiveRuntime(std::string user_folder, std::vector<std::string> system_folders, std::optional<std::string> forced)
    : user_folder_(std::move(user_folder)), system_folders_(std::move(system_folders)), forced_(std::move(forced)) {}

ActiveRuntime ActiveRuntime::of_user() {
    std::string user = text_variable("XDG_CONFIG_HOME");
    if (user.empty()) user = text_variable("HOME") + "/.config";
    std::string list = text_variable("XDG_CONFIG_DIRS");
    if (list.empty()) list = "/etc/xdg";
    std::vector<std::string> system;
    std::stringstream stream(list);
    for (std::string folder; std::getline(stream, folder, ':');)
        if (!folder.empty()) system.push_back(folder);
    system.emplace_back("/etc");
    const std::string forced = text_variable("XR_RUNTIME_JSON");
    return {user, system, forced.empty() ? std::nullopt : std::optional(forced)};
}

std::string ActiveRuntime::user_file() const { return (fs::path(user_folder_) / place / "active_runtime.json").string(); }
std::string ActiveRuntime::kept_file() const { return user_file() + ".before-entoptic"; }

// The order of the loader (OpenXR specification, "Runtime Discovery").
RuntimeChoice ActiveRuntime::current(const std::string& ours) const {
    if (forced_) return choice(*forced_, "XR_RUNTIME_JSON", ours);
    std::vector<std::string> folders{user_folder_};
    folders.insert(folders.end(), system_folders_.begin(), system_folders_.end());
    for (const std::string& folder : folders)
        for (const std::string& name : {fmt::format("active_runtime.{}.json", architecture), std::string("active_runtime.json")})
            if (const fs::path file = fs::path(folder) / place / name; is_there(file))
                return choice(file.string(), folder == user_folder_ ? "this user's choice" : "the system's choice", ours);
    return {};
}

Result<void> ActiveRuntime::set(const std::string& ours) const {
    std::error_code error;
    if (same_file(user_file(), ours)) return {};
    fs::create_directories(fs::path(user_file()).parent_path(), error);
    if (error) return failure(fmt::format("The folder of {} cannot be made: {}.", user_file(), why(error)));
    if (is_there(user_file())) {
        if (is_there(kept_file()))
            return failure(fmt::format("{} would be lost: an earlier one is still kept in {}. Look at both, and remove one.", user_file(),
                                       kept_file()));
        fs::rename(user_file(), kept_file(), error);
        if (error) return failure(fmt::format("{} cannot be put aside: {}.", user_file(), why(error)));
    }
    fs::create_symlink(ours, user_file(), error);
    if (!error) return {};
    const std::string reason = why(error);
    if (is_there(kept_file())) fs::rename(kept_file(), user_file(), error);
    return failure(fmt::format("{} cannot be written: {}.", user_file(), reason));
}

Result<bool> ActiveRuntime::restore(const std::string& ours) const {
    std::error_code error;
    const bool set = same_file(user_file(), ours), kept = is_there(kept_file());
    if (!set && !kept) return false;
    if (!set && is_there(user_file()))
        return failure(fmt::format("{} is another runtime's by now; the one before Entoptic is in {}. Nothing was changed.", user_file(),
                                   kept_file()));
    if (set) fs::remove(user_file(), error);
    if (!error && kept) fs::rename(kept_file(), user_file(), error);
    if (error) return failure(fmt::format("{} cannot be put back: {}.", user_file(), why(error)));
    return true;
}

}  // namespace entoptic::app
