#include "runtime/graphics/opengl_openxr.h"

#include "runtime/graphics/opengl_functions.h"

#include "runtime/api/call.h"
#include "runtime/api/verify.h"
#include "runtime/graphics/opengl_context.h"
#include "runtime/graphics/opengl_device.h"

#include <utility>

namespace entoptic::runtime::graphics {

namespace {

constexpr const char* enable = XR_KHR_OPENGL_ENABLE_EXTENSION_NAME;
constexpr const char* enable_egl = "XR_MNDX_egl_enable";

XrResult XRAPI_CALL get_opengl_graphics_requirements(XrInstance handle, XrSystemId system, XrGraphicsRequirementsOpenGLKHR* out) {
    return api::call("xrGetOpenGLGraphicsRequirementsKHR", handle, [&]() -> Outcome {
        std::shared_ptr<Instance> instance;
        ENTOPTIC_XR_TRY(api::find(handle, instance));
        ENTOPTIC_XR_TRY(api::check_system(system));
        ENTOPTIC_XR_TRY(api::require(out, XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR, "graphicsRequirements"));
        out->minApiVersionSupported = XR_MAKE_VERSION(3, 2, 0);  // fences and glGetStringi
        out->maxApiVersionSupported = XR_MAKE_VERSION(4, 6, 0);
        instance->note_graphics_requirements(GraphicsApi::opengl);
        return XR_SUCCESS;
    });
}

const FunctionEntry entries[] = {
    {"xrGetOpenGLGraphicsRequirementsKHR", enable,
     reinterpret_cast<PFN_xrVoidFunction>(static_cast<PFN_xrGetOpenGLGraphicsRequirementsKHR>(get_opengl_graphics_requirements))},
};

using MakeContext = Outcome (*)(const void*, std::unique_ptr<OpenGlContext>&);

// Who makes a context of the chain's binding, and that binding; null without one.
std::pair<MakeContext, const void*> find_binding(const void* chain) {
    constexpr std::pair<XrStructureType, MakeContext> kinds[] = {{XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR, &make_glx_context},
                                                                 {XR_TYPE_GRAPHICS_BINDING_OPENGL_XCB_KHR, &make_xcb_context},
                                                                 {XR_TYPE_GRAPHICS_BINDING_EGL_MNDX, &make_egl_context}};
    for (const auto& [type, make] : kinds) {
        if (const void* binding = api::find_in_chain(chain, type)) return {make, binding};
    }
    return {};
}

}  // namespace

std::span<const FunctionEntry> opengl_functions() { return entries; }

bool has_opengl_binding(const void* chain) { return find_binding(chain).second != nullptr; }

Outcome make_opengl_device(Instance& instance, const void* chain, std::unique_ptr<GraphicsDevice>& device) {
    const auto [make, binding] = find_binding(chain);
    const bool egl = make == &make_egl_context;
    if (!instance.enabled(enable) || (egl && !instance.enabled(enable_egl))) {
        return error(XR_ERROR_GRAPHICS_DEVICE_INVALID, "the session's OpenGL binding needs the extension {}{}", enable,
                     egl ? " and XR_MNDX_egl_enable" : "");
    }
    if (!instance.graphics_requirements_asked(GraphicsApi::opengl)) {
        return error(XR_ERROR_GRAPHICS_REQUIREMENTS_CALL_MISSING, "call xrGetOpenGLGraphicsRequirementsKHR before xrCreateSession");
    }
    std::unique_ptr<OpenGlContext> context;
    ENTOPTIC_XR_TRY(make(binding, context));
    return OpenGlDevice::create(std::move(context), instance.host(), device);
}

}  // namespace entoptic::runtime::graphics
