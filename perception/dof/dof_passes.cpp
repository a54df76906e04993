#include "perception/dof/dof_passes.h"

#include "perception/dof/dof_list.glsl"
#include "perception/gate.h"
#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

#include "perception/dof/dof_focus.comp.h"
#include "perception/dof/dof_gather.comp.h"
#include "perception/dof/dof_plan.comp.h"
#include "perception/dof/dof_resolve.comp.h"

#include <algorithm>
#include <cstring>

namespace entoptic::perception {
namespace {

struct FocusPush {
    uint views;
    float given, dt_s, tau_s;
    uint at_once, hold;
};
struct PlanPush {
    uint tiles_x, tiles_y, views, wraps, depth_known;
};
struct GatherPush {
    uint width, height, tiles_x, tiles_y, wraps;
};
struct ResolvePush {
    uint width, height, tiles_x, tiles_y;
};
struct SizePush {
    uint width, height;
};

constexpr float lid_counts_as_closed = 0.5f;
constexpr double longest_step_s = 1e6;

// The gaze, moved to the picture's edge when it points outside; straight ahead when it is no direction or points behind.
vec3 gaze_in_view(const EyeGeometry& g, const vec3& gaze) {
    const double size = glm::length(glm::dvec3(gaze));
    if (!(size > 0.5 && size < 2)) return {0, 0, -1};
    const glm::dvec2 px = geometry::geometry_pixel(g, gaze);
    if (!(px.x > -9e5)) return {0, 0, -1};
    return geometry::geometry_direction(g, glm::clamp(px, glm::dvec2(0.5), glm::dvec2(g.width, g.height) - 0.5));
}

std::size_t tile_count(const EyeGeometry& g) {
    return std::size_t(gpu::groups_for(g.width, tile_width)) * gpu::groups_for(g.height, tile_height);
}

Result<void> make(gpu::Kernel& into, gpu::Device& device, const gpu::KernelInfo& info) {
    ENTOPTIC_TRY(made, gpu::Kernel::create(device, info));
    into = std::move(made);
    return {};
}

std::vector<gpu::BindingKind> buffers(std::size_t count) { return std::vector(count, gpu::BindingKind::storage_buffer); }

constexpr std::size_t offset_of(uint dispatch) { return offsetof(Gate, dispatch) + dispatch * sizeof(GateDispatch); }

}  // namespace

Result<DofPasses> DofPasses::create(const ModelContext& context, const std::string& name, std::span<const std::uint32_t> range,
                                    std::span<const std::uint32_t> pixels, std::uint32_t params_bytes) {
    DofPasses passes;
    passes.device_ = &context.device;
    passes.views_ = context.views;
    passes.name_ = name;
    gpu::Device& device = context.device;
    const auto sized = static_cast<std::uint32_t>(params_bytes + sizeof(SizePush));
    ENTOPTIC_CHECK(make(passes.focus_kernel_, device, {name + ".focus", dof_focus_comp_spv, buffers(5), sizeof(FocusPush), {}}));
    ENTOPTIC_CHECK(make(passes.range_, device, {name + ".range", range, buffers(5), sized, {}}));
    ENTOPTIC_CHECK(make(passes.pixels_kernel_, device, {name + ".pixels", pixels, buffers(5), sized, {}}));
    ENTOPTIC_CHECK(make(passes.plan_, device, {name + ".plan", dof_plan_comp_spv, buffers(4), sizeof(PlanPush), {}}));
    ENTOPTIC_CHECK(make(passes.resolve_, device, {name + ".resolve", dof_resolve_comp_spv, buffers(4), sizeof(ResolvePush), {0}}));
    ENTOPTIC_CHECK(make(passes.resolve_smooth_, device, {name + ".resolve", dof_resolve_comp_spv, buffers(4), sizeof(ResolvePush), {1}}));
    ENTOPTIC_CHECK(passes.make_buffers());
    return passes;
}

Result<void> DofPasses::make_buffers() {
    const std::size_t tiles = tile_count(views_[0]) * views_.size();
    const std::size_t pixels = std::size_t(views_[0].width) * views_[0].height * views_.size();
    const auto buffer = [&](gpu::Buffer& into, std::size_t bytes, gpu::BufferKind kind, const char* what) -> Result<void> {
        ENTOPTIC_TRY(made, gpu::Buffer::create(*device_, bytes, kind, name_ + " " + what));
        into = std::move(made);
        return {};
    };
    ENTOPTIC_CHECK(buffer(eyes_, views_.size() * sizeof(DofEye), gpu::BufferKind::upload, "eyes"));
    ENTOPTIC_CHECK(buffer(focus_, sizeof(DofFocus), gpu::BufferKind::upload, "focus"));
    ENTOPTIC_CHECK(buffer(tile_radius_, tiles * sizeof(float), gpu::BufferKind::device, "tile radii"));
    ENTOPTIC_CHECK(buffer(reach_, tiles * sizeof(float), gpu::BufferKind::device, "reach"));
    ENTOPTIC_CHECK(buffer(list_, (tiles + 1) * sizeof(uint), gpu::BufferKind::device, "tiles"));
    ENTOPTIC_CHECK(buffer(pixels_, pixels * sizeof(DofPixel), gpu::BufferKind::device, "pixels"));
    ENTOPTIC_CHECK(buffer(blurred_, pixels * sizeof(vec4), gpu::BufferKind::device, "blurred"));
    focus_.as<DofFocus>()[0] = {unknown_dioptre, unknown_dioptre};
    return {};
}

Result<const gpu::Kernel*> DofPasses::gathering(const DofSettings& settings) {
    for (const Gathering& made : gatherings_)
        if (made.colours == settings.colours && made.roulette == settings.roulette) return &made.gather;
    Gathering next{{}, settings.colours, settings.roulette};
    ENTOPTIC_CHECK(
        make(next.gather, *device_,
             {name_ + ".gather", dof_gather_comp_spv, buffers(5), sizeof(GatherPush), {settings.colours, settings.roulette ? 1u : 0u}}));
    gatherings_.push_back(std::move(next));
    return &gatherings_.back().gather;
}

// The GPU has finished with the frame before: stages are recorded one at a time and waited for.
void DofPasses::write_eyes(const FrameInput& input) {
    const auto eyes = eyes_.as<DofEye>();
    for (std::size_t v = 0; v < views_.size(); ++v)
        eyes[v] = {gaze_in_view(views_[v], input.eyes[v].gaze_direction), input.eyes[v].pupil_diameter_mm};
}

void DofPasses::record_focus(StageIo& io, const DofSettings& settings) {
    const bool vergence = settings.use_vergence && io.input.vergence_dioptre >= 0;
    const bool fixed = settings.focus_dioptre >= 0;
    const float given = fixed ? settings.focus_dioptre : vergence ? std::min(io.input.vergence_dioptre, max_dioptre) : unknown_dioptre;
    const auto closed = [](const EyeInput& eye) { return !(eye.eyelid_open >= lid_counts_as_closed); };
    const FocusPush push{io.views,
                         given,
                         io.input.dt_s > 0 ? static_cast<float>(std::min(io.input.dt_s, longest_step_s)) : 0.0f,
                         settings.focus_tau_s,
                         io.input.snap || fixed ? 1u : 0u,
                         std::ranges::all_of(io.input.eyes, closed) ? 1u : 0u};
    io.commands.dispatch(focus_kernel_, {*io.dioptre, io.solid_angle, io.geometry, eyes_, focus_}, push, {1, 1, 1});
}

Result<void> DofPasses::record(StageIo& io, const DofSettings& settings, std::span<const std::byte> params) {
    ENTOPTIC_TRY(gather, gathering(settings));
    std::vector<std::byte> sized(params.begin(), params.end());
    const SizePush size{io.width, io.height};
    sized.insert(sized.end(), std::as_bytes(std::span(&size, 1)).begin(), std::as_bytes(std::span(&size, 1)).end());
    if (io.dioptre) {
        write_eyes(io.input);
        record_focus(io, settings);
        io.commands.barrier();
        const gpu::Binding bindings[] = {*io.dioptre, io.solid_angle, eyes_, focus_, tile_radius_};
        io.commands.dispatch(range_, bindings, sized, {gpu::groups_for(io.tiles_x * io.tiles_y, 64), 1, io.views});
        io.commands.barrier();
    }
    const uint wraps = views_[0].kind == geometry_equirect ? 1u : 0u;
    io.commands.dispatch(plan_, {tile_radius_, list_, reach_, io.gate},
                         PlanPush{io.tiles_x, io.tiles_y, io.views, wraps, io.dioptre ? 1u : 0u}, {1, 1, 1});
    if (!io.dioptre) return {};
    io.commands.barrier();
    const gpu::Binding bindings[] = {*io.dioptre, io.solid_angle, eyes_, focus_, pixels_};
    io.commands.dispatch_indirect(pixels_kernel_, bindings, sized, io.gate, offset_of(dof_dispatch_pixels));
    io.commands.barrier();
    io.commands.dispatch_indirect(*gather, {io.scene, pixels_, list_, reach_, blurred_},
                                  GatherPush{io.width, io.height, io.tiles_x, io.tiles_y, wraps}, io.gate, offset_of(dof_dispatch_tiles));
    io.commands.barrier();
    io.commands.dispatch_indirect(settings.roulette ? resolve_smooth_ : resolve_, {io.scene, pixels_, list_, blurred_},
                                  ResolvePush{io.width, io.height, io.tiles_x, io.tiles_y}, io.gate, offset_of(dof_dispatch_tiles));
    return {};
}

}  // namespace entoptic::perception
