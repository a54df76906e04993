// luidolt_spectral on the GPU: the kernel, for the engine in glare_engine.h. What is done when:
//   parameters change      spectrum, halo table and particles on the CPU; transforms of the pupil's patches
//   pupil crosses a step   a kernel for that diameter: sum of the patches, halo times its structure, aperture
#include "perception/glare/glare_engine.h"
#include "perception/glare/glare_math.glsl"
#include "perception/glare/luidolt_spectral_pupil.h"

#include "perception/glare/luidolt_spectral_kernel.comp.h"
#include "perception/glare/luidolt_spectral_particles.comp.h"
#include "perception/glare/luidolt_spectral_pupil_sum.comp.h"
#include "perception/glare/luidolt_spectral_structure.comp.h"

#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 10, 1, "choice: 1 is the eye that the other parameters describe", "times the scattered light; at most 0.9 of all light is scattered"},
    {"particle_diameter_um", "um", 1, 20, 6, "Luidolt 2020, figure 4", "diameter of the particles in cornea and lens"},
    {"particles_per_mm2", "1/mm2", 0, 1e5f, 79.577f, "Luidolt 2020, figure 4: 1000 in a pupil of 4 mm", "particles per area of the pupil; they stay where they are when the pupil moves"},
    {"wavelengths", "1", 3, 32, 8, "choice: midpoints of 400..700 nm (trap L9)", "samples of the spectrum in the halo's texture; its mean has 96"},
    {"diffraction", "1", 0, 1, 1, "Luidolt 2020, eq. 5", "share of the light that the edge of the pupil diffracts; 0 with no particles: no glare at all"},
    {"patches", "1", 0, 256, 64, "choice: error and time in the ledger (Welch 1967)", "patches of the pupil whose particles give the halo its texture; 0: smooth"},
    {"texel_px", "px", 1, 16, 4, "choice: 4 has p99 dE_ITP 0.3", "least width of a texel of the grid on which wide glare is computed"},
    {"near_px", "px", 0, 16, 12, "choice: where the grid shows (docs/speed_against_error.md)", "radius of the near field, done at full resolution"},
    {"near_from", "1", 0, 1e6f, 32, "choice: dimmer light the panel shows as it is, and the wearer's own eye scatters it", "light above this many times the adaptation luminance has a near field; 0: all light"},
    {"rebuild_mm", "mm", 0.02f, 1, 0.2f, "choice: linear between diameters, so that twice 0.1 mm is as good", "distance of the pupil diameters at which the kernel is built"},
    {"angle_scale", "1", 1, 17.5f, 1, "trap L10: 17.5 is the paper's texel for pixel", "enlarges the kernel"},
    {"radius_deg", "deg", 2, 180, 180, "trap L13: the veil counts out to the edge", "the kernel ends here"},
    {"window_sigma_deg", "deg", 0, 90, 0, "Luidolt 2020, section 4.2.3; trap L13", "Gaussian window around the gaze; 0: whole field"},
    {"as_printed", "bool", 0, 1, 0, "Luidolt 2020, eq. 9 and 10", "1: colour cast, 380..770 nm, 1000 particles in any pupil, all light has a near field, window of 10 degrees"},
};
static_assert(sizeof(LuidoltSpectralParams) == sizeof(float) * std::size(parameters));

class LuidoltSpectral final : public GlareModel {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<LuidoltSpectral>(context);
        ENTOPTIC_CHECK(model->make_kernels());
        const Wanted wanted[] = {
            {&model->particles_kernel_, "glare.particles", luidolt_spectral_particles_comp_spv, 4, sizeof(StructurePush), {}},
            {&model->structure_kernel_, "glare.structure", luidolt_spectral_structure_comp_spv, 3, sizeof(StructurePush), {}},
            {&model->pupil_sum_, "glare.pupil_sum", luidolt_spectral_pupil_sum_comp_spv, 3, sizeof(StructurePush), {}},
            {&model->textured_kernel_, "glare.textured_kernel", luidolt_spectral_kernel_comp_spv, 4, sizeof(TexturedKernelPush), {}},
        };
        for (const Wanted& w : wanted) ENTOPTIC_CHECK(model->make_kernel(w));
        return model;
    }
    explicit LuidoltSpectral(const ModelContext& context) : GlareModel(context) {}

    void set_parameters(std::span<const float> values) override {
        std::memcpy(&params_, values.data(), sizeof params_);
        parameters_changed();
    }
    bool is_identity() const override {
        return params_.strength <= 0 || (params_.particles_per_mm2 <= 0 && params_.diffraction <= 0 && params_.as_printed <= 0.5f);
    }

private:
    GlareSetup setup() override;
    glm::dvec3 weights(uint kernel, double pupil_mm) const override;
    Result<void> prepare_far() override;
    void record_first(StageIo& io) override;
    bool record_far_kernel(StageIo& io, uint kernel, long steps) override;
    RadialProfile smooth_profile() const;
    double safe(double pupil_mm) const { return safe_strength(params_, spectrum_, pupil_mm, smallest_step()); }

    LuidoltSpectralParams params_{};
    SpectralTable spectrum_{};
    ParticleField particles_;
    gpu::Kernel particles_kernel_, structure_kernel_, pupil_sum_, textured_kernel_;
    StaticBuffer spectrum_table_, cell_offsets_, particle_list_, particle_mean_, radii_;
    gpu::Buffer structure_, pupil_structure_;
};

// Without the texture: halo of the particles, and the pupil's tail for a pupil of 1 mm. The saturated rings of the halo lie outside the gamut: only
// the sum of both is light (trap L9).
RadialProfile LuidoltSpectral::smooth_profile() const {
    const std::vector<vec3> halo = make_halo_table(params_);
    const double scale = static_cast<double>(params_.angle_scale), radius = static_cast<double>(params_.radius_deg) * degree;
    return make_profile([&](double theta) {
        const double sine = std::sin(std::min(theta / scale, 90 * degree)), place = sine * (halo_table_size - 1);
        const auto i = std::min<std::size_t>(static_cast<std::size_t>(place), halo_table_size - 2);
        const glm::dvec3 scattered = glm::mix(glm::dvec3(halo[i]), glm::dvec3(halo[i + 1]), place - static_cast<double>(i));
        const double share = glare::radius_share(theta, radius) / (scale * scale);
        return RadialEntry{{scattered * share, glm::dvec3(spectrum_.mean_lambda_um) * (glare::aperture_tail(1000, 1, sine) * share), {}}};
    });
}

GlareSetup LuidoltSpectral::setup() {
    spectrum_ = make_spectrum(params_);
    particles_ = make_particles(params_, context_.seed);
    const bool printed = params_.as_printed > 0.5f;
    GlareSetup setup;
    setup.kernels = {smooth_profile()};
    setup.terms = {{source_scene, 0}};
    setup.smooth = particles_.pairs == 0;
    setup.texel_px = params_.texel_px;
    setup.near_px = params_.near_px;
    setup.near_from = printed ? 0 : params_.near_from;
    setup.rebuild_mm = params_.rebuild_mm;
    // The paper states no width of its window; 10 degrees is a choice.
    setup.window_sigma_deg = printed && params_.window_sigma_deg <= 0 ? 10.0f : params_.window_sigma_deg;
    if (printed) setup.gain = spectrum_.gain;
    return setup;
}

glm::dvec3 LuidoltSpectral::weights(uint, double pupil_mm) const {
    const double f = covered_share(params_, pupil_mm);
    return safe(pupil_mm) * glm::dvec3(f, (1 - f) * static_cast<double>(params_.diffraction) / pupil_mm, 0);
}

Result<void> LuidoltSpectral::prepare_far() {
    ENTOPTIC_CHECK(make_static(spectrum_table_, std::vector<SpectralTable>{spectrum_}, "glare.spectrum"));
    ENTOPTIC_CHECK(make_static(cell_offsets_, particles_.cell_offsets, "glare.cells"));
    ENTOPTIC_CHECK(make_static(particle_list_, particles_.particles, "glare.particles"));
    ENTOPTIC_CHECK(make_static(particle_mean_, particles_.mean, "glare.particle_mean"));
    ENTOPTIC_CHECK(make_static(radii_, particles_.radius_mm, "glare.radii"));
    constexpr std::size_t plane = structure_n * structure_n * sizeof(float);
    ENTOPTIC_CHECK(make_buffer(structure_, std::max<std::size_t>(particles_.pairs, 1) * plane, "glare.structure"));
    return make_buffer(pupil_structure_, plane, "glare.pupil_structure");
}

// Transforms of the pupil's patches.
void LuidoltSpectral::record_first(StageIo& io) {
    gpu::Commands& c = io.commands;
    for (const StaticBuffer* s : {&spectrum_table_, &cell_offsets_, &particle_list_, &particle_mean_, &radii_}) s->record_copy(c);
    for (uint first = 0; first < particles_.pairs; first += work_planes()) {
        const uint count = std::min(work_planes(), particles_.pairs - first);
        const StructurePush push{first, count, 0};
        c.barrier();
        c.dispatch(particles_kernel_, {cell_offsets_.buffer, particle_list_.buffer, particle_mean_.buffer, work()}, push, {glare_n / 32, glare_n / 8, count});
        c.barrier();
        record_transform(c, count);
        c.barrier();
        c.dispatch(structure_kernel_, {work(), particle_mean_.buffer, structure_}, push, {structure_n / 32, structure_n / 8, count});
    }
}

bool LuidoltSpectral::record_far_kernel(StageIo& io, uint kernel, long steps) {
    const double pupil_mm = diameter_mm(steps);
    gpu::Commands& c = io.commands;
    if (particles_.pairs > 0) {
        const StructurePush push{0, particles_.pairs, static_cast<float>(pupil_mm / 2)};
        c.dispatch(pupil_sum_, {structure_, radii_.buffer, pupil_structure_}, push, {structure_n * structure_n / 256, 1, 1});
        c.barrier();
    }
    const float scale = params_.angle_scale;
    const glm::dvec3 smooth = safe_weights(kernel, pupil_mm);
    const TexturedKernelPush push{static_cast<float>(pitch()), near_rad(kernel), params_.radius_deg * static_cast<float>(degree), params_.particle_diameter_um,
                                  static_cast<float>(smooth.x) / (scale * scale), scale, static_cast<float>(glare_patch_um), particles_.pairs > 0 ? 1u : 0u,
                                  far_profile(kernel), vec3(smooth)};
    c.dispatch(textured_kernel_, {spectrum_table_.buffer, profiles(), pupil_structure_, work()}, push, kernel_groups());
    return true;
}

}  // namespace

std::unique_ptr<ReferenceModel> make_luidolt_spectral_reference();

extern const ModelEntry luidolt_spectral_entry;
const ModelEntry luidolt_spectral_entry{"glare",    "luidolt_spectral", "Particles and pupil as wave optics sees them, spectral (Luidolt 2020)",
                                        parameters, &LuidoltSpectral::create, &make_luidolt_spectral_reference};

}  // namespace entoptic::perception
