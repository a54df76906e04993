#include "perception/scotoma/foveal_scotoma_params.h"
#include "perception/scotoma/scotoma.h"

#include "shaders/geometry.glsl"

#include "perception/scotoma/foveal_scotoma.comp.h"
#include "perception/scotoma/foveal_scotoma_gate.comp.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 1, 1, "choice: taste", "how much of the scotoma is shown; 0 switches it off"},
    {"photographic", "bool", 0, 1, 0, "choice: residual law",
     "1 shows the whole scotoma of an eye in the scene, 0 what the wearer's own eye does not have"},
    {"inner_deg", "deg", 0, 5, 0.6f, "choice: the rod-free zone is some 1.2 degrees across", "no rods within this angle from the gaze"},
    {"outer_deg", "deg", 0.1f, 10, 1.5f, "choice: smooth to where rods are many", "all rods beyond this angle"},
};
static_assert(sizeof(FovealScotomaParams) == sizeof(float) * std::size(parameters));

struct GatePush {
    FovealScotomaParams params;
    uint groups, views;
};
struct Push {
    FovealScotomaParams params;
    vec3 gaze;
    float black_cd_m2;
    uint view, left, top, width, height;
};

struct Rectangle {
    uint left = 0, top = 0, width = 0, height = 0;
};

// Pixels that may lie within `radius_deg` of the gaze; none when the gaze is not a direction or points out of the view.
Rectangle around_gaze(const EyeGeometry& g, const vec3& gaze, double radius_deg) {
    const glm::dvec3 centre(gaze);
    if (!(std::abs(glm::length(centre) - 1) < 0.01)) return {};
    if (g.kind == geometry_equirect) return {0, 0, g.width, g.height};  // its edges meet
    const glm::dvec3 across = glm::normalize(glm::cross(centre, std::abs(centre.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    const glm::dvec3 up = glm::cross(across, centre);
    glm::dvec2 low(1e9), high(-1e9);
    // A tenth wider, for what lies between the points.
    const double radius = radius_deg * 1.1 * std::numbers::pi / 180;
    for (int i = 0; i < 32; ++i) {
        const double angle = 2 * std::numbers::pi * i / 32;
        const glm::dvec2 px =
            geometry::geometry_pixel(g, centre * std::cos(radius) + (across * std::cos(angle) + up * std::sin(angle)) * std::sin(radius));
        if (!(px.x > -9e5)) continue;
        low = glm::min(low, px);
        high = glm::max(high, px);
    }
    const auto within = [](double v, uint size) { return static_cast<uint>(std::clamp(v, 0.0, static_cast<double>(size))); };
    const uint left = within(std::floor(low.x) - 1, g.width), right = within(std::ceil(high.x) + 1, g.width);
    const uint top = within(std::floor(low.y) - 1, g.height), bottom = within(std::ceil(high.y) + 1, g.height);
    return right > left && bottom > top ? Rectangle{left, top, right - left, bottom - top} : Rectangle{};
}

class FovealScotoma final : public Model {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<FovealScotoma>();
        ENTOPTIC_TRY(pass, (GatedPass::create<GatePush, Push>(context, "scotoma.foveal_scotoma", foveal_scotoma_gate_comp_spv,
                                                              foveal_scotoma_comp_spv)));
        model->pass_ = std::move(pass);
        model->views_ = context.views;
        return model;
    }
    void set_parameters(std::span<const float> v) override { std::memcpy(&params_, v.data(), sizeof params_); }
    bool is_identity() const override { return params_.strength == 0; }
    bool obeys_residual_law() const override { return params_.photographic < 0.5f; }
    Result<void> record(StageIo& io) override {
        std::vector<Rectangle> seen;
        uint most = 0;
        for (uint view = 0; view < io.views; ++view) {
            const double outer = static_cast<double>(std::max(params_.inner_deg, params_.outer_deg));
            seen.push_back(around_gaze(views_[view], io.input.eyes[view].gaze_direction, outer));
            most = std::max(most, seen.back().width * seen.back().height);
        }
        pass_.record_gate(io, GatePush{params_, std::min(gpu::groups_for(most, 256), 1024u), io.views});
        for (uint view = 0; view < io.views; ++view) {
            const Rectangle& r = seen[view];
            if (r.width == 0) continue;
            pass_.record_pass(
                io, Push{params_, io.input.eyes[view].gaze_direction, io.display.black_cd_m2, view, r.left, r.top, r.width, r.height});
        }
        return {};
    }

private:
    GatedPass pass_;
    FovealScotomaParams params_{};
    std::vector<EyeGeometry> views_;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_foveal_scotoma_reference();

extern const ModelEntry foveal_scotoma_entry;
const ModelEntry foveal_scotoma_entry{
    "scotoma",  "foveal_scotoma",       "In the dark the middle of the gaze is blind: the fovea has no rods",
    parameters, &FovealScotoma::create, &make_foveal_scotoma_reference};

}  // namespace entoptic::perception
