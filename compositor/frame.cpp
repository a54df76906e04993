#include "compositor/frame.h"

#include "compositor/eye_view.h"
#include "compositor/layer_views.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace entoptic::compositor {
namespace {

constexpr double longest_step_s = 2;  // of adaptation; a longer gap is a new beginning
constexpr float dither_amplitude = 0.98f;

VkImageMemoryBarrier ownership_transfer(VkImage image, VkImageAspectFlags aspects, std::uint32_t family, bool acquire) {
    VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.srcAccessMask = 0;
    barrier.dstAccessMask = acquire ? VK_ACCESS_SHADER_READ_BIT : 0;
    barrier.oldLayout = barrier.newLayout = VK_IMAGE_LAYOUT_GENERAL;
    barrier.srcQueueFamilyIndex = acquire ? VK_QUEUE_FAMILY_EXTERNAL : family;
    barrier.dstQueueFamilyIndex = acquire ? family : VK_QUEUE_FAMILY_EXTERNAL;
    barrier.image = image;
    barrier.subresourceRange = {aspects, 0, VK_REMAINING_MIP_LEVELS, 0, VK_REMAINING_ARRAY_LAYERS};
    return barrier;
}

std::uint32_t scaled(std::uint32_t size, double scale) { return std::max(1u, static_cast<std::uint32_t>(std::lround(size * scale))); }

}  // namespace

void predict(FrameDescription& frame, Headset& headset, TimeNs now, TimeNs display_time, TimeNs last_display_time) {
    frame.pose_time = now;
    frame.display_time = display_time;
    frame.world_from_head = headset.head->pose_at(display_time).pose;
    frame.observer = headset.eye_tracker->observer_at(display_time);
    perception::FrameInput& input = frame.perception;
    input.index = frame.index;
    input.dt_s = last_display_time > 0 ? seconds(display_time - last_display_time) : 0;
    input.snap = last_display_time <= 0 || input.dt_s > longest_step_s;
    input.eyes.resize(eye_count);
    for (std::size_t eye = 0; eye < eye_count; ++eye) {
        const EyeState& state = frame.observer.eyes[eye];
        frame.head_from_eye[eye] = headset.eyes[eye].head_from_eye;
        input.eyes[eye] = {frame.head_from_eye[eye].inverse().rotate(state.gaze_direction), state.pupil_diameter_mm, state.eyelid_open,
                           state.gaze_provenance == Provenance::measured};
    }
    input.vergence_dioptre = vergence_dioptre(frame.observer, frame.head_from_eye);
}

// Wall-clock times of the CPU's part of each stage.
class FramePath::CpuTimes {
public:
    explicit CpuTimes(const Clock* clock) : clock_(clock), last_(clock ? clock->now() : 0) {}
    void stage_ended(const char* name) {
        if (!clock_) return;
        const TimeNs now = clock_->now();
        times.push_back({name, static_cast<double>(now - last_) * 1e-6});
        last_ = now;
    }
    std::vector<StageMs> times;

private:
    const Clock* clock_;
    TimeNs last_;
};

Result<std::unique_ptr<FramePath>> FramePath::create(gpu::Device& device, const FramePathOptions& options) {
    if (options.panel.width < 1 || options.panel.height < 1 || options.panel.width > 16384 || options.panel.height > 16384)
        return usage_error("The panel's size must be within 1×1 and 16384×16384 pixels an eye.");
    if (!(options.eye_scale >= 0.05 && options.eye_scale <= 2)) return usage_error("The eye image's scale must be within 0.05 and 2.");
    if (!(options.display.white_cd_m2 > options.display.black_cd_m2 && options.display.black_cd_m2 >= 0))
        return usage_error("The display's white must be brighter than its black, both in cd/m² and not negative.");
    std::unique_ptr<FramePath> path(new FramePath(device, options));
    ENTOPTIC_CHECK(path->allocate());
    if (!options.selection.choices.empty() || !options.fuse) ENTOPTIC_CHECK(path->ensure_stages());
    return path;
}

FramePath::~FramePath() = default;

Result<void> FramePath::allocate() {
    const PictureSize panel = options_.panel;
    eye_size_ = {scaled(panel.width, options_.eye_scale), scaled(panel.height, options_.eye_scale)};
    for (std::size_t eye = 0; eye < eye_count; ++eye) {
        panel_geometry_[eye] = panel_geometry(options_.eyes[eye], panel.width, panel.height);
        eye_geometry_[eye] = eye_geometry(options_.eyes[eye], eye_size_.width, eye_size_.height);
    }
    ENTOPTIC_TRY(commands, gpu::Commands::create(device_, "frame"));
    commands_ = std::move(commands);
    ENTOPTIC_TRY(layers, LayerTable::create(device_));
    layers_ = std::move(layers);
    ENTOPTIC_TRY(fused, FusedPass::create(device_, panel_geometry_));
    fused_ = std::move(fused);
    ENTOPTIC_TRY(codes,
                 gpu::Buffer::create(device_, eye_count * panel.pixels() * sizeof(std::uint32_t), gpu::BufferKind::device, "panel codes"));
    codes_ = std::move(codes);
    if (options_.measured) {
        ENTOPTIC_TRY(measured, MeasuredPanelPass::create(device_, *options_.measured));
        measured_ = std::move(measured);
    }
    ENTOPTIC_CHECK(commands_.begin());
    commands_.fill(codes_, 0xff000000u);  // passes leave out the tiles that the lens hides
    ENTOPTIC_CHECK(commands_.submit());
    return commands_.wait();
}

Result<void> FramePath::ensure_stages() {
    if (stage_) return {};
    perception::StageOptions stage;
    stage.views.assign(eye_geometry_.begin(), eye_geometry_.end());
    stage.display = options_.display;
    stage.selection = options_.selection;
    stage.seed = options_.seed;
    stage.repeatable = options_.repeatable;
    ENTOPTIC_TRY(warp, WarpPass::create(device_, eye_geometry_));
    ENTOPTIC_TRY(glance, GlancePass::create(device_, eye_geometry_));
    ENTOPTIC_TRY(lens, LensPass::create(device_, panel_geometry_, eye_size_, options_.lens_filter));
    ENTOPTIC_TRY(made, perception::Stage::create(device_, stage));
    warp_ = std::move(warp);
    glance_ = std::move(glance);
    lens_ = std::move(lens);
    stage_ = std::move(made);
    return {};
}

Result<void> FramePath::select(const perception::Selection& selection) {
    options_.selection = selection;
    if (stage_) return stage_->select(selection);
    return selection.choices.empty() ? Result<void>{} : ensure_stages();
}

std::string FramePath::collect(const FrameDescription& frame, const ImageUse& images, bool with_depth) {
    layers_.clear();
    if (depth_) depth_->clear();
    std::string problem;
    for (int eye = 0; eye < eye_count; ++eye) {
        const EyePlace place{frame.world_from_head, frame.head_from_eye[std::size_t(eye)]};
        // The same lens: the one with fewer pixels decides which layers have to be averaged.
        const EyeGeometry& coarser = (options_.eye_scale < 1 ? eye_geometry_ : panel_geometry_)[std::size_t(eye)];
        for (const Layer& layer : frame.layers) {
            const SubImage& sub = layer.views[layer.kind == LayerKind::projection ? std::size_t(eye) : 0].image;
            if (sub.width <= 0 || sub.height <= 0) continue;
            const auto image = images.find(sub);
            if (!image) {
                problem = image.error().message;
                continue;
            }
            const auto view = layer_view(layer, eye, place, coarser, image->is_float);
            if (!view) continue;
            if (!layers_.add(eye, *view, *image)) {
                problem = fmt::format(
                    "An eye sees more than {} layers (an inset and each face of a cube count); those in front are left out.", layer_slots);
                continue;
            }
            if (!with_depth) continue;
            if (const auto added = collect_depth(layer, eye, place, images, *image); !added) problem = added.error().message;
        }
    }
    layers_.upload();
    return problem;
}

Result<void> FramePath::collect_depth(const Layer& layer, int eye, const EyePlace& place, const ImageUse& images,
                                      const SampledImage& colour) {
    auto depth = depth_layer(layer, eye, place, panel_geometry_[std::size_t(eye)]);
    if (!depth) return {};
    if ((depth->flags & depth_sampled) == 0) {
        depth_->add(eye, *depth, colour, nullptr);
        return {};
    }
    const auto image = images.find_depth(layer.views[std::size_t(eye)].depth.image);
    if (!image) depth->flags &= ~(depth_known | depth_sampled);
    depth_->add(eye, *depth, colour, image ? &*image : nullptr);
    return image ? Result<void>{} : Result<void>(forward_error(image.error()));
}

void FramePath::transfer_images(bool acquire) {
    std::vector<VkImageMemoryBarrier> barriers;
    const auto transfer = [&](VkImage image, VkImageAspectFlags aspects) {
        barriers.push_back(ownership_transfer(image, aspects, device_.queue_family(), acquire));
    };
    for (VkImage image : layers_.images()) transfer(image, VK_IMAGE_ASPECT_COLOR_BIT);
    if (depth_)
        for (const SampledImage& image : depth_->images()) transfer(image.image, image.aspects);
    if (barriers.empty()) return;
    const VkPipelineStageFlags outside = acquire ? VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT : VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT;
    const VkPipelineStageFlags ours = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT;
    vkCmdPipelineBarrier(commands_.handle(), acquire ? outside : ours, acquire ? ours : outside, 0, 0, nullptr, 0, nullptr,
                         static_cast<std::uint32_t>(barriers.size()), barriers.data());
}

PanelCurve FramePath::curve(const FrameDescription& frame) const {
    const perception::DisplayRange& display = options_.display;
    // 8-bit codes that nothing changes go to the panel as they came. Noise below half a code would leave them alone only if the device's
    // sRGB decoding were better than Vulkan asks: lavapipe 22.3 is off by up to 0.34 of a code (2.5 % of the light, codes below 16).
    const bool codes_pass = !measured_ && layers_.only_srgb8() && (options_.selection.choices.empty() || is_ordinary());
    return {display.black_cd_m2, 1.0f / (display.white_cd_m2 - display.black_cd_m2),
            options_.dither && !codes_pass ? dither_amplitude : 0.0f, static_cast<std::uint32_t>(frame.index)};
}

bool FramePath::is_ordinary() const {
    return stage_ && stage_->obeys_residual_law() && stage_->at_rest() && layers_.within(options_.display);
}

Result<FrameOutcome> FramePath::compose(const FrameDescription& frame, const ImageUse& images, const WantedPictures& wanted) {
    CpuTimes times(options_.stopwatch);
    FrameOutcome outcome;
    const bool simulates = !options_.selection.choices.empty();
    const bool fuse = options_.fuse && !measured_;
    if (simulates || !fuse || wanted.needs_stages()) ENTOPTIC_CHECK(ensure_stages());
    const bool with_depth = simulates && stage_->wants_depth();
    if (with_depth && !depth_) {
        ENTOPTIC_TRY(depth, DepthPass::create(device_, eye_geometry_));
        depth_ = std::move(depth);
    }
    outcome.problem = collect(frame, images, with_depth);
    times.stage_ended("collect");
    outcome.ordinary = simulates && is_ordinary();
    outcome.fused = fuse && (!simulates || outcome.ordinary) && !wanted.needs_stages();
    ENTOPTIC_CHECK(commands_.begin());
    if (auto recorded = record(frame, wanted, outcome, times); !recorded) {
        vkEndCommandBuffer(commands_.handle());  // so that the next frame can begin
        return forward_error(std::move(recorded.error()));
    }
    ENTOPTIC_CHECK(commands_.submit());
    ENTOPTIC_CHECK(commands_.wait());
    times.stage_ended("gpu");
    for (const gpu::StageTime& time : commands_.stage_times()) outcome.gpu_ms.push_back({time.name, time.ms});
    outcome.cpu_ms = std::move(times.times);
    if (outcome.fused) {
        const auto cleaned = fused_.cleaned();
        for (std::size_t eye = 0; eye < eye_count; ++eye) outcome.views[eye].cleaned = cleaned[eye];
        if (!outcome.ordinary) return outcome;
    }
    stage_->accumulate_totals();
    outcome.effects = stage_->effects();
    for (std::uint32_t eye = 0; eye < eye_count; ++eye) {
        const std::uint32_t cleaned = outcome.views[eye].cleaned;
        outcome.views[eye] = stage_->view(eye);
        outcome.views[eye].cleaned += cleaned;
    }
    return outcome;
}

Result<void> FramePath::record(const FrameDescription& frame, const WantedPictures& wanted, const FrameOutcome& path, CpuTimes& times) {
    for (Download* download : {&warp_download_, &perceive_download_, &lens_download_, &panel_download_, &seen_download_})
        download->filled = false;
    transfer_images(true);
    if (path.fused) {
        ENTOPTIC_CHECK(record_fused(frame, path.ordinary, times));
    } else {
        ENTOPTIC_CHECK(record_stages(frame, wanted, times));
    }
    commands_.barrier();
    transfer_images(false);
    if (wanted.panel) ENTOPTIC_CHECK(download(codes_, panel_download_, "panel"));
    if (wanted.seen) {
        ENTOPTIC_TRY(seen, record_seen(commands_));
        ENTOPTIC_CHECK(download(seen->picture(), seen_download_, "seen"));
    }
    return {};
}

Result<void> FramePath::record_fused(const FrameDescription& frame, bool ordinary, CpuTimes& times) {
    if (ordinary) {
        commands_.begin_stage("glance");
        ENTOPTIC_CHECK(glance_->record(commands_, layers_, *stage_));
        commands_.end_stage();
        commands_.barrier();
        stage_->record_at_rest(commands_, frame.perception);
        times.stage_ended("glance");
    }
    commands_.begin_stage("fused");
    ENTOPTIC_CHECK(fused_.record(commands_, layers_, curve(frame), panel()));
    commands_.end_stage();
    times.stage_ended("fused");
    return {};
}

Result<void> FramePath::record_stages(const FrameDescription& frame, const WantedPictures& wanted, CpuTimes& times) {
    commands_.begin_stage("warp");
    ENTOPTIC_TRY(scene, warp_->record(commands_, layers_, *stage_));
    if (depth_ && stage_->wants_depth()) depth_->record(commands_, *stage_);
    commands_.end_stage();
    commands_.barrier();
    if (wanted.warp) {
        ENTOPTIC_CHECK(download(*scene.pixels, warp_download_, "warp"));
        commands_.barrier();
    }
    times.stage_ended("warp");
    perception::FrameInput input = frame.perception;
    input.within_display = layers_.within(options_.display);
    stage_->record(commands_, input);
    const SeenImage seen{scene.pixels, scene.size};
    if (wanted.perceive) ENTOPTIC_CHECK(download(*seen.pixels, perceive_download_, "perceive"));
    times.stage_ended("perceive");
    commands_.begin_stage("lens");
    if (!wanted.lens && !measured_) {
        ENTOPTIC_CHECK(lens_->record_codes(commands_, seen, curve(frame), panel()));
        commands_.end_stage();
        times.stage_ended("lens");
        return {};
    }
    ENTOPTIC_TRY(light, lens_->record_light(commands_, seen, curve(frame)));
    commands_.end_stage();
    commands_.barrier();
    times.stage_ended("lens");
    if (wanted.lens) ENTOPTIC_CHECK(download(*light.light, lens_download_, "lens"));
    commands_.begin_stage("panel");
    if (measured_) measured_->record(commands_, light, curve(frame), panel());
    else lens_->record_panel(commands_, light, curve(frame), panel());
    commands_.end_stage();
    times.stage_ended("panel");
    return {};
}

Result<void> FramePath::download(const gpu::Buffer& from, Download& into, const char* name) {
    if (!into.buffer) {
        ENTOPTIC_TRY(buffer, gpu::Buffer::create(device_, from.size(), gpu::BufferKind::readback, fmt::format("{} download", name)));
        into.buffer = std::move(buffer);
    }
    commands_.copy(from, into.buffer, from.size());
    into.filled = true;
    return {};
}

Result<const SeenThroughLensPass*> FramePath::record_seen(gpu::Commands& commands) {
    if (!seen_) {
        ENTOPTIC_TRY(pass, SeenThroughLensPass::create(device_, panel_geometry_, options_.panel, measured_.has_value()));
        seen_ = std::move(pass);
    }
    commands.barrier();
    seen_->record(commands, panel(), measured_ ? measured_->tables() : codes_, options_.display);
    commands.barrier();
    return &*seen_;
}

ImageF FramePath::eye_picture(const Download& download, int eye) const {
    if (!download.filled) return {};
    ImageF picture(int(eye_size_.width), int(eye_size_.height), 3);
    const auto pixels = download.buffer.as<vec4>().subspan(std::size_t(eye) * eye_size_.pixels(), eye_size_.pixels());
    for (std::size_t i = 0; i < pixels.size(); ++i)
        for (int c = 0; c < 3; ++c) picture.data[3 * i + std::size_t(c)] = pixels[i][c];
    return picture;
}

ImageF FramePath::warp_picture(int eye) const { return eye_picture(warp_download_, eye); }
ImageF FramePath::perceive_picture(int eye) const { return eye_picture(perceive_download_, eye); }

ImageF FramePath::lens_picture(int eye) const {
    if (!lens_download_.filled) return {};
    const PictureSize size = options_.panel;
    ImageF picture(int(size.width), int(size.height), 3);
    const auto values = lens_download_.buffer.as<float>().subspan(std::size_t(eye) * size.pixels() * 3, size.pixels() * 3);
    std::copy(values.begin(), values.end(), picture.data.begin());
    return picture;
}

Image8 FramePath::code_picture(const Download& download, PictureSize size, int eye) const {
    if (!download.filled) return {};
    Image8 picture(int(size.width), int(size.height), 3);
    const auto codes = download.buffer.as<std::uint32_t>().subspan(std::size_t(eye) * size.pixels(), size.pixels());
    for (std::size_t i = 0; i < codes.size(); ++i)
        for (unsigned c = 0; c < 3; ++c) picture.data[3 * i + c] = static_cast<std::uint8_t>(codes[i] >> (8 * c) & 255u);
    return picture;
}

Image8 FramePath::panel_picture(int eye) const { return code_picture(panel_download_, options_.panel, eye); }
Image8 FramePath::seen_picture(int eye) const { return code_picture(seen_download_, seen_ ? seen_->size() : options_.panel, eye); }

}  // namespace entoptic::compositor
