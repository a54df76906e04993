// The application's OpenGL for tests: contexts of GLX on an X server of the test's own, and of EGL without any. Header-only. To be included
// before runtime/testing/client.h, and after gtest: Xlib's macros end with this file.
#pragma once

#include <gtest/gtest.h>

#define GL_GLEXT_PROTOTYPES
#include <X11/Xlib.h>
#include <GL/glx.h>
#include <GL/glext.h>
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>
#include <xcb/glx.h>
#undef None
#undef Bool
#undef Status
#undef Success
#undef Always
#undef True
#undef False

#include <vulkan/vulkan_core.h>

#define XR_USE_GRAPHICS_API_VULKAN
#define XR_USE_PLATFORM_XLIB
#define XR_USE_PLATFORM_XCB
#define XR_USE_PLATFORM_EGL
#include "runtime/graphics/opengl_openxr.h"

namespace entoptic::runtime::testing {

class GlxApplication {
public:
    explicit GlxApplication(const std::string& display_name) : display(XOpenDisplay(display_name.c_str())) {
        if (!display) return;
        const int wanted[] = {GLX_RENDER_TYPE, GLX_RGBA_BIT, GLX_DRAWABLE_TYPE, GLX_PBUFFER_BIT, GLX_RED_SIZE, 8, 0};
        int count = 0;
        GLXFBConfig* found = glXChooseFBConfig(display, DefaultScreen(display), wanted, &count);
        if (found && count > 0) config = found[0];
        if (found) XFree(found);
        if (!config) return;
        context = make_context();
        const int size[] = {GLX_PBUFFER_WIDTH, 16, GLX_PBUFFER_HEIGHT, 16, 0};
        drawable = glXCreatePbuffer(display, config, size);
    }
    ~GlxApplication() {
        if (!display) return;
        unbind();
        if (context) glXDestroyContext(display, context);
        if (drawable) glXDestroyPbuffer(display, drawable);
        XCloseDisplay(display);
    }
    GlxApplication(const GlxApplication&) = delete;
    GlxApplication& operator=(const GlxApplication&) = delete;

    GLXContext make_context() const { return glXCreateNewContext(display, config, GLX_RGBA_TYPE, nullptr, 1); }
    bool bind() { return bind(context); }
    bool bind(GLXContext which) { return glXMakeContextCurrent(display, drawable, drawable, which) != 0; }
    void unbind() { glXMakeContextCurrent(display, 0, 0, nullptr); }
    XrGraphicsBindingOpenGLXlibKHR binding() const {
        XrGraphicsBindingOpenGLXlibKHR binding{XR_TYPE_GRAPHICS_BINDING_OPENGL_XLIB_KHR};
        binding.xDisplay = display;
        binding.glxFBConfig = config;
        binding.glxDrawable = drawable;
        binding.glxContext = context;
        return binding;
    }

    XrGraphicsBindingOpenGLXcbKHR xcb_binding() const {
        void* library = dlopen("libX11-xcb.so.1", RTLD_NOW);
        const auto connection_of =
            reinterpret_cast<xcb_connection_t* (*)(Display*)>(library ? dlsym(library, "XGetXCBConnection") : nullptr);
        XrGraphicsBindingOpenGLXcbKHR binding{XR_TYPE_GRAPHICS_BINDING_OPENGL_XCB_KHR};
        binding.connection = connection_of ? connection_of(display) : nullptr;
        binding.glxDrawable = static_cast<xcb_glx_drawable_t>(drawable);
        return binding;
    }

    Display* display = nullptr;
    GLXFBConfig config = nullptr;
    GLXContext context = nullptr;  // null: there is no OpenGL here
    GLXPbuffer drawable = 0;
};

class EglApplication {
public:
    EglApplication() : display(eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)) {
        if (!display || !eglInitialize(display, nullptr, nullptr)) return;
        eglBindAPI(EGL_OPENGL_API);
        context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, nullptr);
    }
    ~EglApplication() {
        if (context) {
            unbind();
            eglDestroyContext(display, context);
        }
        if (display) eglTerminate(display);
    }
    EglApplication(const EglApplication&) = delete;
    EglApplication& operator=(const EglApplication&) = delete;

    bool bind() { return eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) != 0; }
    void unbind() { eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT); }
    XrGraphicsBindingEGLMNDX binding() const {
        return {XR_TYPE_GRAPHICS_BINDING_EGL_MNDX, nullptr, &eglGetProcAddress, display, EGL_NO_CONFIG_KHR, context};
    }

    EGLDisplay display = EGL_NO_DISPLAY;
    EGLContext context = EGL_NO_CONTEXT;
};

}  // namespace entoptic::runtime::testing
