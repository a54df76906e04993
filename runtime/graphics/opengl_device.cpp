#include "runtime/graphics/opengl_device.h"

#include "runtime/graphics/image_request.h"
#include "runtime/graphics/opengl_copies.h"
#include "runtime/graphics/opengl_images.h"

namespace entoptic::runtime::graphics {

TextureKind texture_kind(const ImageMemory& memory) {
    const auto layers = static_cast<GLsizei>(memory.array_layers);
    const bool cube = (memory.vk_create_flags & VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT) != 0;
    if (cube && layers == 6) return {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP, false, 1, 6};
    if (cube) return {GL_TEXTURE_CUBE_MAP_ARRAY, GL_TEXTURE_BINDING_CUBE_MAP_ARRAY, true, layers, 1};
    if (layers > 1) return {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY, true, layers, 1};
    return {};
}

Outcome enumerate_textures(const std::vector<GLuint>& textures, XrSwapchainImageBaseHeader* images) {
    auto* out = reinterpret_cast<XrSwapchainImageOpenGLKHR*>(images);
    for (std::size_t i = 0; i < textures.size(); ++i) {
        if (out[i].type != XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR)
            return invalid("images[{}].type must be XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR", i);
    }
    for (std::size_t i = 0; i < textures.size(); ++i) out[i].image = textures[i];
    return XR_SUCCESS;
}

Outcome OpenGlDevice::create(std::unique_ptr<OpenGlContext> context, RuntimeHost& host, std::unique_ptr<GraphicsDevice>& device) {
    auto shared = std::make_shared<OpenGlShared>();
    shared->context = std::move(context);
    shared->host = &host;
    const CurrentContext current(*shared->context);
    if (Outcome bound = current.outcome(); bound.failed()) return {XR_ERROR_GRAPHICS_DEVICE_INVALID, bound.message()};
    if (!shared->gl.load(*shared->context)) {
        return error(XR_ERROR_GRAPHICS_DEVICE_INVALID, "the OpenGL context is too old: 3.2 with GL_ARB_texture_storage is needed");
    }
    shared->why_copied = shared->gl.why_not_shared(host.frames().device_uuid(), host.frames().driver_uuid());
    if (!shared->why_copied.empty()) {
        host.report_error(
            fmt::format("OpenGL images are copied by the CPU: {}. What that costs is timing_ms.copy of the report.", shared->why_copied));
    }
    device.reset(new OpenGlDevice(std::move(shared)));
    return XR_SUCCESS;
}

std::vector<std::int64_t> OpenGlDevice::formats(const std::vector<std::int64_t>& compositor) const {
    std::vector<std::int64_t> formats;
    for (const std::int64_t vk : compositor) {
        const OpenGlFormat* format = opengl_format_of(static_cast<VkFormat>(vk));
        if (format && offered(*format)) formats.push_back(format->sized);
    }
    return formats;
}

Outcome OpenGlDevice::describe(const XrSwapchainCreateInfo& info, SwapchainRequest& request) const {
    const OpenGlFormat* format = opengl_format_named(info.format);
    if (!format || !offered(*format))
        return error(XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED, "OpenGL format {:#x} is not offered", info.format);
    if ((info.usageFlags & XR_SWAPCHAIN_USAGE_UNORDERED_ACCESS_BIT) != 0 && !format->storable)
        return error(XR_ERROR_FEATURE_UNSUPPORTED, "OpenGL has no image units for format {:#x}", info.format);
    ENTOPTIC_XR_TRY(request_image(info, format->vk, request));
    // OpenGL does not say what it will do with a texture: GL_EXT_memory_object wants an image that can do all that its texture can, and of
    // a mutable format (its issue 17). Copies are written as transfers.
    request.vk_usage |= VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    request.vk_create_flags |= VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT;
    return XR_SUCCESS;
}

Outcome OpenGlDevice::import(SwapchainAllocation allocation, std::unique_ptr<SwapchainImages>& images) {
    if (!shared_->why_copied.empty()) return make_opengl_copies(shared_, std::move(allocation.images), images);
    auto imported = std::make_unique<OpenGlImages>(shared_);
    ENTOPTIC_XR_TRY(imported->import(std::move(allocation.images)));
    images = std::move(imported);
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
