// GLX through Xlib. The libraries are those that the application has loaded: an application of another graphics API never gets them.
// Xlib's macros (None, Bool, Success ...) end with this file.
#include <X11/Xlib.h>
#include <GL/glx.h>
#include <dlfcn.h>

#define XR_USE_PLATFORM_XLIB
#include "runtime/graphics/opengl_openxr.h"

#include "runtime/graphics/opengl_context.h"

#include <mutex>

namespace entoptic::runtime::graphics {

namespace {

struct GlxFunctions {
    decltype(&::glXGetCurrentContext) GetCurrentContext = nullptr;
    decltype(&::glXGetCurrentDisplay) GetCurrentDisplay = nullptr;
    decltype(&::glXGetCurrentDrawable) GetCurrentDrawable = nullptr;
    decltype(&::glXGetCurrentReadDrawable) GetCurrentReadDrawable = nullptr;
    decltype(&::glXMakeContextCurrent) MakeContextCurrent = nullptr;
    decltype(&::glXGetProcAddressARB) GetProcAddressARB = nullptr;
    decltype(&::XSetErrorHandler) XSetErrorHandler = nullptr;

    bool load() {
        void* gl = dlopen("libGL.so.1", RTLD_NOW | RTLD_LOCAL);
        if (!gl) gl = dlopen("libGLX.so.0", RTLD_NOW | RTLD_LOCAL);
        void* x11 = dlopen("libX11.so.6", RTLD_NOW | RTLD_LOCAL);
        if (!gl || !x11) return false;
        bool complete = true;
        const auto one = [&](void* library, auto& function, const char* name) {
            function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(dlsym(library, name));
            complete &= function != nullptr;
        };
        one(gl, GetCurrentContext, "glXGetCurrentContext");
        one(gl, GetCurrentDisplay, "glXGetCurrentDisplay");
        one(gl, GetCurrentDrawable, "glXGetCurrentDrawable");
        one(gl, GetCurrentReadDrawable, "glXGetCurrentReadDrawable");
        one(gl, MakeContextCurrent, "glXMakeContextCurrent");
        one(gl, GetProcAddressARB, "glXGetProcAddressARB");
        one(x11, XSetErrorHandler, "XSetErrorHandler");
        return complete;
    }
};

// Loaded once and never unloaded: contexts of the application live in them.
const GlxFunctions* glx_functions() {
    static const auto* loaded = [] {
        auto* functions = new GlxFunctions;
        return functions->load() ? functions : nullptr;
    }();
    return loaded;
}

// A context that another thread has is an X error, which ends the process unless somebody takes it.
class WithoutXErrors {
public:
    explicit WithoutXErrors(const GlxFunctions& glx) : lock_(mutex()), glx_(glx), before_(glx.XSetErrorHandler(&ignore)) {}
    ~WithoutXErrors() { glx_.XSetErrorHandler(before_); }
    WithoutXErrors(const WithoutXErrors&) = delete;
    WithoutXErrors& operator=(const WithoutXErrors&) = delete;

private:
    static int ignore(Display*, XErrorEvent*) { return 0; }
    static std::mutex& mutex() {
        static std::mutex one_at_a_time;  // the handler is the process's
        return one_at_a_time;
    }
    std::lock_guard<std::mutex> lock_;
    const GlxFunctions& glx_;
    XErrorHandler before_;
};

class GlxContext final : public OpenGlContext {
public:
    GlxContext(const GlxFunctions& glx, const XrGraphicsBindingOpenGLXlibKHR& binding)
        : glx_(glx), display_(binding.xDisplay), drawable_(binding.glxDrawable), context_(binding.glxContext) {}

    std::function<void()> make_current() override {
        const GLXContext before = glx_.GetCurrentContext();
        if (before == context_) return [] {};
        Display* display = before ? glx_.GetCurrentDisplay() : display_;
        const GLXDrawable draw = before ? glx_.GetCurrentDrawable() : None, read = before ? glx_.GetCurrentReadDrawable() : None;
        {
            const WithoutXErrors quiet(glx_);
            if (!glx_.MakeContextCurrent(display_, drawable_, drawable_, context_)) return {};
        }
        return [this, display, draw, read, before] {
            const WithoutXErrors quiet(glx_);
            glx_.MakeContextCurrent(display, draw, read, before);
        };
    }
    void* function(const char* name) const override {
        return reinterpret_cast<void*>(glx_.GetProcAddressARB(reinterpret_cast<const GLubyte*>(name)));
    }

private:
    const GlxFunctions& glx_;
    Display* const display_;
    const GLXDrawable drawable_;
    const GLXContext context_;
};

}  // namespace

Outcome make_glx_context(const void* chained, std::unique_ptr<OpenGlContext>& context) {
    const auto& binding = *static_cast<const XrGraphicsBindingOpenGLXlibKHR*>(chained);
    if (!binding.xDisplay || !binding.glxContext)
        return error(XR_ERROR_GRAPHICS_DEVICE_INVALID, "the OpenGL binding holds no {}", binding.xDisplay ? "glxContext" : "xDisplay");
    const GlxFunctions* glx = glx_functions();
    if (!glx) return error(XR_ERROR_GRAPHICS_DEVICE_INVALID, "libGL.so.1 or libX11.so.6 cannot be loaded; install libgl1 and libx11-6");
    context = std::make_unique<GlxContext>(*glx, binding);
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
