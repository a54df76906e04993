// OpenGL's sized formats and Vulkan's formats of the same bits.
#pragma once

#include "runtime/graphics/opengl_openxr.h"

#include <vulkan/vulkan_core.h>

#include <cstdint>

namespace entoptic::runtime::graphics {

struct OpenGlFormat {
    GLenum sized = 0;
    VkFormat vk = VK_FORMAT_UNDEFINED;
    bool storable = false;  // OpenGL 4.5, table 8.26: image units take it
    // How glGetTexImage gives the bits that vkCmdCopyBufferToImage takes (of depth and stencil, depth); 0: not at all.
    GLenum read_format = 0, read_type = 0;
    std::uint32_t texel_bytes = 0;
    VkImageAspectFlags copied = VK_IMAGE_ASPECT_COLOR_BIT;
};

// Null: OpenGL has no such format.
const OpenGlFormat* opengl_format_of(VkFormat format);
const OpenGlFormat* opengl_format_named(std::int64_t sized);

}  // namespace entoptic::runtime::graphics
