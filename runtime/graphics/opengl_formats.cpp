#include "runtime/graphics/opengl_formats.h"

#include <algorithm>
#include <iterator>

namespace entoptic::runtime::graphics {

namespace {

// OpenGL has no sized format with blue first. The depth of D24S8 lies in other bits there than in a copy of Vulkan's.
constexpr OpenGlFormat formats[] = {
    {GL_SRGB8_ALPHA8, VK_FORMAT_R8G8B8A8_SRGB, false, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    {GL_RGBA8, VK_FORMAT_R8G8B8A8_UNORM, true, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    {GL_RGBA16F, VK_FORMAT_R16G16B16A16_SFLOAT, true, GL_RGBA, GL_HALF_FLOAT, 8},
    {GL_RGBA32F, VK_FORMAT_R32G32B32A32_SFLOAT, true, GL_RGBA, GL_FLOAT, 16},
    {GL_RGBA16, VK_FORMAT_R16G16B16A16_UNORM, true, GL_RGBA, GL_UNSIGNED_SHORT, 8},
    {GL_RGB10_A2, VK_FORMAT_A2B10G10R10_UNORM_PACK32, true, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV, 4},
    {GL_DEPTH_COMPONENT16, VK_FORMAT_D16_UNORM, false, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT, 2, VK_IMAGE_ASPECT_DEPTH_BIT},
    {GL_DEPTH_COMPONENT32F, VK_FORMAT_D32_SFLOAT, false, GL_DEPTH_COMPONENT, GL_FLOAT, 4, VK_IMAGE_ASPECT_DEPTH_BIT},
    {GL_DEPTH24_STENCIL8, VK_FORMAT_D24_UNORM_S8_UINT},
    {GL_DEPTH32F_STENCIL8, VK_FORMAT_D32_SFLOAT_S8_UINT, false, GL_DEPTH_COMPONENT, GL_FLOAT, 4, VK_IMAGE_ASPECT_DEPTH_BIT},
};

template <class Is> const OpenGlFormat* find(Is is) {
    const auto* found = std::find_if(std::begin(formats), std::end(formats), is);
    return found == std::end(formats) ? nullptr : found;
}

}  // namespace

const OpenGlFormat* opengl_format_of(VkFormat format) {
    return find([&](const OpenGlFormat& row) { return row.vk == format; });
}

const OpenGlFormat* opengl_format_named(std::int64_t sized) {
    return find([&](const OpenGlFormat& row) { return std::int64_t(row.sized) == sized; });
}

}  // namespace entoptic::runtime::graphics
