#include "runtime/graphics/opengl_images.h"

#include "base/log.h"
#include "runtime/graphics/vulkan_import.h"

namespace entoptic::runtime::graphics {

namespace {

constexpr GLuint64 longest_gpu_wait_ns = 20'000'000'000;

}  // namespace

OpenGlImages::~OpenGlImages() {
    if (memories_.empty()) return;
    const OpenGlDispatch& gl = shared_->gl;
    const CurrentContext current(*shared_->context);
    if (current.outcome().failed()) {
        log::warn("textures of a swapchain stay with the OpenGL context: it cannot be made current here");
        return;
    }
    gl.Finish();  // llvmpipe (Mesa 22.3) crashes when memory goes that it still draws to
    for (std::uint32_t i = 0; i < released_.size(); ++i) forget_fence(i);
    gl.DeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
    gl.DeleteMemoryObjectsEXT(static_cast<GLsizei>(memories_.size()), memories_.data());
    gl.clear_errors();
}

Outcome OpenGlImages::import(std::vector<ImageMemory> memories) {
    const Descriptors descriptors{memories};
    if (memories.empty()) return error(XR_ERROR_RUNTIME_FAILURE, "the compositor gave no image");
    const CurrentContext current(*shared_->context);
    ENTOPTIC_XR_TRY(current.outcome());
    shared_->gl.clear_errors();
    for (ImageMemory& memory : memories) ENTOPTIC_XR_TRY(import_one(memory));
    released_.assign(textures_.size(), nullptr);
    return XR_SUCCESS;
}

Outcome OpenGlImages::import_one(ImageMemory& memory) {
    const OpenGlDispatch& gl = shared_->gl;
    const OpenGlFormat* format = opengl_format_of(static_cast<VkFormat>(memory.vk_format));
    if (!format) return error(XR_ERROR_RUNTIME_FAILURE, "the compositor's image has VkFormat {}, which OpenGL has not", memory.vk_format);
    const GLint yes = GL_TRUE;
    GLuint object = 0, texture = 0;
    gl.CreateMemoryObjectsEXT(1, &object);
    memories_.push_back(object);
    gl.MemoryObjectParameterivEXT(object, GL_DEDICATED_MEMORY_OBJECT_EXT, &yes);
    gl.ImportMemoryFdEXT(object, memory.size, GL_HANDLE_TYPE_OPAQUE_FD_EXT, memory.fd);
    ENTOPTIC_XR_TRY(gl.check("glImportMemoryFdEXT"));
    memory.fd = -1;  // the driver's now
    gl.GenTextures(1, &texture);
    textures_.push_back(texture);
    const TextureKind kind = texture_kind(memory);
    const BoundTexture bound(gl, kind, texture);
    const auto width = static_cast<GLsizei>(memory.width), height = static_cast<GLsizei>(memory.height);
    const auto levels = static_cast<GLsizei>(memory.mip_levels);
    if (kind.layered)
        gl.TexStorageMem3DEXT(kind.target, levels, format->sized, width, height, kind.layers, object, 0);
    else
        gl.TexStorageMem2DEXT(kind.target, levels, format->sized, width, height, object, 0);
    return gl.check("the texture of an imported image");
}

void OpenGlImages::forget_fence(std::uint32_t index) {
    if (released_[index]) shared_->gl.DeleteSync(released_[index]);
    released_[index] = nullptr;
}

Outcome OpenGlImages::release(std::uint32_t index) {
    const OpenGlDispatch& gl = shared_->gl;
    const CurrentContext current(*shared_->context);
    ENTOPTIC_XR_TRY(current.outcome());
    const std::lock_guard lock(mutex_);
    forget_fence(index);
    released_[index] = gl.FenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    if (released_[index])
        gl.Flush();
    else
        gl.Finish();
    return XR_SUCCESS;
}

Outcome OpenGlImages::wait_released(std::uint32_t index) {
    const OpenGlDispatch& gl = shared_->gl;
    const std::lock_guard lock(mutex_);
    if (!released_[index]) return XR_SUCCESS;
    const CurrentContext current(*shared_->context);
    ENTOPTIC_XR_TRY(current.outcome());
    const GLenum result = gl.ClientWaitSync(released_[index], GL_SYNC_FLUSH_COMMANDS_BIT, longest_gpu_wait_ns);
    if (result != GL_ALREADY_SIGNALED && result != GL_CONDITION_SATISFIED)
        return error(XR_ERROR_RUNTIME_FAILURE, "the application's OpenGL work has not ended within 20 s");
    forget_fence(index);
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
