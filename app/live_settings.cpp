#include "app/live_settings.h"

#include "app/status_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace entoptic::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_bytes = 65536, most_settings = 200, longest_text = 4096;

std::string request_file(int pid) { return fmt::format("{}/{}.set", status_folder(), pid); }

bool is_text(const Json& json) { return json.is_string() && json.get_ref<const std::string&>().size() <= longest_text; }

// The list under `key`, if it is one of short texts.
std::optional<std::vector<std::string>> texts_of(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_array() || found->size() > most_settings) return {};
    std::vector<std::string> texts;
    for (const Json& item : *found) {
        if (!is_text(item)) return {};
        texts.push_back(item.get<std::string>());
    }
    return texts;
}

}  // namespace

Result<void> leave_request(int pid, const SettingsRequest& request) {
    const Json json{{"id", request.id}, {"settings", request.settings}, {"reset", request.reset}};
    const std::string path = request_file(pid), part = path + ".part";
    {
        std::ofstream out(part, std::ios::trunc);
        out << json.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
        out.close();
        if (!out) return failure(fmt::format("Cannot write '{}'. Check that the folder is this user's and that there is room.", part));
    }
    if (std::rename(part.c_str(), path.c_str()) != 0) return failure(fmt::format("Cannot write '{}': {}.", path, std::strerror(errno)));
    return {};
}

Result<std::optional<SettingsRequest>> take_request(int pid) {
    const std::string path = request_file(pid);
    std::ifstream in(path, std::ios::binary);
    if (!in) return std::nullopt;
    std::string text(most_bytes + 1, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    in.close();
    unlink(path.c_str());
    const auto refused = [&](const char* why) {
        return failure(fmt::format("'{}' was no request: {}. Write it with `entoptic set`.", path, why));
    };
    if (text.size() > most_bytes) return refused("it is too long");
    const Json json = Json::parse(text, nullptr, false);
    if (!json.is_object() || !json.contains("id") || !is_text(json["id"])) return refused("it is not JSON with an id");
    SettingsRequest request{json["id"].get<std::string>(), {}, json.value("reset", Json(false)) == Json(true)};
    const auto settings = texts_of(json, "settings");
    if (!settings) return refused("its settings are no list of short texts");
    request.settings = *settings;
    return request;
}

Json answer_json(const SettingsAnswer& answer) { return {{"id", answer.id}, {"settings", answer.settings}, {"error", answer.error}}; }

std::optional<SettingsAnswer> answer_of(const Json& status) {
    const auto found = status.find("adjusted");
    if (found == status.end() || !found->is_object() || !found->contains("id") || !is_text((*found)["id"])) return {};
    SettingsAnswer answer{(*found)["id"].get<std::string>(), texts_of(*found, "settings").value_or(std::vector<std::string>{}), ""};
    if (const auto error = found->find("error"); error != found->end() && error->is_string()) answer.error = error->get<std::string>();
    return answer;
}

}  // namespace entoptic::app
