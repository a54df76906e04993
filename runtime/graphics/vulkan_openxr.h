// vulkan.h and the Vulkan part of openxr_platform.h: for runtime/graphics/ only, and before any other include of OpenXR headers.
#pragma once

#include <vulkan/vulkan_core.h>

#define XR_USE_GRAPHICS_API_VULKAN
#include "runtime/openxr.h"
