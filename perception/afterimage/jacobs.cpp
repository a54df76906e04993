#include "perception/afterimage/afterimage.h"
#include "perception/afterimage/jacobs_gpu.h"
#include "perception/afterimage/jacobs_math.glsl"
#include "shaders/geometry.glsl"

#include "perception/afterimage/jacobs_apply.comp.h"
#include "perception/afterimage/jacobs_gate.comp.h"
#include "perception/afterimage/jacobs_mark.comp.h"
#include "perception/afterimage/jacobs_observe.comp.h"
#include "perception/afterimage/jacobs_plan.comp.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace entoptic::perception {
namespace {

constexpr const char* appendix = "Jacobs 2015, appendix A";
constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "how much of the afterimages is shown; 0 switches them off"},
    {"photographic", "bool", 0, 1, 0, "choice: residual law; 1 is Jacobs 2015", "1: by the whole scene; 0: by the light that the panel cannot show"},
    {"j1", "1", 0, 0.2f, 0.03f, appendix, "strength of bleaching afterimages, share of the display's range"},
    {"j2", "1", 0, 1, 0.15f, appendix, "exponent of adaptation afterimages"},
    {"b1_l", "m²/(cd s)", 0, 0.1f, 1.2e-3f, appendix, "bleaching rate of L cones"},
    {"b1_m", "m²/(cd s)", 0, 0.1f, 1.4e-4f, appendix, "bleaching rate of M cones"},
    {"b1_s", "m²/(cd s)", 0, 0.1f, 5.5e-7f, appendix, "bleaching rate of S cones"},
    {"b2_l", "1/s", 1e-3f, 100, 0.69f, appendix, "regeneration rate of L cones"},
    {"b2_m", "1/s", 1e-3f, 100, 1.4f, appendix, "regeneration rate of M cones"},
    {"b2_s", "1/s", 1e-3f, 100, 5.5f, appendix, "regeneration rate of S cones"},
    {"c2", "1/s", 0, 100, 1, appendix, "calcium efflux; the influx c1 cancels"},
    {"alpha_floor", "1", 1e-4f, 1, 0.02f, "choice: equation 11 divides by 0 in the dark (trap J15)", "floor of the local adaptation, share of C_max"},
    {"diffusion_deg", "deg", 0, 1, 0.05f, "choice: Jacobs 2015, section 2.4 gives no width (trap J16)", "rms blur of the retina's states after 1 s"},
    {"fovea_sigma_deg", "deg", 1, 60, 15, "choice: Jacobs 2015, section 2.4 gives no width (trap J17)", "fall-off from the gaze of what is shown"},
    {"resolution", "1", 0.125f, 1, 0.5f, "choice: a quarter can be seen at edges (entoptic bench)", "resolution of the retina's map over the picture's"},
    {"lid_red", "1", 0, 1, 0.056f, "Ando and Kripke 1996", "red light that the closed eyelid lets through"},
    {"lid_green_blue", "1", 0, 1, 0.003f, "Ando and Kripke 1996", "green and blue light that the closed eyelid lets through"},
};
static_assert(sizeof(JacobsParams) == sizeof(float) * std::size(parameters));

struct PlanPush {
    uint groups_x, groups_y, views, always;
    float white_cd_m2;
};
struct GatePush {
    uint tiles_x, tiles_y, snap;
    float dt_s;
};

constexpr double degree = 0.017453292519943295;
// A finer map than this is not kept: 2 x 1024² cells with their states and what is seen of them are 150 MB.
constexpr uint most_cells_across = 1024;

// Largest angle between two directions at the rim of a view, at most 110 degrees; radians.
double extent_of(const EyeGeometry& g) {
    if (g.kind == geometry_equirect) return 110 * degree;
    const auto rim = [&](int i) {
        const double part = (i % 4) / 4.0, w = g.width, h = g.height;
        const glm::dvec2 sides[] = {{part * w, 0}, {w, part * h}, {(1 - part) * w, h}, {0, (1 - part) * h}};
        return geometry::geometry_direction(g, sides[i / 4]);
    };
    double least = 1;
    for (int i = 0; i < 16; ++i)
        for (int j = 0; j < i; ++j) least = std::min(least, glm::dot(rim(i), rim(j)));
    return std::min(std::acos(std::max(least, -1.0)), 110 * degree);
}

// The map for this picture: as far as afterimages are shown, or as the picture reaches from a gaze at its rim.
RetinaMap map_for(const std::vector<EyeGeometry>& views, const JacobsParams& p) {
    double extent = 0, ppd = 0;
    for (const EyeGeometry& g : views) {
        extent = std::max(extent, extent_of(g));
        ppd = std::max(ppd, geometry::geometry_ppd(g, glm::dvec2(g.width, g.height) * 0.5));
    }
    const double reach_angle = std::min(extent, static_cast<double>(jacobs::fall_off_reach * p.fovea_sigma_deg) * degree);
    const double reach = 2 * std::sin(0.5 * reach_angle);
    const double wanted = std::max(degree / (ppd * static_cast<double>(p.resolution)), 1e-5);
    const double across = std::clamp(std::ceil(2 * reach / wanted) + 2, 4.0, static_cast<double>(most_cells_across));
    const double cell = std::max(wanted, 2 * reach / (across - 2));
    return {static_cast<uint>(across), static_cast<float>(cell), static_cast<float>(reach)};
}

// Straight ahead where the gaze is not a direction.
vec3 gaze_of(const EyeInput& eye) {
    const float size = glm::length(eye.gaze_direction);
    return size > 0.5f && size < 2 ? eye.gaze_direction / size : vec3(0, 0, -1);
}

constexpr std::size_t offset_of(uint dispatch) { return offsetof(Gate, dispatch) + dispatch * sizeof(GateDispatch); }

class Jacobs final : public Model, public ObservesRetina {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<Jacobs>();
        model->device_ = &context.device;
        model->views_ = context.full_views.empty() ? context.views : context.full_views;
        ENTOPTIC_CHECK(model->make_kernels());
        ENTOPTIC_TRY(status, gpu::Buffer::create(context.device, sizeof(RetinaStatus), gpu::BufferKind::device, "retina status"));
        model->status_ = std::move(status);
        const EyeGeometry& g = context.views[0];
        const std::size_t tiles = std::size_t(gpu::groups_for(g.width, tile_width)) * gpu::groups_for(g.height, tile_height);
        ENTOPTIC_TRY(flags, gpu::Buffer::create(context.device, tiles * context.views.size() * sizeof(uint), gpu::BufferKind::device,
                                                "afterimage tiles"));
        model->flags_ = std::move(flags);
        return model;
    }
    void set_parameters(std::span<const float> values) override { std::memcpy(&params_, values.data(), sizeof(params_)); }
    bool is_identity() const override { return params_.strength == 0; }
    bool obeys_residual_law() const override { return params_.photographic <= 0.5f; }

    // The retina's map is made for the view, whatever image of it the model works on.
    void take_over(gpu::Commands& commands, Model& model) override {
        const auto& from = static_cast<Jacobs&>(model);
        if (!from.seen_ || !fit_map(commands)) return;
        commands.copy(from.states_[from.front_], states_[front_], states_[front_].size());
        commands.copy(from.status_, status_, status_.size());
        fresh_ = from.fresh_;
    }
    Result<void> observe(StageIo& io) override {
        ENTOPTIC_CHECK(fit_map(io.commands));
        const float dt_s = io.input.dt_s > 0 ? static_cast<float>(std::min(io.input.dt_s, 1e6)) : 0.0f;
        const uint begin = io.input.snap ? begin_steady : fresh_ ? begin_adapted : begin_stored;
        const uint samples = std::clamp(static_cast<uint>(std::lround(1 / params_.resolution)), 1u, most_samples);
        const PlanPush plan{gpu::groups_for(map_.size, observe_width), gpu::groups_for(map_.size, observe_height), io.views,
                            begin != begin_stored || params_.photographic > 0.5f ? 1u : 0u, io.display.white_cd_m2};
        io.commands.dispatch(plan_, {io.statistics, io.state, status_, io.gate}, plan, {1, 1, 1});
        io.commands.barrier();
        const gpu::Buffer &before = states_[front_], &after = states_[1 - front_];
        for (uint view = 0; view < io.views; ++view) {
            const EyeInput& eye = io.input.eyes[view];
            const ObservePush push{params_, map_, gaze_of(eye), dt_s, view, begin, samples, eye.eyelid_open, io.display.white_cd_m2};
            io.commands.dispatch_indirect(observe_, {io.scene, io.geometry, io.state, before, after, seen_, status_}, push, io.gate,
                                          offset_of(dispatch_observe));
        }
        io.commands.barrier();
        io.commands.dispatch(gate_, {status_, io.gate}, GatePush{io.tiles_x, io.tiles_y, io.input.snap ? 1u : 0u, dt_s}, {1, 1, 1});
        front_ = 1 - front_;
        fresh_ = false;
        return {};
    }
    Result<void> record(StageIo& io) override {
        for (uint view = 0; view < io.views; ++view)
            io.commands.dispatch_indirect(mark_, {io.geometry, seen_, flags_},
                                          MarkPush{map_, gaze_of(io.input.eyes[view]), view, io.tiles_x, io.tiles_y}, io.gate,
                                          offset_of(dispatch_mark));
        io.commands.barrier();
        for (uint view = 0; view < io.views; ++view)
            io.commands.dispatch_indirect(apply_, {io.scene, io.geometry, seen_, flags_},
                                          ApplyPush{map_, gaze_of(io.input.eyes[view]), view, io.tiles_x, io.tiles_y,
                                                    io.display.white_cd_m2, io.display.black_cd_m2},
                                          io.gate, offset_of(dispatch_apply));
        return {};
    }

private:
    Result<void> make_kernels() {
        const auto make = [&](gpu::Kernel& kernel, const char* name, std::span<const std::uint32_t> code, std::size_t bindings,
                              std::size_t push) -> Result<void> {
            ENTOPTIC_TRY(made, gpu::Kernel::create(*device_, {name, code, std::vector(bindings, gpu::BindingKind::storage_buffer),
                                                              static_cast<std::uint32_t>(push), {}}));
            kernel = std::move(made);
            return {};
        };
        ENTOPTIC_CHECK(make(plan_, "afterimage.jacobs.plan", jacobs_plan_comp_spv, 4, sizeof(PlanPush)));
        ENTOPTIC_CHECK(make(observe_, "afterimage.jacobs.observe", jacobs_observe_comp_spv, 7, sizeof(ObservePush)));
        ENTOPTIC_CHECK(make(gate_, "afterimage.jacobs.gate", jacobs_gate_comp_spv, 2, sizeof(GatePush)));
        ENTOPTIC_CHECK(make(mark_, "afterimage.jacobs.mark", jacobs_mark_comp_spv, 3, sizeof(MarkPush)));
        return make(apply_, "afterimage.jacobs", jacobs_apply_comp_spv, 4, sizeof(ApplyPush));
    }
    // Buffers of the size that the parameters ask for. A new map starts fresh.
    Result<void> fit_map(gpu::Commands& commands) {
        const RetinaMap wanted = map_for(views_, params_);
        if (seen_ && wanted.size == map_.size && wanted.cell_rad == map_.cell_rad && wanted.reach == map_.reach) return {};
        const std::size_t cells = std::size_t(wanted.size) * wanted.size * views_.size();
        const auto make = [&](gpu::Buffer& buffer, const char* name) -> Result<void> {
            ENTOPTIC_TRY(made, gpu::Buffer::create(*device_, cells * 6 * sizeof(float), gpu::BufferKind::device, name));
            buffer = std::move(made);
            return {};
        };
        for (gpu::Buffer& states : states_) ENTOPTIC_CHECK(make(states, "retina states"));
        ENTOPTIC_CHECK(make(seen_, "afterimage"));
        commands.fill(status_, 0);
        commands.barrier();
        map_ = wanted;
        fresh_ = true;
        return {};
    }

    gpu::Device* device_ = nullptr;
    std::vector<EyeGeometry> views_;
    gpu::Kernel plan_, observe_, gate_, mark_, apply_;
    gpu::Buffer states_[2];   // Cell a cell, views: of the frame before, and of this one
    gpu::Buffer seen_;        // Afterimage a cell, views
    gpu::Buffer status_;      // RetinaStatus
    gpu::Buffer flags_;       // a tile, views: 1 where anything is seen
    std::size_t front_ = 0;
    bool fresh_ = true;
    RetinaMap map_{};
    JacobsParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_jacobs_reference();

extern const ModelEntry jacobs_entry;
const ModelEntry jacobs_entry{"afterimage", "jacobs",        "Afterimages by bleached pigment and by local adaptation (Jacobs 2015)",
                              parameters,   &Jacobs::create, &make_jacobs_reference};

}  // namespace entoptic::perception
