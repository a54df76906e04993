// Limits the runtime reports and enforces.
#pragma once

#include "runtime/openxr.h"

#include <cstdint>

namespace entoptic::runtime::api {

constexpr XrVersion runtime_api_version = XR_MAKE_VERSION(1, 1, 41);  // the specification this runtime follows

constexpr std::uint32_t largest_swapchain_side = 16384;  // texels
constexpr std::uint32_t largest_view_side = 4096;        // what a view can make use of, and three images of which fit in memory
constexpr std::uint32_t most_array_layers = 2048;

}  // namespace entoptic::runtime::api
