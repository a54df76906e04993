// The graphics APIs that an application may choose from: their functions for the proc-address table, and the binding of a session.
#pragma once

#include "runtime/objects/graphics.h"
#include "runtime/objects/instance.h"
#include "runtime/openxr.h"

#include <memory>
#include <span>
#include <string_view>

namespace entoptic::runtime::graphics {

struct FunctionEntry {
    std::string_view name;
    const char* extension;
    PFN_xrVoidFunction function;
};

// Null: no function of these extensions has that name.
const FunctionEntry* find_function(std::string_view name);

// Whether the chain of XrSessionCreateInfo names a graphics device: a headless session's does not.
bool has_graphics_binding(const void* chain);

// From the chain of XrSessionCreateInfo. XR_ERROR_GRAPHICS_DEVICE_INVALID when there is no usable binding of an enabled extension;
// XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING when that extension's requirements were not asked for.
Outcome make_graphics_device(Instance& instance, const void* chain, std::unique_ptr<GraphicsDevice>& device);

}  // namespace entoptic::runtime::graphics
