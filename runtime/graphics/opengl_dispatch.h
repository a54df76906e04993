// OpenGL entry points of the application's context.
#pragma once

#include "runtime/graphics/opengl_openxr.h"

#include "runtime/graphics/opengl_context.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace entoptic::runtime::graphics {

struct OpenGlDispatch {
    PFNGLGETSTRINGIPROC GetStringi = nullptr;
    decltype(&::glGetIntegerv) GetIntegerv = nullptr;
    decltype(&::glGetError) GetError = nullptr;
    decltype(&::glFinish) Finish = nullptr;
    decltype(&::glFlush) Flush = nullptr;
    decltype(&::glGenTextures) GenTextures = nullptr;
    decltype(&::glDeleteTextures) DeleteTextures = nullptr;
    decltype(&::glBindTexture) BindTexture = nullptr;
    decltype(&::glGetTexImage) GetTexImage = nullptr;
    decltype(&::glGetTexLevelParameteriv) GetTexLevelParameteriv = nullptr;
    decltype(&::glPixelStorei) PixelStorei = nullptr;
    PFNGLBINDBUFFERPROC BindBuffer = nullptr;
    PFNGLTEXSTORAGE2DPROC TexStorage2D = nullptr;
    PFNGLTEXSTORAGE3DPROC TexStorage3D = nullptr;
    PFNGLFENCESYNCPROC FenceSync = nullptr;
    PFNGLCLIENTWAITSYNCPROC ClientWaitSync = nullptr;
    PFNGLDELETESYNCPROC DeleteSync = nullptr;
    // GL_EXT_memory_object and GL_EXT_memory_object_fd: only where why_not_shared() is empty.
    PFNGLCREATEMEMORYOBJECTSEXTPROC CreateMemoryObjectsEXT = nullptr;
    PFNGLDELETEMEMORYOBJECTSEXTPROC DeleteMemoryObjectsEXT = nullptr;
    PFNGLMEMORYOBJECTPARAMETERIVEXTPROC MemoryObjectParameterivEXT = nullptr;
    PFNGLIMPORTMEMORYFDEXTPROC ImportMemoryFdEXT = nullptr;
    PFNGLTEXSTORAGEMEM2DEXTPROC TexStorageMem2DEXT = nullptr;
    PFNGLTEXSTORAGEMEM3DEXTPROC TexStorageMem3DEXT = nullptr;
    PFNGLGETUNSIGNEDBYTEVEXTPROC GetUnsignedBytevEXT = nullptr;
    PFNGLGETUNSIGNEDBYTEI_VEXTPROC GetUnsignedBytei_vEXT = nullptr;

    // With the context current. False when the context is older than OpenGL 3.2, or lacks GL_ARB_texture_storage (core in 4.2).
    bool load(const OpenGlContext& context);

    // With the context current from here on.
    bool has(const char* extension) const;
    GLint integer(GLenum name) const;
    // Empty when images of that device and driver can be imported; else why not.
    std::string why_not_shared(const std::array<std::uint8_t, 16>& device_uuid, const std::array<std::uint8_t, 16>& driver_uuid) const;
    // Forgets errors of calls before: what comes after is the runtime's own.
    void clear_errors() const;
    // XR_ERROR_OUT_OF_MEMORY, XR_ERROR_RUNTIME_FAILURE.
    Outcome check(const char* what) const;

private:
    bool load_memory_object(const OpenGlContext& context);
    bool memory_object_loaded_ = false;
};

}  // namespace entoptic::runtime::graphics
