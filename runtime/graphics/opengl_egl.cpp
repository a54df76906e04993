// EGL (XR_MNDX_egl_enable), through the application's own eglGetProcAddress.
#define EGL_NO_X11
#include <EGL/egl.h>

#define XR_USE_PLATFORM_EGL
#include "runtime/graphics/opengl_openxr.h"

#include "runtime/graphics/opengl_context.h"

namespace entoptic::runtime::graphics {

namespace {

struct EglFunctions {
    PFNEGLGETPROCADDRESSPROC GetProcAddress = nullptr;
    decltype(&::eglGetCurrentContext) GetCurrentContext = nullptr;
    decltype(&::eglGetCurrentDisplay) GetCurrentDisplay = nullptr;
    decltype(&::eglGetCurrentSurface) GetCurrentSurface = nullptr;
    decltype(&::eglMakeCurrent) MakeCurrent = nullptr;
    decltype(&::eglQueryContext) QueryContext = nullptr;
    decltype(&::eglQueryAPI) QueryAPI = nullptr;
    decltype(&::eglBindAPI) BindAPI = nullptr;

    // EGL 1.5 and EGL_KHR_get_all_proc_addresses give core functions this way; both Mesa and NVIDIA have them.
    bool load(PFNEGLGETPROCADDRESSPROC get) {
        bool complete = true;
        const auto one = [&](auto& function, const char* name) {
            function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(get(name));
            complete &= function != nullptr;
        };
        GetProcAddress = get;
        one(GetCurrentContext, "eglGetCurrentContext");
        one(GetCurrentDisplay, "eglGetCurrentDisplay");
        one(GetCurrentSurface, "eglGetCurrentSurface");
        one(MakeCurrent, "eglMakeCurrent");
        one(QueryContext, "eglQueryContext");
        one(QueryAPI, "eglQueryAPI");
        one(BindAPI, "eglBindAPI");
        return complete;
    }
};

class EglContext final : public OpenGlContext {
public:
    EglContext(const EglFunctions& egl, const XrGraphicsBindingEGLMNDX& binding)
        : egl_(egl), display_(binding.display), context_(binding.context) {}

    std::function<void()> make_current() override {
        const EGLContext before = egl_.GetCurrentContext();
        if (before == context_) return [] {};
        const EGLenum api = egl_.QueryAPI();
        EGLDisplay display = before == EGL_NO_CONTEXT ? display_ : egl_.GetCurrentDisplay();
        EGLSurface draw = before == EGL_NO_CONTEXT ? EGL_NO_SURFACE : egl_.GetCurrentSurface(EGL_DRAW);
        EGLSurface read = before == EGL_NO_CONTEXT ? EGL_NO_SURFACE : egl_.GetCurrentSurface(EGL_READ);
        egl_.BindAPI(EGL_OPENGL_API);
        if (!egl_.MakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) {  // EGL_KHR_surfaceless_context
            egl_.BindAPI(api);
            return {};
        }
        return [this, display, draw, read, before, api] {
            egl_.MakeCurrent(display, draw, read, before);
            egl_.BindAPI(api);
        };
    }
    void* function(const char* name) const override { return reinterpret_cast<void*>(egl_.GetProcAddress(name)); }

private:
    const EglFunctions egl_;
    EGLDisplay const display_;
    EGLContext const context_;
};

Outcome device_invalid(const char* why) { return error(XR_ERROR_GRAPHICS_DEVICE_INVALID, "{}", why); }

}  // namespace

Outcome make_egl_context(const void* chained, std::unique_ptr<OpenGlContext>& context) {
    const auto& binding = *static_cast<const XrGraphicsBindingEGLMNDX*>(chained);
    if (!binding.getProcAddress || !binding.display || !binding.context)
        return device_invalid("the EGL binding needs getProcAddress, display and context");
    EglFunctions egl;
    if (!egl.load(binding.getProcAddress)) return device_invalid("getProcAddress does not give EGL's own functions; EGL 1.5 is needed");
    EGLint type = 0;
    if (!egl.QueryContext(binding.display, binding.context, EGL_CONTEXT_CLIENT_TYPE, &type))
        return device_invalid("the EGL binding's context is not one of its display");
    if (type != EGL_OPENGL_API) return device_invalid("the EGL context is not one of OpenGL; OpenGL ES is not offered");
    context = std::make_unique<EglContext>(egl, binding);
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
