// cie135 on the GPU: the kernel, for the engine in glare_engine.h.
#include "perception/glare/cie135_math.glsl"
#include "perception/glare/cie135_params.h"
#include "perception/glare/glare_engine.h"
#include "perception/glare/glare_math.glsl"

#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 10, 1, "choice: 1 is the eye that the other parameters describe", "times the scattered light; at most 0.9 of all light is scattered"},
    {"age", "years", 10, 90, 30, "CIE 135/1-1999, eq. 8", "age of the eye"},
    {"pigment", "1", 0, 1.2f, 0.5f, "CIE 135/1-1999, eq. 8", "of the iris: 0 very dark, 0.5 brown, 1 green, 1.2 light blue"},
    {"angle_scale", "1", 1, 17.5f, 1, "choice: for pictures", "enlarges the kernel"},
    {"texel_px", "px", 1, 16, 4, "choice: error in the ledger", "least width of a texel of the grid on which wide glare is computed"},
    {"near_px", "px", 0, 16, 15, "choice: the least whose seam with the grid cannot be seen (docs/speed_against_error.md)", "radius of the near field, done at full resolution"},
    {"near_from", "1", 0, 1e6f, 16, "choice: dimmer light has hardly a halo of its own", "photographic: light above this many times the adaptation luminance has a near field; 0: all light"},
    {"rescatter", "1", 0, 1, 1, "choice: 1 is the law that the wearer's own eye is not simulated", "share of the wearer's own scatter of the drawn halo that is taken away"},
    {"photographic", "bool", 0, 1, 0, "choice", "1: the whole scene is scattered; 0: only what the panel cannot send"},
};
static_assert(sizeof(Cie135Params) == sizeof(float) * std::size(parameters));

class Cie135 final : public GlareModel {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<Cie135>(context);
        ENTOPTIC_CHECK(model->make_kernels());
        return model;
    }
    explicit Cie135(const ModelContext& context) : GlareModel(context) {}

    void set_parameters(std::span<const float> values) override {
        std::memcpy(&params_, values.data(), sizeof params_);
        parameters_changed();
    }
    bool is_identity() const override { return params_.strength <= 0; }
    bool obeys_residual_law() const override { return params_.photographic <= 0.5f; }

private:
    GlareSetup setup() override;
    glm::dvec3 weights(uint, double) const override { return {static_cast<double>(params_.strength), 0, 0}; }
    RadialProfile profile() const;

    Cie135Params params_{};
};

// The PSF over its own integral from 0 to 90 degrees, which is 1.005 to 1.20 (CIE 135/1 does not make it 1); it fades out to 100 degrees.
RadialProfile Cie135::profile() const {
    const double age = static_cast<double>(params_.age), pigment = static_cast<double>(params_.pigment), scale = static_cast<double>(params_.angle_scale);
    double total = 0;
    constexpr int steps = 20000;      // even in log(theta) from 1e-6 degrees
    for (int i = 0; i < steps; ++i) {
        const double deg = 1e-6 * std::pow(90e6, (i + 0.5) / steps), width = deg * degree * std::log(90e6) / steps;
        total += cie135::total_psf(deg, age, pigment) * 2 * 180 * degree * std::sin(deg * degree) * width;
    }
    return make_profile([&](double theta) {
        const double deg = theta / (degree * scale), end = glare::radius_share(deg, 100);
        return RadialEntry{{glm::dvec3(cie135::total_psf(deg, age, pigment) * end / (total * scale * scale)), {}, {}}};
    });
}

GlareSetup Cie135::setup() {
    GlareSetup setup;
    const RadialProfile kernel = profile();
    // A kernel of its own for the wearer's re-scatter, which has no near field.
    setup.kernels = {kernel, kernel};
    setup.terms = observer_terms(params_.photographic > 0.5f, params_.rescatter, 1, std::nullopt);
    setup.texel_px = params_.texel_px;
    setup.near_px = params_.near_px;
    setup.near_from = params_.near_from;
    setup.rebuild_mm = 0;
    return setup;
}

}  // namespace

std::unique_ptr<ReferenceModel> make_cie135_reference();

extern const ModelEntry cie135_entry;
const ModelEntry cie135_entry{"glare",    "cie135", "The CIE's total point spread of the eye, by age and pigment (CIE 135/1-1999)",
                              parameters, &Cie135::create, &make_cie135_reference};

}  // namespace entoptic::perception
