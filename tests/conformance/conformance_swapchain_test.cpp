// labels: gpu
// Swapchains: creation, the order of acquire, wait and release, and images that really are the application's.
#include "runtime/testing/client.h"

namespace entoptic::runtime::testing {
namespace {

class Swapchains : public SessionTest {
public:
    XrResult create(const XrSwapchainCreateInfo& info) {
        XrSwapchain swapchain = XR_NULL_HANDLE;
        const XrResult result = xr.xrCreateSwapchain(session, &info, &swapchain);
        if (result == XR_SUCCESS) { EXPECT_EQ(xr.xrDestroySwapchain(swapchain), XR_SUCCESS); }
        return result;
    }
    template <class Edit> XrResult create_with(Edit edit) {
        XrSwapchainCreateInfo info = swapchain_info();
        edit(info);
        return create(info);
    }
    std::vector<XrSwapchainImageVulkanKHR> images(XrSwapchain swapchain) {
        std::uint32_t count = 0;
        EXPECT_EQ(xr.xrEnumerateSwapchainImages(swapchain, 0, &count, nullptr), XR_SUCCESS);
        std::vector<XrSwapchainImageVulkanKHR> found(count, {XR_TYPE_SWAPCHAIN_IMAGE_VULKAN_KHR});
        EXPECT_EQ(xr.xrEnumerateSwapchainImages(swapchain, count, &count, reinterpret_cast<XrSwapchainImageBaseHeader*>(found.data())),
                  XR_SUCCESS);
        return found;
    }
};

TEST_F(Swapchains, EveryFormatWithEveryPlainUsage) {
    std::uint32_t count = 0;
    ASSERT_EQ(xr.xrEnumerateSwapchainFormats(session, 0, &count, nullptr), XR_SUCCESS);
    std::vector<std::int64_t> formats(count);
    EXPECT_EQ(xr.xrEnumerateSwapchainFormats(session, 1, &count, formats.data()), XR_ERROR_SIZE_INSUFFICIENT);
    ASSERT_EQ(xr.xrEnumerateSwapchainFormats(session, count, &count, formats.data()), XR_SUCCESS);
    for (const std::int64_t format : formats) {
        const bool depth = format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM;
        for (const XrSwapchainUsageFlags usage :
             {XR_SWAPCHAIN_USAGE_SAMPLED_BIT, XR_SWAPCHAIN_USAGE_TRANSFER_SRC_BIT, XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT,
              XR_SWAPCHAIN_USAGE_MUTABLE_FORMAT_BIT, XrSwapchainUsageFlags(0),
              depth ? XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT}) {
            EXPECT_EQ(create_with([&](auto& info) {
                          info.format = format;
                          info.usageFlags = usage;
                          info.arraySize = 2;
                          info.mipCount = 3;
                      }),
                      XR_SUCCESS)
                << format << " " << usage;
        }
    }
    EXPECT_EQ(xr.host->service.living_swapchains(), 0u);
}

TEST_F(Swapchains, MutableFormatReachesTheImage) {
    EXPECT_EQ(create_with([](auto& info) { info.usageFlags |= XR_SWAPCHAIN_USAGE_MUTABLE_FORMAT_BIT | XR_SWAPCHAIN_USAGE_SAMPLED_BIT; }),
              XR_SUCCESS);
    EXPECT_EQ(xr.host->service.last_request.vk_create_flags, std::uint32_t(VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT));
    EXPECT_NE(xr.host->service.last_request.vk_usage & VK_IMAGE_USAGE_SAMPLED_BIT, 0u);
}

TEST_F(Swapchains, CreationErrors) {
    EXPECT_EQ(create_with([](auto& info) { info.type = XR_TYPE_UNKNOWN; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.createFlags = 0x80; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.createFlags = XR_SWAPCHAIN_CREATE_PROTECTED_CONTENT_BIT; }), XR_ERROR_FEATURE_UNSUPPORTED);
    EXPECT_EQ(create_with([](auto& info) { info.usageFlags = 0x1000; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.format = 12345; }), XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED);
    EXPECT_EQ(create_with([](auto& info) { info.width = 0; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.height = 16385; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.sampleCount = 0; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.sampleCount = 4; }), XR_ERROR_FEATURE_UNSUPPORTED);
    EXPECT_EQ(create_with([](auto& info) { info.faceCount = 2; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.faceCount = 6; }), XR_ERROR_VALIDATION_FAILURE) << "64x32 is no side of a cube";
    EXPECT_EQ(create_with([](auto& info) { info.arraySize = 0; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.arraySize = 0xffffffff; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.mipCount = 0; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.mipCount = 8; }), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(create_with([](auto& info) { info.mipCount = 7; }), XR_SUCCESS);
    EXPECT_EQ(create_with([](auto& info) { info.usageFlags = XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT; }),
              XR_ERROR_FEATURE_UNSUPPORTED);
}

TEST_F(Swapchains, EnumerateImages) {
    const XrSwapchain swapchain = make_swapchain();
    const auto found = images(swapchain);
    EXPECT_EQ(found.size(), 3u);
    EXPECT_NE(found[0].image, found[1].image);
    std::uint32_t count = 0;
    std::vector<XrSwapchainImageVulkanKHR> wrong(3, {XR_TYPE_UNKNOWN});
    EXPECT_EQ(xr.xrEnumerateSwapchainImages(swapchain, 3, &count, reinterpret_cast<XrSwapchainImageBaseHeader*>(wrong.data())),
              XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrEnumerateSwapchainImages(swapchain, 2, &count, reinterpret_cast<XrSwapchainImageBaseHeader*>(wrong.data())),
              XR_ERROR_SIZE_INSUFFICIENT);
}

TEST_F(Swapchains, OrderOfCalls) {
    const XrSwapchain swapchain = make_swapchain();
    EXPECT_EQ(wait_image(swapchain, 0), XR_ERROR_CALL_ORDER_INVALID);
    EXPECT_EQ(xr.xrReleaseSwapchainImage(swapchain, nullptr), XR_ERROR_CALL_ORDER_INVALID);
    std::uint32_t index = 0;
    for (std::uint32_t i = 0; i < 3; ++i) {
        ASSERT_EQ(xr.xrAcquireSwapchainImage(swapchain, nullptr, &index), XR_SUCCESS);
        EXPECT_EQ(index, i);
        EXPECT_EQ(xr.xrReleaseSwapchainImage(swapchain, nullptr), XR_ERROR_CALL_ORDER_INVALID);
    }
    EXPECT_EQ(xr.xrAcquireSwapchainImage(swapchain, nullptr, &index), XR_ERROR_CALL_ORDER_INVALID);
    for (int i = 0; i < 3; ++i) {
        ASSERT_EQ(wait_image(swapchain), XR_SUCCESS);
        EXPECT_EQ(wait_image(swapchain), XR_ERROR_CALL_ORDER_INVALID);
        ASSERT_EQ(xr.xrReleaseSwapchainImage(swapchain, nullptr), XR_SUCCESS);
    }
    EXPECT_EQ(wait_image(swapchain), XR_ERROR_CALL_ORDER_INVALID);
    const XrSwapchainImageWaitInfo wrong{XR_TYPE_UNKNOWN};
    EXPECT_EQ(xr.xrWaitSwapchainImage(swapchain, &wrong), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrWaitSwapchainImage(swapchain, nullptr), XR_ERROR_VALIDATION_FAILURE);
    EXPECT_EQ(xr.xrAcquireSwapchainImage(swapchain, nullptr, nullptr), XR_ERROR_VALIDATION_FAILURE);
    for (std::uint32_t i = 0; i < 7; ++i) EXPECT_EQ(cycle(swapchain), i % 3);
}

TEST_F(Swapchains, AnImageTheCompositorReadsIsWaitedFor) {
    const XrSwapchain swapchain = make_swapchain();
    xr.host->service.block_image(1, 0, true);
    std::uint32_t index = 0;
    ASSERT_EQ(xr.xrAcquireSwapchainImage(swapchain, nullptr, &index), XR_SUCCESS);
    EXPECT_EQ(wait_image(swapchain, 0), XR_TIMEOUT_EXPIRED);
    EXPECT_EQ(wait_image(swapchain, 1'000'000), XR_TIMEOUT_EXPIRED);
    EXPECT_EQ(xr.xrReleaseSwapchainImage(swapchain, nullptr), XR_ERROR_CALL_ORDER_INVALID);
    xr.host->service.block_image(1, 0, false);
    EXPECT_EQ(wait_image(swapchain, 0), XR_SUCCESS);
    EXPECT_EQ(xr.xrReleaseSwapchainImage(swapchain, nullptr), XR_SUCCESS);
}

TEST_F(Swapchains, StaticImageIsAcquiredOnce) {
    XrSwapchainCreateInfo info = swapchain_info();
    info.createFlags = XR_SWAPCHAIN_CREATE_STATIC_IMAGE_BIT;
    const XrSwapchain swapchain = make_swapchain(info);
    EXPECT_EQ(images(swapchain).size(), 1u);
    EXPECT_EQ(cycle(swapchain), 0u);
    std::uint32_t index = 0;
    EXPECT_EQ(xr.xrAcquireSwapchainImage(swapchain, nullptr, &index), XR_ERROR_CALL_ORDER_INVALID);
}

// The application clears its image in the layout the specification promises, many times round.
TEST_F(Swapchains, TheApplicationRendersIntoIt) {
    XrSwapchainCreateInfo info = swapchain_info();
    info.usageFlags |= XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT;
    const XrSwapchain swapchain = make_swapchain(info);
    const auto found = images(swapchain);
    VkCommandPool pool = VK_NULL_HANDLE;
    const VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr, 0, 0};
    ASSERT_EQ(vulkan.proc<PFN_vkCreateCommandPool>("vkCreateCommandPool")(vulkan.device, &pool_info, nullptr, &pool), VK_SUCCESS);
    VkQueue queue = VK_NULL_HANDLE;
    vulkan.proc<PFN_vkGetDeviceQueue>("vkGetDeviceQueue")(vulkan.device, 0, 0, &queue);
    for (int i = 0; i < 8; ++i) {
        std::uint32_t index = 0;
        ASSERT_EQ(xr.xrAcquireSwapchainImage(swapchain, nullptr, &index), XR_SUCCESS);
        ASSERT_EQ(wait_image(swapchain), XR_SUCCESS);
        VkCommandBuffer commands = VK_NULL_HANDLE;
        const VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool,
                                                   VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
        ASSERT_EQ(vulkan.proc<PFN_vkAllocateCommandBuffers>("vkAllocateCommandBuffers")(vulkan.device, &allocate, &commands), VK_SUCCESS);
        const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr, 0, nullptr};
        vulkan.proc<PFN_vkBeginCommandBuffer>("vkBeginCommandBuffer")(commands, &begin);
        const auto barrier = [&](VkImageLayout from, VkImageLayout to) {
            const VkImageMemoryBarrier change{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                              nullptr,
                                              VK_ACCESS_MEMORY_WRITE_BIT,
                                              VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                                              from,
                                              to,
                                              VK_QUEUE_FAMILY_IGNORED,
                                              VK_QUEUE_FAMILY_IGNORED,
                                              found[index].image,
                                              {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
            vulkan.proc<PFN_vkCmdPipelineBarrier>("vkCmdPipelineBarrier")(
                commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0, nullptr, 1, &change);
        };
        barrier(VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        const VkClearColorValue grey{{0.5f, 0.5f, 0.5f, 1}};
        const VkImageSubresourceRange range{VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
        vulkan.proc<PFN_vkCmdClearColorImage>("vkCmdClearColorImage")(commands, found[index].image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                                                      &grey, 1, &range);
        barrier(VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL);
        vulkan.proc<PFN_vkEndCommandBuffer>("vkEndCommandBuffer")(commands);
        const VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO, nullptr, 0, nullptr, nullptr, 1, &commands, 0, nullptr};
        ASSERT_EQ(vulkan.proc<PFN_vkQueueSubmit>("vkQueueSubmit")(queue, 1, &submit, VK_NULL_HANDLE), VK_SUCCESS);
        ASSERT_EQ(xr.xrReleaseSwapchainImage(swapchain, nullptr), XR_SUCCESS);
    }
    vulkan.proc<PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle")(vulkan.device);
    vulkan.proc<PFN_vkDestroyCommandPool>("vkDestroyCommandPool")(vulkan.device, pool, nullptr);
}

TEST_F(Swapchains, DestroyedOnesAreInvalid) {
    const XrSwapchain swapchain = make_swapchain();
    EXPECT_EQ(xr.xrDestroySwapchain(swapchain), XR_SUCCESS);
    std::uint32_t index = 0;
    EXPECT_EQ(xr.xrAcquireSwapchainImage(swapchain, nullptr, &index), XR_ERROR_HANDLE_INVALID);
    EXPECT_EQ(xr.xrDestroySwapchain(swapchain), XR_ERROR_HANDLE_INVALID);
    const XrSwapchain other = make_swapchain();
    EXPECT_EQ(xr.xrDestroySession(session), XR_SUCCESS);
    session = XR_NULL_HANDLE;
    EXPECT_EQ(xr.xrDestroySwapchain(other), XR_ERROR_HANDLE_INVALID) << "gone with its session";
    EXPECT_EQ(xr.host->service.living_swapchains(), 0u);
}

}  // namespace
}  // namespace entoptic::runtime::testing
