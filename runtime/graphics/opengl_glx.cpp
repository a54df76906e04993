// GLX, for windows of Xlib and of Xcb. The libraries are those that the application has loaded: an application of another graphics API never gets them.
// Xlib's macros (None, Bool, Success ...) end with this file.
#include <X11/Xlib.h>
#include <GL/glx.h>
#include <dlfcn.h>
#include <xcb/glx.h>

#define XR_USE_PLATFORM_XLIB
#define XR_USE_PLATFORM_XCB
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
    xcb_connection_t* (*XGetXCBConnection)(Display*) = nullptr;  // of libX11-xcb; null: no windows of Xcb

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
        if (void* x11_xcb = dlopen("libX11-xcb.so.1", RTLD_NOW | RTLD_LOCAL))
            XGetXCBConnection = reinterpret_cast<decltype(XGetXCBConnection)>(dlsym(x11_xcb, "XGetXCBConnection"));
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
    GlxContext(const GlxFunctions& glx, Display* display, GLXDrawable drawable, GLXContext context)
        : glx_(glx), display_(display), drawable_(drawable), context_(context) {}

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

Outcome no_libraries() {
    return error(XR_ERROR_GRAPHICS_DEVICE_INVALID,
                 "libGL.so.1, libX11.so.6 or libX11-xcb.so.1 cannot be loaded; install libgl1, libx11-6 and libx11-xcb1");
}

}  // namespace

Outcome make_glx_context(const void* chained, std::unique_ptr<OpenGlContext>& context) {
    const auto& binding = *static_cast<const XrGraphicsBindingOpenGLXlibKHR*>(chained);
    if (!binding.xDisplay || !binding.glxContext)
        return error(XR_ERROR_GRAPHICS_DEVICE_INVALID, "the OpenGL binding holds no {}", binding.xDisplay ? "glxContext" : "xDisplay");
    const GlxFunctions* glx = glx_functions();
    if (!glx) return no_libraries();
    context = std::make_unique<GlxContext>(*glx, binding.xDisplay, binding.glxDrawable, binding.glxContext);
    return XR_SUCCESS;
}

Outcome make_xcb_context(const void* chained, std::unique_ptr<OpenGlContext>& context) {
    const auto& binding = *static_cast<const XrGraphicsBindingOpenGLXcbKHR*>(chained);
    const GlxFunctions* glx = glx_functions();
    if (!glx || !glx->XGetXCBConnection) return no_libraries();
    const GLXContext current = glx->GetCurrentContext();
    // Qt 6.8 leaves the connection out.
    const bool same = current && (!binding.connection || glx->XGetXCBConnection(glx->GetCurrentDisplay()) == binding.connection);
    if (!same) {
        return error(XR_ERROR_GRAPHICS_DEVICE_INVALID,
                     "with XrGraphicsBindingOpenGLXcbKHR a GLX context of its connection must be current on the thread of xrCreateSession");
    }
    context = std::make_unique<GlxContext>(*glx, glx->GetCurrentDisplay(), glx->GetCurrentDrawable(), current);
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
