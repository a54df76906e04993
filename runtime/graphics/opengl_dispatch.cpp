#include "runtime/graphics/opengl_dispatch.h"

#include <algorithm>
#include <cstring>

namespace entoptic::runtime::graphics {

namespace {

constexpr int most_errors = 32;  // a lost context reports one for ever

template <class Function> bool get(const OpenGlContext& context, Function& function, const char* name) {
    function = reinterpret_cast<Function>(context.function(name));
    return function != nullptr;
}

}  // namespace

bool OpenGlDispatch::load(const OpenGlContext& context) {
    bool complete =
        get(context, GetIntegerv, "glGetIntegerv") && get(context, GetStringi, "glGetStringi") && get(context, GetError, "glGetError");
    if (!complete) return false;
    clear_errors();
    const GLint major = integer(GL_MAJOR_VERSION), minor = integer(GL_MINOR_VERSION);
    if (GetError() != GL_NO_ERROR || major * 10 + minor < 32) return false;
    if (major * 10 + minor < 42 && !has("GL_ARB_texture_storage")) return false;
    complete &= get(context, Finish, "glFinish") && get(context, Flush, "glFlush") && get(context, GenTextures, "glGenTextures") &&
                get(context, DeleteTextures, "glDeleteTextures") && get(context, BindTexture, "glBindTexture") &&
                get(context, GetTexImage, "glGetTexImage") && get(context, GetTexLevelParameteriv, "glGetTexLevelParameteriv") &&
                get(context, PixelStorei, "glPixelStorei") && get(context, BindBuffer, "glBindBuffer") &&
                get(context, TexStorage2D, "glTexStorage2D") && get(context, TexStorage3D, "glTexStorage3D") &&
                get(context, FenceSync, "glFenceSync") && get(context, ClientWaitSync, "glClientWaitSync") &&
                get(context, DeleteSync, "glDeleteSync");
    memory_object_loaded_ = load_memory_object(context);
    return complete;
}

bool OpenGlDispatch::load_memory_object(const OpenGlContext& context) {
    return get(context, CreateMemoryObjectsEXT, "glCreateMemoryObjectsEXT") &&
           get(context, DeleteMemoryObjectsEXT, "glDeleteMemoryObjectsEXT") &&
           get(context, MemoryObjectParameterivEXT, "glMemoryObjectParameterivEXT") &&
           get(context, ImportMemoryFdEXT, "glImportMemoryFdEXT") && get(context, TexStorageMem2DEXT, "glTexStorageMem2DEXT") &&
           get(context, TexStorageMem3DEXT, "glTexStorageMem3DEXT") && get(context, GetUnsignedBytevEXT, "glGetUnsignedBytevEXT") &&
           get(context, GetUnsignedBytei_vEXT, "glGetUnsignedBytei_vEXT");
}

bool OpenGlDispatch::has(const char* extension) const {
    const GLint count = integer(GL_NUM_EXTENSIONS);
    for (GLint i = 0; i < count; ++i) {
        const auto* name = reinterpret_cast<const char*>(GetStringi(GL_EXTENSIONS, static_cast<GLuint>(i)));
        if (name && std::strcmp(name, extension) == 0) return true;
    }
    return false;
}

GLint OpenGlDispatch::integer(GLenum name) const {
    GLint value = 0;
    GetIntegerv(name, &value);
    return value;
}

std::string OpenGlDispatch::why_not_shared(const std::array<std::uint8_t, 16>& device_uuid,
                                           const std::array<std::uint8_t, 16>& driver_uuid) const {
    for (const char* extension : {"GL_EXT_memory_object", "GL_EXT_memory_object_fd"}) {
        if (!memory_object_loaded_ || !has(extension)) return fmt::format("the OpenGL driver lacks {}", extension);
    }
    std::array<std::uint8_t, GL_UUID_SIZE_EXT> uuid{};
    GetUnsignedBytevEXT(GL_DRIVER_UUID_EXT, uuid.data());
    if (uuid != driver_uuid) return "the OpenGL driver and the Vulkan driver that composes are of different kinds or versions";
    const GLint devices = integer(GL_NUM_DEVICE_UUIDS_EXT);
    for (GLint i = 0; i < devices; ++i) {
        GetUnsignedBytei_vEXT(GL_DEVICE_UUID_EXT, static_cast<GLuint>(i), uuid.data());
        if (uuid == device_uuid) return {};
    }
    return "OpenGL runs on another GPU than the one that composes";
}

void OpenGlDispatch::clear_errors() const {
    for (int i = 0; i < most_errors && GetError() != GL_NO_ERROR; ++i) {}
}

Outcome OpenGlDispatch::check(const char* what) const {
    const GLenum code = GetError();
    if (code == GL_NO_ERROR) return XR_SUCCESS;
    clear_errors();
    return error(code == GL_OUT_OF_MEMORY ? XR_ERROR_OUT_OF_MEMORY : XR_ERROR_RUNTIME_FAILURE,
                 "{} failed in the application's OpenGL context (error {:#x})", what, code);
}

}  // namespace entoptic::runtime::graphics
