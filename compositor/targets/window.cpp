#include "compositor/targets/window.h"

#ifndef ENTOPTIC_HAVE_XCB

namespace entoptic::compositor {

Result<std::unique_ptr<DisplayTarget>> make_window_target(gpu::Device&, const WindowOptions&) {
    return missing("This build has no window: install libxcb1-dev and configure again, or run without a window.");
}

}  // namespace entoptic::compositor

#else

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <vector>
#include <xcb/xcb.h>

#include <vulkan/vulkan_xcb.h>

namespace entoptic::compositor {
namespace {

constexpr std::uint32_t largest_window = 1280;  // pixels across, at first
constexpr xcb_keysym_t key_s = 's', key_c = 'c', key_q = 'q', key_escape = 0xff1b;

xcb_atom_t atom(xcb_connection_t* connection, const char* name) {
    const auto cookie = xcb_intern_atom(connection, 0, static_cast<std::uint16_t>(std::char_traits<char>::length(name)), name);
    xcb_intern_atom_reply_t* reply = xcb_intern_atom_reply(connection, cookie, nullptr);
    const xcb_atom_t result = reply ? reply->atom : xcb_atom_t(XCB_ATOM_NONE);
    std::free(reply);
    return result;
}

void layout_barrier(VkCommandBuffer commands, VkImage image, VkImageLayout from, VkImageLayout to, VkAccessFlags source,
                    VkAccessFlags destination) {
    VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.srcAccessMask = source;
    barrier.dstAccessMask = destination;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

class Window final : public DisplayTarget {
public:
    Window(gpu::Device& device, const WindowOptions& options) : device_(device), options_(options), seen_(options.seen) {}
    ~Window() override;
    Result<void> open();

    Result<void> test(const PresentState& state) override;
    Result<void> commit(const PresentState& state) override;
    bool take_recentre_wish() override { return recentre_.exchange(false); }
    bool close_wanted() const override { return closed_; }
    std::string description() const override { return "window"; }

private:
    Result<void> open_window();
    Result<void> open_surface();
    Result<void> make_swapchain();
    void destroy_swapchain();
    Result<VkPresentModeKHR> present_mode() const;
    void handle_events();
    void handle_key(xcb_keycode_t code);
    Result<void> record(const PresentState& state, VkImage target);
    Result<void> present(std::uint32_t index);

    gpu::Device& device_;
    WindowOptions options_;
    xcb_connection_t* connection_ = nullptr;
    xcb_window_t window_ = 0;
    xcb_atom_t delete_window_ = XCB_ATOM_NONE;
    std::uint32_t width_ = 0, height_ = 0;
    VkSurfaceKHR surface_ = VK_NULL_HANDLE;
    VkSwapchainKHR swapchain_ = VK_NULL_HANDLE;
    VkExtent2D extent_{};
    std::vector<VkImage> images_;
    std::vector<VkSemaphore> drawn_;  // one an image: presentation may still wait for it
    VkSemaphore acquired_ = VK_NULL_HANDLE;
    gpu::Image picture_;  // both eyes side by side
    gpu::Commands commands_;
    std::atomic<bool> closed_{false}, recentre_{false};
    bool seen_ = false, resized_ = false;
};

Window::~Window() {
    if (commands_.handle()) (void)commands_.wait();
    {
        const std::lock_guard lock(device_.queue_mutex());
        vkQueueWaitIdle(device_.queue());
    }
    destroy_swapchain();
    vkDestroySemaphore(device_.handle(), acquired_, nullptr);
    if (surface_) vkDestroySurfaceKHR(device_.instance(), surface_, nullptr);
    if (connection_) xcb_disconnect(connection_);
}

Result<void> Window::open() {
    ENTOPTIC_CHECK(open_window());
    ENTOPTIC_CHECK(open_surface());
    gpu::ImageInfo info;
    info.format = VK_FORMAT_R8G8B8A8_UNORM;
    info.width = eye_count * options_.panel.width;
    info.height = options_.panel.height;
    info.usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    info.name = "window picture";
    ENTOPTIC_TRY(picture, gpu::Image::create(device_, info));
    picture_ = std::move(picture);
    ENTOPTIC_TRY(commands, gpu::Commands::create(device_, "window"));
    commands_ = std::move(commands);
    const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, nullptr, 0};
    ENTOPTIC_VK(vkCreateSemaphore(device_.handle(), &semaphore, nullptr, &acquired_));
    return make_swapchain();
}

Result<void> Window::open_window() {
    int screen_number = 0;
    connection_ = xcb_connect(nullptr, &screen_number);
    if (xcb_connection_has_error(connection_))
        return missing("There is no X server to open a window on. Set DISPLAY, run under xvfb-run, or run without a window.");
    xcb_screen_iterator_t screens = xcb_setup_roots_iterator(xcb_get_setup(connection_));
    for (int i = 0; i < screen_number && screens.rem > 1; ++i) xcb_screen_next(&screens);
    const std::uint32_t across = eye_count * options_.panel.width;
    width_ = std::min(across, largest_window);
    height_ = std::max<std::uint32_t>(1, static_cast<std::uint32_t>(std::uint64_t(options_.panel.height) * width_ / across));
    window_ = xcb_generate_id(connection_);
    const std::uint32_t events[] = {XCB_EVENT_MASK_KEY_PRESS | XCB_EVENT_MASK_STRUCTURE_NOTIFY};
    xcb_create_window(connection_, XCB_COPY_FROM_PARENT, window_, screens.data->root, 0, 0, static_cast<std::uint16_t>(width_),
                      static_cast<std::uint16_t>(height_), 0, XCB_WINDOW_CLASS_INPUT_OUTPUT, screens.data->root_visual, XCB_CW_EVENT_MASK,
                      events);
    xcb_change_property(connection_, XCB_PROP_MODE_REPLACE, window_, XCB_ATOM_WM_NAME, XCB_ATOM_STRING, 8,
                        static_cast<std::uint32_t>(options_.title.size()), options_.title.data());
    const xcb_atom_t protocols = atom(connection_, "WM_PROTOCOLS");
    delete_window_ = atom(connection_, "WM_DELETE_WINDOW");
    xcb_change_property(connection_, XCB_PROP_MODE_REPLACE, window_, protocols, XCB_ATOM_ATOM, 32, 1, &delete_window_);
    xcb_map_window(connection_, window_);
    xcb_flush(connection_);
    return {};
}

Result<void> Window::open_surface() {
    const auto create = reinterpret_cast<PFN_vkCreateXcbSurfaceKHR>(vkGetInstanceProcAddr(device_.instance(), "vkCreateXcbSurfaceKHR"));
    if (!device_.has_windows() || !create) return missing("The Vulkan driver cannot draw in X11 windows. Run without a window.");
    VkXcbSurfaceCreateInfoKHR info{VK_STRUCTURE_TYPE_XCB_SURFACE_CREATE_INFO_KHR};
    info.connection = connection_;
    info.window = window_;
    ENTOPTIC_VK(create(device_.instance(), &info, nullptr, &surface_));
    VkBool32 supported = VK_FALSE;
    ENTOPTIC_VK(vkGetPhysicalDeviceSurfaceSupportKHR(device_.physical(), device_.queue_family(), surface_, &supported));
    if (!supported) return missing("The Vulkan device cannot present to this X server. Run without a window.");
    return {};
}

Result<VkPresentModeKHR> Window::present_mode() const {
    std::uint32_t count = 0;
    ENTOPTIC_VK(vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical(), surface_, &count, nullptr));
    std::vector<VkPresentModeKHR> modes(count);
    ENTOPTIC_VK(vkGetPhysicalDeviceSurfacePresentModesKHR(device_.physical(), surface_, &count, modes.data()));
    // The compositor keeps its own time; a present that blocks would spoil it.
    for (const VkPresentModeKHR wanted : {VK_PRESENT_MODE_MAILBOX_KHR, VK_PRESENT_MODE_IMMEDIATE_KHR})
        if (std::find(modes.begin(), modes.end(), wanted) != modes.end()) return wanted;
    return VK_PRESENT_MODE_FIFO_KHR;
}

Result<void> Window::make_swapchain() {
    VkSurfaceCapabilitiesKHR capabilities{};
    ENTOPTIC_VK(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_.physical(), surface_, &capabilities));
    std::uint32_t count = 0;
    ENTOPTIC_VK(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, &count, nullptr));
    std::vector<VkSurfaceFormatKHR> formats(count);
    ENTOPTIC_VK(vkGetPhysicalDeviceSurfaceFormatsKHR(device_.physical(), surface_, &count, formats.data()));
    const auto unorm = std::find_if(formats.begin(), formats.end(), [](const VkSurfaceFormatKHR& f) {  // codes go through as they are
        return f.format == VK_FORMAT_B8G8R8A8_UNORM || f.format == VK_FORMAT_R8G8B8A8_UNORM;
    });
    if (unorm == formats.end()) return missing("The X server offers no 8-bit surface format. Run without a window.");
    ENTOPTIC_TRY(mode, present_mode());
    const bool own_size = capabilities.currentExtent.width == UINT32_MAX;
    extent_ = own_size ? VkExtent2D{width_, height_} : capabilities.currentExtent;
    if (extent_.width == 0 || extent_.height == 0) return {};  // minimised
    VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
    info.surface = surface_;
    info.minImageCount =
        capabilities.maxImageCount ? std::min(capabilities.minImageCount + 1, capabilities.maxImageCount) : capabilities.minImageCount + 1;
    info.imageFormat = unorm->format;
    info.imageColorSpace = unorm->colorSpace;
    info.imageExtent = extent_;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
    info.preTransform = capabilities.currentTransform;
    info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    info.presentMode = mode;
    info.clipped = VK_TRUE;
    ENTOPTIC_VK(vkCreateSwapchainKHR(device_.handle(), &info, nullptr, &swapchain_));
    ENTOPTIC_VK(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, nullptr));
    images_.resize(count);
    ENTOPTIC_VK(vkGetSwapchainImagesKHR(device_.handle(), swapchain_, &count, images_.data()));
    drawn_.resize(count, VK_NULL_HANDLE);
    const VkSemaphoreCreateInfo semaphore{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, nullptr, 0};
    for (VkSemaphore& drawn : drawn_) ENTOPTIC_VK(vkCreateSemaphore(device_.handle(), &semaphore, nullptr, &drawn));
    resized_ = false;
    return {};
}

void Window::destroy_swapchain() {
    for (VkSemaphore drawn : drawn_) vkDestroySemaphore(device_.handle(), drawn, nullptr);
    if (swapchain_) vkDestroySwapchainKHR(device_.handle(), swapchain_, nullptr);
    drawn_.clear();
    images_.clear();
    swapchain_ = VK_NULL_HANDLE;
}

void Window::handle_key(xcb_keycode_t code) {
    xcb_get_keyboard_mapping_reply_t* map =
        xcb_get_keyboard_mapping_reply(connection_, xcb_get_keyboard_mapping(connection_, code, 1), nullptr);
    const bool known = map && xcb_get_keyboard_mapping_keysyms_length(map) > 0;
    const xcb_keysym_t key = known ? xcb_get_keyboard_mapping_keysyms(map)[0] : xcb_keysym_t(XCB_NO_SYMBOL);
    std::free(map);
    if (key == key_s) seen_ = !seen_;
    if (key == key_c) recentre_ = true;
    if (key == key_q || key == key_escape) closed_ = true;
}

void Window::handle_events() {
    while (xcb_generic_event_t* event = xcb_poll_for_event(connection_)) {
        switch (event->response_type & 0x7f) {
            case XCB_KEY_PRESS:
                handle_key(reinterpret_cast<xcb_key_press_event_t*>(event)->detail);
                break;
            case XCB_CLIENT_MESSAGE:
                if (reinterpret_cast<xcb_client_message_event_t*>(event)->data.data32[0] == delete_window_) closed_ = true;
                break;
            case XCB_CONFIGURE_NOTIFY: {
                const auto* configure = reinterpret_cast<xcb_configure_notify_event_t*>(event);
                resized_ = resized_ || configure->width != width_ || configure->height != height_;
                width_ = configure->width;
                height_ = configure->height;
                break;
            }
            default:
                break;
        }
        std::free(event);
    }
    if (xcb_connection_has_error(connection_)) closed_ = true;
}

Result<void> Window::test(const PresentState&) {
    handle_events();
    return {};
}

Result<void> Window::commit(const PresentState& state) {
    if (closed_) return {};
    if (resized_ || !swapchain_) {
        {
            const std::lock_guard lock(device_.queue_mutex());
            vkQueueWaitIdle(device_.queue());
        }
        destroy_swapchain();
        ENTOPTIC_CHECK(make_swapchain());
        if (!swapchain_) return {};
    }
    std::uint32_t index = 0;
    const VkResult acquired = vkAcquireNextImageKHR(device_.handle(), swapchain_, UINT64_MAX, acquired_, VK_NULL_HANDLE, &index);
    if (acquired == VK_ERROR_OUT_OF_DATE_KHR) {
        resized_ = true;
        return {};
    }
    if (acquired != VK_SUCCESS && acquired != VK_SUBOPTIMAL_KHR) return forward_error(gpu::vulkan_error("vkAcquireNextImageKHR", acquired));
    ENTOPTIC_CHECK(commands_.begin());
    ENTOPTIC_CHECK(record(state, images_[index]));
    ENTOPTIC_CHECK(commands_.submit(acquired_, VK_PIPELINE_STAGE_TRANSFER_BIT, drawn_[index]));
    ENTOPTIC_CHECK(commands_.wait());
    return present(index);
}

Result<void> Window::record(const PresentState& state, VkImage target) {
    const gpu::Buffer* codes = state.path->panel().codes;
    if (seen_) {
        ENTOPTIC_TRY(seen, state.path->record_seen(commands_));
        codes = &seen->picture();
    }
    const PictureSize eye = options_.panel;
    const VkCommandBuffer commands = commands_.handle();
    layout_barrier(commands, picture_.handle(), VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0,
                   VK_ACCESS_TRANSFER_WRITE_BIT);
    layout_barrier(commands, target, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0, VK_ACCESS_TRANSFER_WRITE_BIT);
    std::array<VkBufferImageCopy, eye_count> regions{};
    for (std::uint32_t i = 0; i < eye_count; ++i) {
        regions[i].bufferOffset = i * eye.pixels() * sizeof(std::uint32_t);
        regions[i].imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        regions[i].imageOffset.x = static_cast<std::int32_t>(i * eye.width);
        regions[i].imageExtent = {eye.width, eye.height, 1};
    }
    vkCmdCopyBufferToImage(commands, codes->handle(), picture_.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, eye_count, regions.data());
    layout_barrier(commands, picture_.handle(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                   VK_ACCESS_TRANSFER_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT);
    VkImageBlit blit{};
    blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    blit.srcOffsets[1] = {static_cast<std::int32_t>(eye_count * eye.width), static_cast<std::int32_t>(eye.height), 1};
    blit.dstOffsets[1] = {static_cast<std::int32_t>(extent_.width), static_cast<std::int32_t>(extent_.height), 1};
    vkCmdBlitImage(commands, picture_.handle(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, target, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                   &blit, VK_FILTER_LINEAR);
    layout_barrier(commands, target, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_ACCESS_TRANSFER_WRITE_BIT,
                   0);
    return {};
}

Result<void> Window::present(std::uint32_t index) {
    VkPresentInfoKHR info{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = &drawn_[index];
    info.swapchainCount = 1;
    info.pSwapchains = &swapchain_;
    info.pImageIndices = &index;
    const std::lock_guard lock(device_.queue_mutex());
    const VkResult result = vkQueuePresentKHR(device_.queue(), &info);
    resized_ = resized_ || result == VK_ERROR_OUT_OF_DATE_KHR || result == VK_SUBOPTIMAL_KHR;
    if (result != VK_SUCCESS && result != VK_SUBOPTIMAL_KHR && result != VK_ERROR_OUT_OF_DATE_KHR)
        return forward_error(gpu::vulkan_error("vkQueuePresentKHR", result));
    return {};
}

}  // namespace

Result<std::unique_ptr<DisplayTarget>> make_window_target(gpu::Device& device, const WindowOptions& options) {
    auto window = std::make_unique<Window>(device, options);
    ENTOPTIC_CHECK(window->open());
    return window;
}

}  // namespace entoptic::compositor

#endif
