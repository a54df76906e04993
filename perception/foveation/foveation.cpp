#include "perception/foveation/foveation.h"

#include "shaders/geometry.glsl"

#include "perception/foveation/foveation_gate.comp.h"
#include "perception/foveation/foveation_places.comp.h"
#include "perception/foveation/foveation_reduce.comp.h"
#include "perception/foveation/foveation_restore.comp.h"
#include "perception/foveation/foveation_texels.comp.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace entoptic::perception {
namespace {

constexpr double degree = 0.017453292519943295;
constexpr double most_gaze_deg = 40;
constexpr std::uint32_t least_side = 16, most_side = 4096;

struct GatePush {
    uint first;
    gpu::Groups groups;
};

bool is_whole_sphere(std::span<const EyeGeometry> views) {
    return std::ranges::any_of(views, [](const EyeGeometry& g) { return g.kind == geometry_equirect; });
}

// Largest angle between -z and a visible pixel.
double field_deg(std::span<const EyeGeometry> views) {
    double least = 1;
    constexpr int n = 48;
    for (const EyeGeometry& g : views)
        for (int i = 0; i < (n + 1) * (n + 1); ++i) {
            const glm::dvec2 px{g.width * double(i % (n + 1)) / n, g.height * double(i / (n + 1)) / n};
            if (geometry::geometry_visible(g, px)) least = std::min(least, -geometry::geometry_direction(g, px).z);
        }
    return std::acos(std::clamp(least, -1.0, 1.0)) / degree;
}

// The smallest turn that takes -z to `gaze`, as axes: what the afterimages' retina takes, too (jacobs_math.glsl).
FoveatedView axes_of(const glm::dvec3& gaze) {
    const glm::dvec3 axis = glm::cross(glm::dvec3(0, 0, -1), gaze);
    const double cosine = -gaze.z, share = 1 / std::max(1 + cosine, 1e-9);
    const auto turned = [&](const glm::dvec3& v) { return vec3(v * cosine + glm::cross(axis, v) + axis * (glm::dot(axis, v) * share)); };
    return {turned({1, 0, 0}), turned({0, 1, 0}), vec3(-gaze)};
}

}  // namespace

const char* name_of(FoveationInverse inverse) {
    return inverse == FoveationInverse::exact ? "exact" : inverse == FoveationInverse::fitted ? "fitted" : "off";
}

float foveated_gaze_limit_deg(std::span<const EyeGeometry> views) { return static_cast<float>(std::min(field_deg(views), most_gaze_deg)); }

EyeGeometry foveated_geometry(std::span<const EyeGeometry> views, const FoveationSettings& settings) {
    double ppd = 0;
    for (const EyeGeometry& view : views) ppd = std::max(ppd, geometry::geometry_ppd(view, glm::dvec2(view.width, view.height) * 0.5));
    EyeGeometry g{};
    g.kind = geometry_foveated;
    g.edge_deg = static_cast<float>(std::min(field_deg(views) + double(foveated_gaze_limit_deg(views)), 180.0));
    g.foveal_ppd = static_cast<float>(ppd * foveal_texels_a_pixel / double(settings.reduction));
    const double radius = geometry::foveated_radius_px(g, double(g.edge_deg));
    g.width = g.height = static_cast<std::uint32_t>(std::clamp(std::ceil(2 * radius) + 2, double(least_side), double(most_side)));
    g.fitted = settings.inverse == FoveationInverse::fitted ? 1 : 0;
    return g;
}

FoveatedGaze foveated_gaze(const EyeGeometry& foveated, const vec3& gaze, float limit_deg) {
    const glm::dvec3 wanted = glm::normalize(glm::dvec3(gaze));
    const double off_axis = std::hypot(wanted.x, wanted.y), texel_deg = 1 / double(foveated.foveal_ppd);
    const double deg = std::min(std::atan2(off_axis, -wanted.z) / degree, double(limit_deg));
    const glm::dvec2 towards = off_axis > 1e-12 ? glm::dvec2(wanted) / off_axis : glm::dvec2(0);
    const glm::dvec2 centre = glm::round(towards * deg / texel_deg) * texel_deg * degree;  // rad from -z
    const double angle = glm::length(centre);
    const glm::dvec2 side = angle > 1e-12 ? centre / angle : glm::dvec2(0);
    FoveatedGaze found{axes_of({side * std::sin(angle), -std::cos(angle)})};
    const vec3 turned{glm::dot(gaze, found.axes.right), glm::dot(gaze, found.axes.up), glm::dot(gaze, found.axes.back)};
    // Beyond the limit the models keep to the middle of the disc: that is where the fovea's texels are.
    if (std::atan2(off_axis, -wanted.z) / degree <= double(limit_deg)) found.residual = glm::normalize(turned);
    return found;
}

Result<std::unique_ptr<Foveation>> Foveation::create(gpu::Device& device, const StageOptions& full) {
    std::unique_ptr<Foveation> foveation(new Foveation(device));
    ENTOPTIC_CHECK(foveation->allocate(full));
    ENTOPTIC_CHECK(foveation->create_kernels());
    ENTOPTIC_CHECK(foveation->fill_texels());
    return foveation;
}

Result<void> Foveation::allocate(const StageOptions& full) {
    settings_ = full.selection.foveation;
    geometry_ = foveated_geometry(full.views, settings_);
    gaze_limit_deg_ = foveated_gaze_limit_deg(full.views);
    whole_sphere_ = is_whole_sphere(full.views);
    push_ = {full.views[0].width, full.views[0].height, geometry_.width, 0};
    StageOptions options = full;
    options.full_views = full.views;
    options.views.assign(full.views.size(), geometry_);
    options.selection.foveation = {};
    ENTOPTIC_TRY(stage, Stage::create(device_, options));
    stage_ = std::move(stage);
    const auto buffer = [&](gpu::Buffer& into, std::size_t bytes, gpu::BufferKind kind, const char* name) -> Result<void> {
        ENTOPTIC_TRY(made, gpu::Buffer::create(device_, bytes, kind, name));
        into = std::move(made);
        return {};
    };
    const std::size_t texels = std::size_t(geometry_.width) * geometry_.height;
    ENTOPTIC_CHECK(buffer(views_, full.views.size() * sizeof(FoveatedView), gpu::BufferKind::upload, "gaze axes"));
    ENTOPTIC_CHECK(buffer(texels_, texels * sizeof(FoveatedTexel), gpu::BufferKind::device, "foveated texels"));
    ENTOPTIC_CHECK(buffer(places_, texels * full.views.size() * sizeof(vec2), gpu::BufferKind::device, "foveated places"));
    return buffer(outcome_, sizeof(FoveationGate), gpu::BufferKind::device, "foveation outcome");
}

Result<void> Foveation::create_kernels() {
    const auto make = [&](gpu::Kernel& kernel, const char* name, std::span<const std::uint32_t> code, std::size_t bindings,
                          std::size_t push) -> Result<void> {
        ENTOPTIC_TRY(
            made,
            gpu::Kernel::create(
                device_, {name, code, std::vector(bindings, gpu::BindingKind::storage_buffer), static_cast<std::uint32_t>(push), {}}));
        kernel = std::move(made);
        return {};
    };
    ENTOPTIC_CHECK(make(place_, "foveation.places", foveation_places_comp_spv, 4, sizeof(FoveationPush)));
    ENTOPTIC_CHECK(make(reduce_, "foveation.reduce", foveation_reduce_comp_spv, 7, sizeof(FoveationPush)));
    ENTOPTIC_CHECK(make(gate_, "foveation.gate", foveation_gate_comp_spv, 2, sizeof(GatePush)));
    return make(restore_, "foveation.restore", foveation_restore_comp_spv, 6, sizeof(FoveationPush));
}

Result<void> Foveation::fill_texels() {
    const auto storage = gpu::BindingKind::storage_buffer;
    ENTOPTIC_TRY(kernel, gpu::Kernel::create(device_, {"foveation.texels", foveation_texels_comp_spv, {storage, storage}, 0, {}}));
    ENTOPTIC_TRY(commands, gpu::Commands::create(device_, "foveated texels"));
    ENTOPTIC_CHECK(commands.begin());
    commands.dispatch(kernel, {stage_->geometry(), texels_}, gpu::NoPush{},
                      {gpu::groups_for(push_.side, 32), gpu::groups_for(push_.side, 8), 1});
    ENTOPTIC_CHECK(commands.submit());
    return commands.wait();
}

Result<void> Foveation::select(const Selection& selection) {
    Selection inner = selection;
    inner.foveation = {};
    return stage_->select(inner);
}

std::string Foveation::refusal(const FrameInput& input) const {
    if (whole_sphere_) return "the picture is a whole sphere";
    if (std::uint64_t(push_.side) * push_.side >= std::uint64_t(push_.width) * push_.height)
        return fmt::format("a foveated one would have {}x{} texels and be no smaller", push_.side, push_.side);
    for (const EyeInput& eye : input.eyes) {
        const float size = glm::length(eye.gaze_direction);
        if (!eye.gaze_known || !(size > 0.5f && size < 2)) return "the gaze is not known";
    }
    return stage_->refusal_of_models();
}

// The axes of this frame, and the input as the foveated image sees it.
FrameInput Foveation::look(const FrameInput& input) {
    FrameInput seen = input;
    const auto views = views_.as<FoveatedView>();
    for (std::size_t view = 0; view < input.eyes.size(); ++view) {
        const FoveatedGaze gaze = foveated_gaze(geometry_, input.eyes[view].gaze_direction, gaze_limit_deg_);
        views[view] = gaze.axes;
        seen.eyes[view].gaze_direction = gaze.residual;
    }
    return seen;
}

void Foveation::record(gpu::Commands& commands, Stage& full, const FrameInput& input, bool taking_over) {
    const FrameInput seen = look(input);
    commands.begin_stage("perceive.foveate");
    if (taking_over) stage_->take_over(commands, full);
    record_reduction(commands, full);
    commands.barrier();
    stage_->record_tiles(commands);
    // What the frame is exposed and gated by is the view's own: means of texels would hide its extremes.
    commands.copy(full.statistics_, stage_->statistics_, full.statistics_.size());
    commands.copy(full.state_, stage_->state_, full.state_.size());
    commands.barrier();
    commands.end_stage();
    stage_->record_pictures(commands, seen);
    stage_->has_depth_ = false;
    commands.begin_stage("perceive.unfoveate");
    record_return(commands, full);
    commands.barrier();
    commands.end_stage();
}

void Foveation::record_reduction(gpu::Commands& commands, const Stage& full) {
    const gpu::Groups groups{gpu::groups_for(push_.side, 32), gpu::groups_for(push_.side, 8), full.views()};
    push_.has_depth = full.has_depth_ && stage_->wants_depth() ? 1 : 0;
    commands.dispatch(place_, {full.geometry(), views_, texels_, places_}, push_, groups);
    commands.barrier();
    // A kernel needs its bindings even where it does not use them.
    const gpu::Buffer &from = push_.has_depth ? full.depth() : full.solid_angle(), &to = push_.has_depth ? stage_->depth() : places_;
    commands.dispatch(reduce_, {full.scene(), places_, texels_, stage_->scene(), stage_->solid_angle(), from, to}, push_, groups);
    if (push_.has_depth) stage_->depth_written();
}

void Foveation::record_return(gpu::Commands& commands, const Stage& full) {
    const gpu::Groups groups{gpu::groups_for(full.width(), 32), gpu::groups_for(full.height(), 8), full.views()};
    bool first = true;
    for (const gpu::Buffer* gate : stage_->gates_of_pictures()) {
        commands.dispatch(gate_, {*gate, outcome_}, GatePush{first ? 1u : 0u, groups}, {1, 1, 1});
        commands.barrier();
        first = false;
    }
    if (first) return;
    commands.dispatch_indirect(restore_, {full.geometry(), stage_->geometry(), views_, stage_->scene(), full.scene(), full.solid_angle()}, push_, outcome_, 0);
}

}  // namespace entoptic::perception
