// The application's OpenGL context, whatever its window system. "Threading" of XR_KHR_opengl_enable: the runtime may use it in the calls
// that create, destroy, acquire, wait for and release, in xrBeginFrame and xrEndFrame; in those it is current on the calling thread or on none.
#pragma once

#include "runtime/objects/outcome.h"

#include <functional>
#include <memory>

namespace entoptic::runtime::graphics {

class OpenGlContext {
public:
    virtual ~OpenGlContext() = default;
    // Makes the context current on this thread. Gives back what puts the thread's former context in its place again; nothing (an empty
    // function) when the context cannot be made current, as when another thread has it.
    virtual std::function<void()> make_current() = 0;
    // An entry point by name. Not null means nothing: window systems give addresses of what the driver lacks.
    virtual void* function(const char* name) const = 0;
};

// The context is current for as long as this lives, if current() says so.
class CurrentContext {
public:
    explicit CurrentContext(OpenGlContext& context) : restore_(context.make_current()) {}
    ~CurrentContext() {
        if (restore_) restore_();
    }
    CurrentContext(const CurrentContext&) = delete;
    CurrentContext& operator=(const CurrentContext&) = delete;
    // XR_ERROR_VALIDATION_FAILURE when the context is not current.
    Outcome outcome() const {
        return restore_
                   ? Outcome()
                   : invalid("the session's OpenGL context cannot be made current here; unbind it from other threads before this call");
    }

private:
    std::function<void()> restore_;
};

// From the chain of XrSessionCreateInfo: XrGraphicsBindingOpenGLXlibKHR. XR_ERROR_GRAPHICS_DEVICE_INVALID.
Outcome make_glx_context(const void* binding, std::unique_ptr<OpenGlContext>& context);
// XrGraphicsBindingOpenGLXcbKHR. Its identifiers are the X server's, and only Xlib's GLX makes contexts current: the session's context is the
// one that is current now. XR_ERROR_GRAPHICS_DEVICE_INVALID when there is none of that connection.
Outcome make_xcb_context(const void* binding, std::unique_ptr<OpenGlContext>& context);
// XrGraphicsBindingEGLMNDX (XR_MNDX_egl_enable). XR_ERROR_GRAPHICS_DEVICE_INVALID.
Outcome make_egl_context(const void* binding, std::unique_ptr<OpenGlContext>& context);

}  // namespace entoptic::runtime::graphics
