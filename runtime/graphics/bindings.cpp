#include "runtime/graphics/bindings.h"

#include "runtime/graphics/opengl_functions.h"
#include "runtime/graphics/vulkan_functions.h"

namespace entoptic::runtime::graphics {

const FunctionEntry* find_function(std::string_view name) {
    for (const auto functions : {vulkan_functions(), opengl_functions()}) {
        for (const FunctionEntry& entry : functions) {
            if (entry.name == name) return &entry;
        }
    }
    return nullptr;
}

bool has_graphics_binding(const void* chain) { return has_vulkan_binding(chain) || has_opengl_binding(chain); }

Outcome make_graphics_device(Instance& instance, const void* chain, std::unique_ptr<GraphicsDevice>& device) {
    if (has_vulkan_binding(chain)) return make_vulkan_device(instance, chain, device);
    if (has_opengl_binding(chain)) return make_opengl_device(instance, chain, device);
    const auto* given = static_cast<const XrBaseInStructure*>(chain);
    return error(XR_ERROR_GRAPHICS_DEVICE_INVALID, "{}: chain XrGraphicsBindingVulkan2KHR, XrGraphicsBindingOpenGLXlibKHR or EGLMNDX",
                 given ? fmt::format("structure type {} is not a graphics binding that this runtime knows", static_cast<int>(given->type))
                       : "there is no graphics binding");
}

}  // namespace entoptic::runtime::graphics
