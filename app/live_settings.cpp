#include "app/live_settings.h"

#include "app/status_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <unistd.h>

namespace entoptic::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t most_bytes = 65536, most_settings = 200, longest_text = 4096;

std::string request_file(int pid) { return fmt::format("{}/{}.set", status_folder(), pid); }

bool is_text(const Json& json) { return json.is_string() && json.get_ref<const std::string&>().size() <= longest_text; }

// The list under `key`, if it is one of short texts, or not there.
std::optional<std::vector<std::string>> texts_of(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end()) return std::vector<std::string>{};
    if (!found->is_array() || found->size() > most_settings) return {};
    std::vector<std::string> texts;
    for (const Json& item : *found) {
        if (!is_text(item)) return {};
        texts.push_back(item.get<std::string>());
    }
    return texts;
}

std::optional<LiveChoice> choice_of(const Json& object) {
    const auto models = texts_of(object, "models"), settings = texts_of(object, "settings");
    const Json preset = object.value("preset", Json(""));
    if (!models || !settings || !is_text(preset)) return {};
    return LiveChoice{preset.get<std::string>(), *models, *settings};
}

// Those of `list` that begin so go, and `item` comes last.
void replace(std::vector<std::string>& list, const std::string& beginning, const std::string& item) {
    std::erase_if(list, [&](const std::string& old) { return !beginning.empty() && old.starts_with(beginning); });
    list.push_back(item);
}

}  // namespace

LiveChoice joined(LiveChoice now, const LiveChoice& more) {
    if (!more.preset.empty()) now = {more.preset, {}, {}};
    for (const std::string& model : more.models) {
        const std::string slot = model.substr(0, model.find('='));
        replace(now.models, slot + "=", model);
        std::erase_if(now.settings, [&](const std::string& old) { return old.starts_with(slot + "."); });
    }
    for (const std::string& setting : more.settings) replace(now.settings, setting.substr(0, setting.find('=') + 1), setting);
    return now;
}

std::string text_of(const LiveChoice& choice) {
    std::vector<std::string> words;
    if (!choice.preset.empty()) words.push_back("preset " + choice.preset);
    words.insert(words.end(), choice.models.begin(), choice.models.end());
    words.insert(words.end(), choice.settings.begin(), choice.settings.end());
    return fmt::format("{}", fmt::join(words, ", "));
}

Result<void> leave_request(int pid, const SettingsRequest& request) {
    const Json json{{"id", request.id},
                    {"preset", request.choice.preset},
                    {"models", request.choice.models},
                    {"settings", request.choice.settings},
                    {"reset", request.reset},
                    {"recentre_gaze", request.recentre_gaze},
                    {"save_gaze", request.save_gaze}};
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
    const auto choice = choice_of(json);
    if (!choice) return refused("its models and settings are no lists of short texts");
    const auto is_set = [&](const char* key) { return json.value(key, Json(false)) == Json(true); };
    return SettingsRequest{json["id"].get<std::string>(), *choice, is_set("reset"), is_set("recentre_gaze"), is_set("save_gaze")};
}

Json answer_json(const SettingsAnswer& answer) {
    return {{"id", answer.id},
            {"preset", answer.choice.preset},
            {"models", answer.choice.models},
            {"settings", answer.choice.settings},
            {"error", answer.error},
            {"gaze", answer.gaze}};
}

std::optional<SettingsAnswer> answer_of(const Json& status) {
    const auto found = status.find("adjusted");
    if (found == status.end() || !found->is_object() || !found->contains("id") || !is_text((*found)["id"])) return {};
    const auto text = [&](const char* key) {
        return found->contains(key) && is_text((*found)[key]) ? (*found)[key].get<std::string>() : "";
    };
    SettingsAnswer answer{text("id"), choice_of(*found).value_or(LiveChoice{}), text("error"), text("gaze")};
    return answer;
}

}  // namespace entoptic::app
