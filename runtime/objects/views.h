// The view configurations of the headset: two eyes, or two eyes with an inset each that follows the gaze.
#pragma once

#include "interfaces/runtime_host.h"
#include "runtime/objects/features.h"
#include "runtime/openxr.h"

#include <array>
#include <cstddef>
#include <span>

namespace entoptic::runtime {

constexpr std::size_t most_views = 4;

// What an application with these features is offered, preferred first.
std::span<const XrViewConfigurationType> view_configurations(Features enabled);
// 2, or 4: both eyes, then both insets.
std::size_t view_count(XrViewConfigurationType type);

struct ViewSize {
    std::uint32_t width = 0, height = 0;
};
// Texels of a view that suit the display.
ViewSize recommended_view_size(const RuntimeHost& host, XrViewConfigurationType type, std::size_t view, Headset& headset);

// The field of view of every view at `time`. An inset lies inside its eye's view, about the gaze when an eye tracker measures it.
std::array<Fov, most_views> view_fovs(Headset& headset, XrViewConfigurationType type, TimeNs time);

}  // namespace entoptic::runtime
