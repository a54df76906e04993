// The application's OpenGL context, as xrCreateSession got it, and how the compositor's images get into it: through shared memory
// (GL_EXT_memory_object_fd), or copied by the CPU where the driver cannot share.
#pragma once

#include "runtime/graphics/opengl_dispatch.h"
#include "runtime/graphics/opengl_formats.h"

#include "interfaces/runtime_host.h"
#include "runtime/objects/graphics.h"

#include <memory>
#include <string>

namespace entoptic::runtime::graphics {

class CopyDevice;

// What images share. Outlives the device object while images exist; the application keeps its context alive.
struct OpenGlShared {
    std::unique_ptr<OpenGlContext> context;
    OpenGlDispatch gl;
    RuntimeHost* host = nullptr;         // of the instance, which outlives its images
    std::string why_copied;              // empty: memory is shared
    std::shared_ptr<CopyDevice> copier;  // made for the first swapchain that needs it
};

// A swapchain image's kind of texture, and a new texture of it. The context is current.
struct TextureKind {
    GLenum target = GL_TEXTURE_2D, binding = GL_TEXTURE_BINDING_2D;
    bool layered = false;    // storage has a third dimension
    GLsizei layers = 1;      // that dimension
    GLsizei read_faces = 1;  // glGetTexImage gives one of so many at a time
};
TextureKind texture_kind(const ImageMemory& memory);

// Binds a texture, and puts back the one that was bound there before.
class BoundTexture {
public:
    BoundTexture(const OpenGlDispatch& gl, const TextureKind& kind, GLuint texture)
        : gl_(gl), target_(kind.target), before_(static_cast<GLuint>(gl.integer(kind.binding))) {
        gl_.BindTexture(target_, texture);
    }
    ~BoundTexture() { gl_.BindTexture(target_, before_); }
    BoundTexture(const BoundTexture&) = delete;
    BoundTexture& operator=(const BoundTexture&) = delete;

private:
    const OpenGlDispatch& gl_;
    const GLenum target_;
    const GLuint before_;
};

// Fills `images` with a swapchain's textures. XR_ERROR_VALIDATION_FAILURE when a structure is of the wrong type.
Outcome enumerate_textures(const std::vector<GLuint>& textures, XrSwapchainImageBaseHeader* images);

class OpenGlDevice final : public GraphicsDevice {
public:
    // Finds out whether memory can be shared; tells the host when it cannot. XR_ERROR_GRAPHICS_DEVICE_INVALID when the context is too old,
    // or bound in another thread.
    static Outcome create(std::unique_ptr<OpenGlContext> context, RuntimeHost& host, std::unique_ptr<GraphicsDevice>& device);

    std::vector<std::int64_t> formats(const std::vector<std::int64_t>& compositor) const override;
    bool bottom_up() const override { return true; }
    Outcome describe(const XrSwapchainCreateInfo& info, SwapchainRequest& request) const override;
    Outcome import(SwapchainAllocation allocation, std::unique_ptr<SwapchainImages>& images) override;

private:
    explicit OpenGlDevice(std::shared_ptr<OpenGlShared> shared) : shared_(std::move(shared)) {}
    bool offered(const OpenGlFormat& format) const { return shared_->why_copied.empty() || format.texel_bytes != 0; }

    const std::shared_ptr<OpenGlShared> shared_;
};

}  // namespace entoptic::runtime::graphics
