// The extensions this runtime offers.
#pragma once

#include "entoptic/XR_ENTOPTICX_observer.h"
#include "entoptic/XR_ENTOPTICX_presentation_timing.h"
#include "entoptic/XR_ENTOPTICX_scene_luminance.h"
#include "runtime/openxr.h"

#include <cstdint>
#include <span>

namespace entoptic::runtime::api {

struct Extension {
    const char* name;
    std::uint32_t version;
    const char* needs = nullptr;  // another extension that must be enabled with it
};

std::span<const Extension> extensions();

}  // namespace entoptic::runtime::api
