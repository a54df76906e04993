#include "perception/model.h"

#include <algorithm>

namespace entoptic::perception {

const ModelEntry* find_model(std::string_view slot, std::string_view name) {
    const auto table = models();
    const auto found = std::find_if(table.begin(), table.end(), [&](const ModelEntry* e) { return e->slot == slot && e->name == name; });
    return found == table.end() ? nullptr : *found;
}

std::vector<std::string_view> slots() {
    std::vector<std::string_view> list;
    for (const ModelEntry* entry : models())
        if (std::find(list.begin(), list.end(), entry->slot) == list.end()) list.push_back(entry->slot);
    return list;
}

std::vector<float> default_parameters(const ModelEntry& entry) {
    std::vector<float> values;
    for (const ParameterInfo& parameter : entry.parameters) values.push_back(parameter.default_value);
    return values;
}

bool names_file(std::string_view slot, std::string_view name) {
    for (const ModelEntry* entry : models())
        for (const FileInfo& file : entry->files)
            if (entry->slot == slot && name == file.name) return true;
    return false;
}

}  // namespace entoptic::perception
