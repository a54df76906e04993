#include "app/choice_json.h"

#include "app/cli/output.h"

namespace entoptic::app {

Json choice_json(const perception::Selection& selection) {
    Json all = Json::object();
    for (const perception::Choice& choice : selection.choices) {
        Json parameters = Json::object(), files = Json::object();
        for (std::size_t i = 0; i < choice.parameters.size(); ++i)
            parameters[choice.entry->parameters[i].name] = decimal(choice.parameters[i]);
        for (const auto& [name, path] : choice.files) files[name] = path;
        all[std::string(choice.entry->slot)] = {{"model", choice.entry->name}, {"parameters", parameters}, {"files", files}};
    }
    all["foveation"] = {{"inverse", name_of(selection.foveation.inverse)}, {"reduction", decimal(selection.foveation.reduction)}};
    return all;
}

}  // namespace entoptic::app
