// A person's file: how this eye differs from the default one. observers/NAME.toml in the configuration's folder:
//
//   description = "my grandfather"
//   [settings]
//   glare.age = 74
#pragma once

#include "base/result.h"
#include "perception/preset.h"

#include <string>
#include <vector>

namespace entoptic::app {

// The effects that a preset, its overrides and a person's file choose together. What the person's file says of models that are not chosen is
// left out; --set wins over the file. `observer` empty: the default eye.
Result<perception::Selection> select_effects(const std::string& preset, const std::vector<std::string>& models,
                                             const std::vector<std::string>& settings, const std::string& observer);

}  // namespace entoptic::app
