#include "compositor/images.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <unistd.h>

namespace entoptic::compositor {

struct SwapchainImages {
    gpu::Device* device = nullptr;
    std::uint64_t id = 0;
    std::vector<gpu::Image> images;
    std::vector<std::uint32_t> users;             // an image
    std::vector<std::vector<VkImageView>> views;  // an image, an array layer; made when first sampled

    ~SwapchainImages() {
        for (const auto& layers : views)
            for (VkImageView view : layers)
                if (view) vkDestroyImageView(device->handle(), view, nullptr);
    }
};

struct PoolState {
    std::mutex mutex;
    std::condition_variable changed;
    std::map<std::uint64_t, std::shared_ptr<SwapchainImages>> swapchains;
    std::uint64_t next_id = 1;
};

namespace {

constexpr std::uint32_t images_of_swapchain = 3;

bool is_depth(VkFormat format) {
    return format == VK_FORMAT_D32_SFLOAT || format == VK_FORMAT_D16_UNORM || format == VK_FORMAT_D24_UNORM_S8_UINT ||
           format == VK_FORMAT_D32_SFLOAT_S8_UINT;
}
VkImageAspectFlags aspects_of(VkFormat format) {
    if (!is_depth(format)) return VK_IMAGE_ASPECT_COLOR_BIT;
    const bool stencil = format == VK_FORMAT_D24_UNORM_S8_UINT || format == VK_FORMAT_D32_SFLOAT_S8_UINT;
    return stencil ? VK_IMAGE_ASPECT_DEPTH_BIT | VK_IMAGE_ASPECT_STENCIL_BIT : VK_IMAGE_ASPECT_DEPTH_BIT;
}
bool is_float(VkFormat format) { return format == VK_FORMAT_R16G16B16A16_SFLOAT || format == VK_FORMAT_R32G32B32A32_SFLOAT; }

bool is_srgb8(VkFormat format) { return format == VK_FORMAT_R8G8B8A8_SRGB || format == VK_FORMAT_B8G8R8A8_SRGB; }

bool usable(const gpu::Device& device, VkFormat format) {
    VkFormatProperties properties{};
    vkGetPhysicalDeviceFormatProperties(device.physical(), format, &properties);
    const VkFormatFeatureFlags wanted = is_depth(format)
                                            ? VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT
                                            : VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT |
                                                  VK_FORMAT_FEATURE_COLOR_ATTACHMENT_BIT;
    return (properties.optimalTilingFeatures & wanted) == wanted;
}

std::string size_limits(const gpu::Device& device, const SwapchainRequest& r) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(device.physical(), &properties);
    const auto& limits = properties.limits;
    const std::uint32_t largest = std::max({r.width, r.height, 1u});
    std::uint32_t levels = 1;
    while (largest >> levels) ++levels;
    if (r.width == 0 || r.height == 0 || r.width > limits.maxImageDimension2D || r.height > limits.maxImageDimension2D)
        return fmt::format("{}×{} is not within 1 and {}", r.width, r.height, limits.maxImageDimension2D);
    if (r.array_layers == 0 || r.array_layers > limits.maxImageArrayLayers)
        return fmt::format("{} array layers; the device has {}", r.array_layers, limits.maxImageArrayLayers);
    if (r.mip_levels == 0 || r.mip_levels > levels) return fmt::format("{} mip levels; that size has {}", r.mip_levels, levels);
    if (r.samples != 1) return fmt::format("{} samples a pixel; resolve to 1 before the frame is submitted", r.samples);
    return {};
}

ImageMemory describe(const gpu::Device& device, const gpu::Image& image, int fd) {
    ImageMemory memory;
    const gpu::ImageInfo& info = image.info();
    memory.fd = fd;
    memory.size = image.memory_size();
    memory.vk_format = static_cast<std::uint32_t>(info.format);
    memory.vk_usage = info.usage;
    memory.vk_create_flags = info.flags;
    memory.width = info.width;
    memory.height = info.height;
    memory.array_layers = info.layers;
    memory.mip_levels = info.mips;
    memory.samples = 1;
    memory.memory_type_bits = image.memory_type_bits();
    memory.device_uuid = device.device_uuid();
    memory.driver_uuid = device.driver_uuid();
    return memory;
}

template <class Visit> void for_each_image(const std::vector<Layer>& layers, Visit visit) {
    for (const Layer& layer : layers) {
        visit(layer.views[0].image);
        if (layer.kind != LayerKind::projection) continue;
        visit(layer.views[1].image);
        for (const entoptic::LayerView& view : layer.views)
            if (view.depth.image.width > 0) visit(view.depth.image);
    }
}

}  // namespace

ImageUse& ImageUse::operator=(ImageUse&& other) noexcept {
    std::swap(state_, other.state_);
    std::swap(held_, other.held_);
    return *this;
}

void ImageUse::release() {
    if (!state_) return;
    std::vector<Held> held;
    {
        const std::lock_guard lock(state_->mutex);
        for (const Held& h : held_) --h.swapchain->users[h.index];
        held.swap(held_);
        state_->changed.notify_all();
    }
    state_.reset();  // images of a destroyed swapchain go here, outside the lock
}

Result<SampledImage> ImageUse::find(const SubImage& wanted) const { return find(wanted, false); }
Result<SampledImage> ImageUse::find_depth(const SubImage& wanted) const { return find(wanted, true); }

Result<SampledImage> ImageUse::find(const SubImage& wanted, bool depth) const {
    const auto held = std::find_if(held_.begin(), held_.end(),
                                   [&](const Held& h) { return h.swapchain->id == wanted.swapchain && h.index == wanted.image_index; });
    if (held == held_.end()) return failure(fmt::format("A layer names an image of swapchain {} that is not there.", wanted.swapchain));
    SwapchainImages& chain = *held->swapchain;
    const gpu::Image& image = chain.images[held->index];
    if (wanted.array_layer >= image.info().layers)
        return failure(fmt::format("A layer names array slice {} of an image with {}.", wanted.array_layer, image.info().layers));
    const VkFormat format = image.info().format;
    if (depth != is_depth(format)) {
        return failure(depth ? "A layer's depth names an image with a colour format; it needs depth."
                             : "A layer names an image with a depth format; layers need colour.");
    }
    const std::lock_guard lock(state_->mutex);
    VkImageView& view = chain.views[held->index][wanted.array_layer];
    if (!view) {
        ENTOPTIC_TRY(created, image.create_view(wanted.array_layer, format, depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT));
        view = created;
    }
    return SampledImage{image.handle(), view, is_float(format), is_srgb8(format), aspects_of(format)};
}

SwapchainPool::SwapchainPool(gpu::Device& device) : device_(device), state_(std::make_shared<PoolState>()) {
    constexpr std::array<VkFormat, 12> wanted{VK_FORMAT_R8G8B8A8_SRGB,
                                              VK_FORMAT_B8G8R8A8_SRGB,
                                              VK_FORMAT_R16G16B16A16_SFLOAT,
                                              VK_FORMAT_R32G32B32A32_SFLOAT,
                                              VK_FORMAT_R16G16B16A16_UNORM,
                                              VK_FORMAT_A2B10G10R10_UNORM_PACK32,
                                              VK_FORMAT_R8G8B8A8_UNORM,
                                              VK_FORMAT_B8G8R8A8_UNORM,
                                              VK_FORMAT_D32_SFLOAT,
                                              VK_FORMAT_D16_UNORM,
                                              VK_FORMAT_D24_UNORM_S8_UINT,
                                              VK_FORMAT_D32_SFLOAT_S8_UINT};
    for (VkFormat format : wanted)
        if (usable(device, format)) formats_.push_back(format);
}

std::vector<std::int64_t> SwapchainPool::formats() const { return formats_; }

Result<SwapchainAllocation> SwapchainPool::create(const SwapchainRequest& request) {
    if (!device_.can_export_memory())
        return missing(fmt::format("The Vulkan driver of {} lacks VK_KHR_external_memory_fd, through which images reach applications.",
                                   device_.name()));
    if (std::find(formats_.begin(), formats_.end(), std::int64_t(request.vk_format)) == formats_.end())
        return usage_error(fmt::format("Swapchain format {} (VkFormat) is not offered.", request.vk_format));
    if (const std::string wrong = size_limits(device_, request); !wrong.empty())
        return usage_error("Swapchain cannot be made: " + wrong + ".");

    auto chain = std::make_shared<SwapchainImages>();
    chain->device = &device_;
    gpu::ImageInfo info;
    info.format = static_cast<VkFormat>(request.vk_format);
    info.width = request.width;
    info.height = request.height;
    info.layers = request.array_layers;
    info.mips = request.mip_levels;
    info.usage = request.vk_usage | VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
    info.flags = request.vk_create_flags;
    info.exportable = true;
    SwapchainAllocation allocation;
    const auto close_all = [&] {
        for (const ImageMemory& memory : allocation.images) close(memory.fd);
    };
    for (std::uint32_t i = 0; i < (request.is_static ? 1u : images_of_swapchain); ++i) {
        info.name = fmt::format("swapchain image {}", i);
        auto image = gpu::Image::create(device_, info);
        auto fd = image ? image->export_fd() : Result<int>(forward_error(image.error()));
        if (!fd) {
            close_all();
            return forward_error(fd.error());
        }
        allocation.images.push_back(describe(device_, *image, *fd));
        chain->images.push_back(std::move(*image));
    }
    chain->users.assign(chain->images.size(), 0);
    chain->views.assign(chain->images.size(), std::vector<VkImageView>(request.array_layers, VK_NULL_HANDLE));
    const std::lock_guard lock(state_->mutex);
    allocation.id = chain->id = state_->next_id++;
    state_->swapchains[chain->id] = std::move(chain);
    return allocation;
}

void SwapchainPool::destroy(std::uint64_t id) {
    std::shared_ptr<SwapchainImages> last;
    const std::lock_guard lock(state_->mutex);
    if (const auto found = state_->swapchains.find(id); found != state_->swapchains.end()) {
        last = std::move(found->second);
        state_->swapchains.erase(found);
    }
    state_->changed.notify_all();
}

ImageUse SwapchainPool::use(const std::vector<Layer>& layers) {
    ImageUse use;
    use.state_ = state_;
    const std::lock_guard lock(state_->mutex);
    for_each_image(layers, [&](const SubImage& image) {
        const auto found = state_->swapchains.find(image.swapchain);
        if (found == state_->swapchains.end() || image.image_index >= found->second->images.size()) return;
        ++found->second->users[image.image_index];
        use.held_.push_back({found->second, image.image_index});
    });
    return use;
}

bool SwapchainPool::wait_idle(std::uint64_t id, std::uint32_t image_index, DurationNs timeout) {
    std::unique_lock lock(state_->mutex);
    const auto idle = [&] {
        const auto found = state_->swapchains.find(id);
        return found == state_->swapchains.end() || image_index >= found->second->users.size() || found->second->users[image_index] == 0;
    };
    constexpr DurationNs forever = 3600 * 24 * ns_per_s;  // longer timeouts overflow inside the library
    if (timeout < forever) return state_->changed.wait_for(lock, std::chrono::nanoseconds(std::max<DurationNs>(timeout, 0)), idle);
    state_->changed.wait(lock, idle);
    return true;
}

std::size_t SwapchainPool::swapchains() const {
    const std::lock_guard lock(state_->mutex);
    return state_->swapchains.size();
}

}  // namespace entoptic::compositor
