// openxr.h and openxr_platform.h with the platform parts this runtime offers. Files of runtime/graphics/ include vulkan.h and define
// XR_USE_GRAPHICS_API_VULKAN before this one (through graphics/vulkan_openxr.h); nothing else sees Vulkan.
#pragma once

#include <ctime>

#ifndef XR_USE_TIMESPEC
#define XR_USE_TIMESPEC
#endif
#include <openxr/openxr.h>
#include <openxr/openxr_platform.h>

#include "runtime/openxr_1_1.h"
