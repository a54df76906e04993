// OpenGL's headers and the OpenGL part of openxr_platform.h: for runtime/graphics/ only, and before any other include of OpenXR headers.
// Without a window system's part: those headers' macros stay in opengl_glx.cpp and opengl_egl.cpp.
#pragma once

#include <GL/gl.h>
#include <GL/glext.h>

#define XR_USE_GRAPHICS_API_OPENGL
#include "runtime/openxr.h"
