// A person's file: how this eye differs from the default one. observers/NAME.toml in the configuration's folder:
//
//   description = "my grandfather"
//   [settings]
//   glare.age = 74
//
// Some come with the program (built_in_observers()); a file of the same name takes their place. Whose own eye looks at the display is said by
// glare.wearer_age, wearer_pigment and wearer_straylight_factor; where the file does not say, it is the mean eye of 30 years, so that a person
// who differs from it is seen to do so in every picture, ordinary ones included. docs/observers.md is the page for people.
#pragma once

#include "base/result.h"
#include "perception/doubling.h"

#include <span>
#include <string>
#include <vector>

namespace entoptic::app {

struct BuiltInObserver {
    const char* name;
    const char* toml;     // as a file would hold it, with its sources
};
std::span<const BuiltInObserver> built_in_observers();

// The effects that a preset, its overrides and a person's file choose together. What the person's file says of models that are not chosen is
// left out, but must be a parameter that some model of the slot has, and in its range; --set wins over the file. `observer` empty: the default eye. A choice that counts an effect twice for this viewer is an error.
Result<perception::Selection> select_effects(const std::string& preset, const std::vector<std::string>& models,
                                             const std::vector<std::string>& settings, const std::string& observer, perception::Viewer viewer);

}  // namespace entoptic::app
