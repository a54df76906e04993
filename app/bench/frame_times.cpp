#include "app/bench/frame_times.h"

#include "app/bench/bench_scene.h"
#include "app/bench/timed_frames.h"
#include "compositor/frame.h"
#include "compositor/images.h"
#include "drivers/driver.h"
#include "perception/preset.h"

#include <unistd.h>

namespace entoptic::app {
namespace {

using namespace compositor;

void hand_over(gpu::Commands& commands, VkImage image, VkImageLayout from, VkImageLayout to, std::uint32_t from_family,
               std::uint32_t to_family) {
    VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.srcAccessMask = from == VK_IMAGE_LAYOUT_UNDEFINED ? 0 : VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = from == VK_IMAGE_LAYOUT_UNDEFINED ? VK_ACCESS_TRANSFER_WRITE_BIT : 0;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = from_family;
    barrier.dstQueueFamilyIndex = to_family;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    vkCmdPipelineBarrier(commands.handle(), VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0,
                         nullptr, 1, &barrier);
}

// A picture in a swapchain image, written and handed over as an application does (compositor/images.h).
class Picture {
public:
    Picture(gpu::Device& device, SwapchainPool& pool) : device_(device), pool_(pool) {}
    ~Picture() { pool_.destroy(image_.swapchain); }
    Picture(const Picture&) = delete;
    Picture& operator=(const Picture&) = delete;

    Result<void> fill(const ImageF& rgb) {
        SwapchainRequest request;
        request.vk_format = VK_FORMAT_R32G32B32A32_SFLOAT;
        request.width = static_cast<std::uint32_t>(rgb.width);
        request.height = static_cast<std::uint32_t>(rgb.height);
        request.vk_usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
        request.is_static = true;
        ENTOPTIC_TRY(allocation, pool_.create(request));
        for (const ImageMemory& memory : allocation.images) close(memory.fd);
        image_ = {allocation.id, 0, 0, 0, 0, rgb.width, rgb.height};
        return upload(rgb);
    }
    // Seen by both eyes from where they are.
    Layer layer(const std::array<EyeOptics, eye_count>& eyes) const {
        Layer layer;
        layer.luminance = {1, 0, LuminanceSource::layer_extension};
        for (std::size_t eye = 0; eye < eye_count; ++eye) layer.views[eye] = {eyes[eye].head_from_eye, eyes[eye].fov, image_};
        return layer;
    }

private:
    Result<void> upload(const ImageF& rgb) {
        Layer named;
        named.kind = LayerKind::quad;
        named.views[0].image = image_;
        const ImageUse use = pool_.use({named});
        ENTOPTIC_TRY(image, use.find(image_));
        const std::size_t pixels = std::size_t(rgb.width) * std::size_t(rgb.height);
        ENTOPTIC_TRY(staging, gpu::Buffer::create(device_, pixels * sizeof(vec4), gpu::BufferKind::upload, "bench picture"));
        const auto texels = staging.as<vec4>();
        for (std::size_t i = 0; i < pixels; ++i) texels[i] = vec4(rgb.data[3 * i], rgb.data[3 * i + 1], rgb.data[3 * i + 2], 1);
        ENTOPTIC_TRY(commands, gpu::Commands::create(device_, "bench picture"));
        ENTOPTIC_CHECK(commands.begin());
        hand_over(commands, image.image, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_QUEUE_FAMILY_IGNORED,
                  VK_QUEUE_FAMILY_IGNORED);
        VkBufferImageCopy region{};
        region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
        region.imageExtent = {static_cast<std::uint32_t>(rgb.width), static_cast<std::uint32_t>(rgb.height), 1};
        vkCmdCopyBufferToImage(commands.handle(), staging.handle(), image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
        hand_over(commands, image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_GENERAL, device_.queue_family(),
                  VK_QUEUE_FAMILY_EXTERNAL);
        ENTOPTIC_CHECK(commands.submit());
        return commands.wait();
    }

    gpu::Device& device_;
    SwapchainPool& pool_;
    SubImage image_;
};

// Of each stage of the last frame, over all frames but those in which pipelines are compiled.
std::vector<std::pair<std::string, double>> stage_medians(const std::vector<std::vector<StageMs>>& frames) {
    std::vector<std::pair<std::string, double>> medians;
    for (const StageMs& stage : frames.back()) {
        std::vector<double> times;
        for (std::size_t i = std::min<std::size_t>(2, frames.size() - 1); i < frames.size(); ++i)
            for (const StageMs& other : frames[i])
                if (other.name == stage.name) times.push_back(other.ms);
        medians.emplace_back(stage.name, percentiles(std::move(times)).median);
    }
    return medians;
}

class FrameBench {
public:
    FrameBench(gpu::Device& device, const Headset& headset, const EffectBenchOptions& options)
        : device_(device), headset_(headset), o_(options), pool_(device) {}

    Result<FrameTime> medians(const std::string& preset, const ImageF& scene, bool fuse = true) {
        ENTOPTIC_TRY(selection, perception::select(preset));
        FramePathOptions options;
        options.panel = {static_cast<std::uint32_t>(headset_.display.panel_width),
                         static_cast<std::uint32_t>(headset_.display.panel_height)};
        options.eyes = headset_.eyes;
        options.selection = selection;
        options.fuse = fuse;
        ENTOPTIC_TRY(path, FramePath::create(device_, options));
        Picture picture(device_, pool_);
        ENTOPTIC_CHECK(picture.fill(scene));
        const std::vector<Layer> layers{picture.layer(headset_.eyes)};
        std::vector<std::vector<StageMs>> stages;
        ENTOPTIC_TRY(times, timed_frames(o_.frames, 2 * o_.seconds, [&](std::uint64_t index) -> Result<double> {
                         ENTOPTIC_TRY(outcome, path->compose(frame(layers, index), pool_.use(layers)));
                         stages.push_back(outcome.gpu_ms);
                         double ms = 0;
                         for (const StageMs& stage : outcome.gpu_ms) ms += stage.ms;
                         return ms;
                     }));
        return FrameTime{preset, times.median, stage_medians(stages)};
    }

private:
    FrameDescription frame(const std::vector<Layer>& layers, std::uint64_t index) const {
        FrameDescription frame;
        frame.index = index;
        frame.layers = layers;
        for (std::size_t eye = 0; eye < eye_count; ++eye) frame.head_from_eye[eye] = headset_.eyes[eye].head_from_eye;
        frame.perception.dt_s = 1.0 / 90;
        frame.perception.snap = index == 0;
        frame.perception.index = index;
        frame.perception.eyes.resize(eye_count);
        return frame;
    }

    gpu::Device& device_;
    const Headset& headset_;
    const EffectBenchOptions& o_;
    SwapchainPool pool_;
};

}  // namespace

Result<FrameTimes> frame_times(gpu::Device& device, const EffectBenchOptions& options) {
    drivers::DriverOptions wanted;
    wanted.panel_width = options.width;
    wanted.panel_height = options.height;
    ENTOPTIC_TRY(headset, drivers::open_headset(wanted));
    FrameBench bench(device, headset, options);
    const ImageF scene = bench_scene(options.width, options.height);
    const std::size_t total = perception::presets().size() + 2;  // and `off` in stages, and the default preset with nothing to see
    std::size_t done = 0;
    const auto measure = [&](const std::string& preset, const ImageF& image, bool fuse = true) {
        auto time = bench.medians(preset, image, fuse);
        if (options.progress) options.progress(++done, total);
        return time;
    };
    FrameTimes times;
    for (const perception::Preset& preset : perception::presets()) {
        ENTOPTIC_TRY(time, measure(std::string(preset.name), scene));
        if (preset.name == "off") times.off = time;
        else times.presets.push_back(time);
    }
    ENTOPTIC_TRY(in_stages, measure("off", scene, false));
    times.off_in_stages = in_stages;
    ENTOPTIC_TRY(idle, measure(std::string(perception::default_preset), ImageF(options.width, options.height, 3, 20.0f)));
    times.idle = idle;
    return times;
}

double FrameTime::stage_ms(const std::string& name) const {
    double sum = 0;
    for (const auto& [stage, ms] : stages_ms)
        if (stage == name || stage.starts_with(name + ".")) sum += ms;
    return sum;
}

}  // namespace entoptic::app
