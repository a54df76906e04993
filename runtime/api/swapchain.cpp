// Swapchains and their images.
#include "runtime/objects/swapchain.h"

#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/limits.h"
#include "runtime/api/verify.h"
#include "runtime/objects/session.h"

#include <algorithm>
#include <bit>

namespace entoptic::runtime::api {

namespace {

constexpr XrSwapchainCreateFlags known_create_flags = XR_SWAPCHAIN_CREATE_PROTECTED_CONTENT_BIT | XR_SWAPCHAIN_CREATE_STATIC_IMAGE_BIT;
constexpr XrSwapchainUsageFlags known_usage = 0x7f;  // the seven bits of OpenXR 1.0

Outcome check_size(const XrSwapchainCreateInfo& info) {
    if (info.width == 0 || info.height == 0 || info.width > largest_swapchain_side || info.height > largest_swapchain_side) {
        return invalid("a swapchain of {}x{} texels is not possible; each side must be 1 to {}", info.width, info.height,
                       largest_swapchain_side);
    }
    if (info.faceCount != 1 && info.faceCount != 6) return invalid("faceCount is {}; it must be 1 or 6", info.faceCount);
    if (info.faceCount == 6 && info.width != info.height)
        return invalid("a cube's faces must be square, not {}x{}", info.width, info.height);
    if (info.sampleCount == 0) return invalid("sampleCount is 0");
    if (info.sampleCount != 1)
        return error(XR_ERROR_FEATURE_UNSUPPORTED, "multisampled swapchains are not supported; resolve into one sample");
    if (info.arraySize == 0 || info.arraySize > most_array_layers)
        return invalid("arraySize is {}; it must be 1 to {}", info.arraySize, most_array_layers);
    const auto most_mips = static_cast<std::uint32_t>(std::bit_width(std::max(info.width, info.height)));
    if (info.mipCount == 0 || info.mipCount > most_mips)
        return invalid("mipCount is {}; it must be 1 to {} for this size", info.mipCount, most_mips);
    return XR_SUCCESS;
}

// Those of the session's graphics API; none without graphics.
std::vector<std::int64_t> swapchain_formats(Session& session) {
    return session.graphics() ? session.graphics()->formats(session.host().frames().swapchain_formats()) : std::vector<std::int64_t>();
}

Outcome check_create_info(const XrSwapchainCreateInfo& info, Session& session) {
    if ((info.createFlags & ~known_create_flags) != 0) return invalid("createFlags has unknown bits ({:#x})", info.createFlags);
    if ((info.usageFlags & ~known_usage) != 0) return invalid("usageFlags has unknown bits ({:#x})", info.usageFlags);
    ENTOPTIC_XR_TRY(check_size(info));
    if ((info.createFlags & XR_SWAPCHAIN_CREATE_PROTECTED_CONTENT_BIT) != 0) {
        return error(XR_ERROR_FEATURE_UNSUPPORTED, "protected content is not supported");
    }
    const auto formats = swapchain_formats(session);
    if (std::find(formats.begin(), formats.end(), info.format) == formats.end()) {
        return error(XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED, "format {} is not offered; take one from xrEnumerateSwapchainFormats",
                     info.format);
    }
    return XR_SUCCESS;
}

Outcome allocate(Session& session, const XrSwapchainCreateInfo& info, SwapchainAllocation& allocation) {
    SwapchainRequest request;
    request.width = info.width;
    request.height = info.height;
    request.array_layers = info.arraySize * info.faceCount;
    request.mip_levels = info.mipCount;
    request.is_static = (info.createFlags & XR_SWAPCHAIN_CREATE_STATIC_IMAGE_BIT) != 0;
    ENTOPTIC_XR_TRY(session.graphics()->describe(info, request));
    auto made = session.host().frames().create_swapchain(request);
    if (!made) {
        if (made.error().kind == ErrorKind::failed) session.host().report_error(made.error().message);
        const bool unsupported = made.error().kind != ErrorKind::failed;
        return {unsupported ? XR_ERROR_FEATURE_UNSUPPORTED : XR_ERROR_RUNTIME_FAILURE, made.error().message};
    }
    allocation = std::move(*made);
    return XR_SUCCESS;
}

Outcome make_swapchain(const std::shared_ptr<Session>& session, const XrSwapchainCreateInfo& info, std::shared_ptr<Swapchain>& swapchain) {
    SwapchainAllocation allocation;
    ENTOPTIC_XR_TRY(allocate(*session, info, allocation));
    const std::uint64_t id = allocation.id;
    std::unique_ptr<SwapchainImages> images;
    if (Outcome imported = session->graphics()->import(std::move(allocation), images); imported.failed()) {
        session->host().frames().destroy_swapchain(id);
        session->host().report_error(imported.message());
        return imported;
    }
    swapchain = std::make_shared<Swapchain>(session, info, id, std::move(images));
    return XR_SUCCESS;
}

}  // namespace

XrResult XRAPI_CALL enumerate_swapchain_formats(XrSession handle, uint32_t capacity, uint32_t* count, int64_t* formats) {
    return call("xrEnumerateSwapchainFormats", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        return two_call_values(capacity, count, formats, swapchain_formats(*session));
    });
}

XrResult XRAPI_CALL create_swapchain(XrSession handle, const XrSwapchainCreateInfo* info, XrSwapchain* swapchain_handle) {
    return call("xrCreateSwapchain", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_SWAPCHAIN_CREATE_INFO, "createInfo"));
        ENTOPTIC_XR_TRY(require_pointer(swapchain_handle, "swapchain"));
        ENTOPTIC_XR_TRY(check_create_info(*info, *session));
        std::shared_ptr<Swapchain> swapchain;
        ENTOPTIC_XR_TRY(make_swapchain(session, *info, swapchain));
        return publish(swapchain, handle_value(handle), swapchain_handle);
    });
}

XrResult XRAPI_CALL destroy_swapchain(XrSwapchain handle) {
    return call("xrDestroySwapchain", handle, [&] { return destroy<Swapchain>(handle_value(handle)); });
}

XrResult XRAPI_CALL enumerate_swapchain_images(XrSwapchain handle, uint32_t capacity, uint32_t* count, XrSwapchainImageBaseHeader* images) {
    return call("xrEnumerateSwapchainImages", handle, [&]() -> Outcome {
        std::shared_ptr<Swapchain> swapchain;
        ENTOPTIC_XR_TRY(find(handle, swapchain));
        bool fill = false;
        ENTOPTIC_XR_TRY(two_call(capacity, count, images, swapchain->image_count(), fill));
        return fill ? swapchain->enumerate(images) : Outcome();
    });
}

XrResult XRAPI_CALL acquire_swapchain_image(XrSwapchain handle, const XrSwapchainImageAcquireInfo* info, uint32_t* index) {
    return call("xrAcquireSwapchainImage", handle, [&]() -> Outcome {
        std::shared_ptr<Swapchain> swapchain;
        ENTOPTIC_XR_TRY(find(handle, swapchain));
        ENTOPTIC_XR_TRY(optional(info, XR_TYPE_SWAPCHAIN_IMAGE_ACQUIRE_INFO, "acquireInfo"));
        ENTOPTIC_XR_TRY(require_pointer(index, "index"));
        return swapchain->acquire(*index);
    });
}

XrResult XRAPI_CALL wait_swapchain_image(XrSwapchain handle, const XrSwapchainImageWaitInfo* info) {
    return call("xrWaitSwapchainImage", handle, [&]() -> Outcome {
        std::shared_ptr<Swapchain> swapchain;
        ENTOPTIC_XR_TRY(find(handle, swapchain));
        ENTOPTIC_XR_TRY(require(info, XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, "waitInfo"));
        return swapchain->wait(std::max<XrDuration>(info->timeout, 0));
    });
}

XrResult XRAPI_CALL release_swapchain_image(XrSwapchain handle, const XrSwapchainImageReleaseInfo* info) {
    return call("xrReleaseSwapchainImage", handle, [&]() -> Outcome {
        std::shared_ptr<Swapchain> swapchain;
        ENTOPTIC_XR_TRY(find(handle, swapchain));
        ENTOPTIC_XR_TRY(optional(info, XR_TYPE_SWAPCHAIN_IMAGE_RELEASE_INFO, "releaseInfo"));
        return swapchain->release();
    });
}

}  // namespace entoptic::runtime::api
