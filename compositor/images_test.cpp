// labels: gpu
#include "compositor/images.h"
#include "compositor/testing/frame_harness.h"

#include <chrono>
#include <gtest/gtest.h>
#include <thread>

namespace entoptic::compositor {
namespace {

using namespace testing;

Layer layer_of(std::uint64_t swapchain, std::uint32_t image, std::uint32_t slice = 0) {
    Layer layer;
    layer.kind = LayerKind::quad;
    layer.views[0].image = {swapchain, image, slice, 0, 0, 1, 1};
    return layer;
}

TEST(SwapchainPool, OffersTheFormatsApplicationsAskFor) {
    const SwapchainPool pool(test_device());
    const auto formats = pool.formats();
    ASSERT_FALSE(formats.empty());
    EXPECT_EQ(formats.front(), VK_FORMAT_R8G8B8A8_SRGB);
    for (const VkFormat format : {VK_FORMAT_B8G8R8A8_SRGB, VK_FORMAT_R16G16B16A16_SFLOAT, VK_FORMAT_R32G32B32A32_SFLOAT,
                                  VK_FORMAT_A2B10G10R10_UNORM_PACK32, VK_FORMAT_R8G8B8A8_UNORM, VK_FORMAT_D32_SFLOAT})
        EXPECT_NE(std::find(formats.begin(), formats.end(), std::int64_t(format)), formats.end()) << format;
}

TEST(SwapchainPool, AllocatesThreeImagesOrOne) {
    SwapchainPool pool(test_device());
    SwapchainRequest request;
    request.vk_format = VK_FORMAT_R16G16B16A16_SFLOAT;
    request.width = 33;
    request.height = 17;
    request.array_layers = 2;
    request.mip_levels = 3;
    request.vk_usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
    for (const bool is_static : {false, true}) {
        request.is_static = is_static;
        const SwapchainAllocation allocation = must(pool.create(request));
        EXPECT_EQ(allocation.images.size(), is_static ? 1u : 3u);
        for (const ImageMemory& memory : allocation.images) {
            EXPECT_GE(memory.fd, 0);
            EXPECT_GE(memory.size, 33u * 17 * 8 * 2);
            EXPECT_EQ(memory.array_layers, 2u);
            EXPECT_EQ(memory.mip_levels, 3u);
            EXPECT_TRUE(memory.vk_usage & VK_IMAGE_USAGE_SAMPLED_BIT);
            EXPECT_EQ(memory.device_uuid, test_device().device_uuid());
            close(memory.fd);
        }
        pool.destroy(allocation.id);
    }
    EXPECT_EQ(pool.swapchains(), 0u);
}

TEST(SwapchainPool, RefusesWhatCannotBe) {
    SwapchainPool pool(test_device());
    SwapchainRequest good;
    good.vk_format = VK_FORMAT_R8G8B8A8_SRGB;
    good.width = good.height = 8;
    for (const auto& spoil : std::vector<std::function<void(SwapchainRequest&)>>{
             [](auto& r) { r.vk_format = VK_FORMAT_R8_UNORM; }, [](auto& r) { r.width = 0; }, [](auto& r) { r.height = 1u << 30; },
             [](auto& r) { r.array_layers = 0; }, [](auto& r) { r.mip_levels = 9; }, [](auto& r) { r.samples = 4; }}) {
        SwapchainRequest request = good;
        spoil(request);
        const auto made = pool.create(request);
        ASSERT_FALSE(made);
        EXPECT_EQ(made.error().kind, ErrorKind::usage);
    }
}

TEST(SwapchainPool, KnowsWhichImagesAreRead) {
    SwapchainPool pool(test_device());
    const std::uint64_t id = make_swapchain(pool, VK_FORMAT_R8G8B8A8_SRGB, 4, 4, 1, false);
    EXPECT_TRUE(pool.wait_idle(id, 1, 0));
    {
        const ImageUse first = pool.use({layer_of(id, 1)});
        ImageUse second = pool.use({layer_of(id, 1), layer_of(id, 2)});
        EXPECT_TRUE(pool.wait_idle(id, 0, 0));
        EXPECT_FALSE(pool.wait_idle(id, 1, 0));
        EXPECT_FALSE(pool.wait_idle(id, 2, ns_per_s / 1000));
        second.release();
        EXPECT_FALSE(pool.wait_idle(id, 1, 0));
        EXPECT_TRUE(pool.wait_idle(id, 2, 0));
    }
    EXPECT_TRUE(pool.wait_idle(id, 1, 0));
    EXPECT_TRUE(pool.wait_idle(12345, 0, 0));  // not there: free
}

TEST(SwapchainPool, WaitingEndsWhenTheImageIsFree) {
    SwapchainPool pool(test_device());
    const std::uint64_t id = make_swapchain(pool, VK_FORMAT_R8G8B8A8_SRGB, 4, 4);
    ImageUse use = pool.use({layer_of(id, 0)});
    std::thread other([&] { use.release(); });
    EXPECT_TRUE(pool.wait_idle(id, 0, INT64_MAX));
    other.join();
}

TEST(SwapchainPool, DestroyedSwapchainsStayWhileTheyAreRead) {
    SwapchainPool pool(test_device());
    const std::uint64_t id = make_swapchain(pool, VK_FORMAT_R8G8B8A8_SRGB, 4, 4, 2);
    ImageUse use = pool.use({layer_of(id, 0)});
    pool.destroy(id);
    EXPECT_EQ(pool.swapchains(), 0u);
    EXPECT_TRUE(use.find(layer_of(id, 0, 1).views[0].image));
    EXPECT_FALSE(use.find(layer_of(id, 0, 2).views[0].image));
    EXPECT_FALSE(use.find(layer_of(id, 1).views[0].image));
    EXPECT_FALSE(pool.use({layer_of(id, 0)}).find(layer_of(id, 0).views[0].image));
    use.release();
}

TEST(SwapchainPool, DepthIsNotAPicture) {
    SwapchainPool pool(test_device());
    SwapchainRequest request;
    request.vk_format = VK_FORMAT_D32_SFLOAT;
    request.width = request.height = 4;
    request.vk_usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT;
    const SwapchainAllocation allocation = must(pool.create(request));
    for (const ImageMemory& memory : allocation.images) close(memory.fd);
    EXPECT_FALSE(pool.use({layer_of(allocation.id, 0)}).find(layer_of(allocation.id, 0).views[0].image));
}

}  // namespace
}  // namespace entoptic::compositor
