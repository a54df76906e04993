// A choice of effects as reports hold it: all that it takes to choose it again.
#pragma once

#include "perception/preset.h"

#include <nlohmann/json.hpp>

namespace entoptic::app {

// {"glare": {"model": "cie135", "parameters": {"age": 30, ...}, "files": {}}, ..., "foveation": {"inverse": "off", "reduction": 2}}
nlohmann::ordered_json choice_json(const perception::Selection& selection);

}  // namespace entoptic::app
