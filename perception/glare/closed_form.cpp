// closed_form on the GPU: the kernel, for the engine in glare_engine.h. Parts of its profile: straylight and particle halo, which the pupil
// does not change; the pupil's own diffraction, at 1 mm; the ring of the lens fibres, of energy 1.
#include "perception/glare/closed_form_math.glsl"
#include "perception/glare/closed_form_params.h"
#include "perception/glare/glare_engine.h"
#include "perception/glare/glare_math.glsl"
#include "perception/glare/glare_spectrum.h"

#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180;
// The pupil at which straylight makes room for the pupil's diffraction; it takes part in 1/1000 of the sum.
constexpr double partition_pupil_mm = 4;

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 10, 1, "choice: 1 is the eye that the other parameters describe", "times the scattered light; at most 0.9 of all light is scattered"},
    {"age", "years", 10, 90, 30, "CIE 146-2002", "age of the simulated person"},
    {"pigment", "1", 0, 1.2f, 0.5f, "CIE 146-2002", "of the person's iris: 0 very dark, 0.5 brown, 1 green, 1.2 light blue"},
    {"straylight_factor", "1", 0.1f, 30, 1, "van den Berg 2007: 1.4 to 2 for an early cataract", "the person's straylight over the norm of the age"},
    {"particle_diameter_um", "um", 1, 20, 6, "Luidolt 2020, figure 4", "diameter of the particles in cornea and lens"},
    {"particles_per_mm2", "1/mm2", 0, 1e5f, 79.577f, "Luidolt 2020, figure 4: 1000 in a pupil of 4 mm", "particles per area of the pupil"},
    {"diffraction", "1", 0, 1, 1, "Luidolt 2020, eq. 5", "share of the light that the edge of the pupil diffracts"},
    {"lenticular_halo", "1", 0, 3, 0, "Spencer 1995, f3; choice: off, few people see it", "times the ring that the fibres of the lens make"},
    {"straylight_colour", "1", 0, 1, 1, "Coppens 2006", "1: straylight bluish by (575 nm/wavelength)^4, less in light eyes; 0: white"},
    {"emission_spectra", "bool", 0, 1, 0, "choice: three times the work; error without it in the ledger", "1: coloured light scatters by its own spectrum; residual form only"},
    {"angle_scale", "1", 1, 17.5f, 1, "choice: for pictures", "enlarges the kernel"},
    {"texel_px", "px", 1, 16, 4, "choice: error in the ledger", "least width of a texel of the grid on which wide glare is computed"},
    {"near_px", "px", 0, 16, 15, "choice: the least whose seam with the grid cannot be seen (docs/speed_against_error.md)", "radius of the near field, done at full resolution"},
    {"near_from", "1", 0, 1e6f, 16, "choice: dimmer light has hardly a halo of its own", "photographic: light above this many times the adaptation luminance has a near field; 0: all light"},
    {"rebuild_mm", "mm", 0.02f, 1, 0.2f, "choice: linear between diameters, error in luidolt_spectral's ledger", "distance of the pupil diameters at which the kernel is built"},
    {"wearer_age", "years", 0, 90, 0, "choice", "age of who wears the headset; 0: as the person"},
    {"wearer_pigment", "1", -1, 1.2f, -1, "choice", "pigment of who wears the headset; -1: as the person"},
    {"wearer_straylight_factor", "1", 0, 30, 0, "choice", "straylight factor of who wears the headset; 0: as the person"},
    {"rescatter", "1", 0, 1, 1, "choice: 1 is the law that the wearer's own eye is not simulated", "share of the wearer's own scatter of the drawn halo that is taken away"},
    {"photographic", "bool", 0, 1, 0, "choice", "1: the whole scene is scattered; 0: only what the wearer's eye at the panel does not scatter itself"},
};
static_assert(sizeof(ClosedFormParams) == sizeof(float) * std::size(parameters));

struct Eye {
    double age, pigment, factor;
    bool operator==(const Eye&) const = default;
};

class ClosedForm final : public GlareModel {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<ClosedForm>(context);
        ENTOPTIC_CHECK(model->make_kernels());
        return model;
    }
    explicit ClosedForm(const ModelContext& context) : GlareModel(context) {}

    void set_parameters(std::span<const float> values) override {
        std::memcpy(&params_, values.data(), sizeof params_);
        parameters_changed();
    }
    bool is_identity() const override { return params_.strength <= 0; }
    bool obeys_residual_law() const override { return params_.photographic <= 0.5f && person() == wearer(); }

private:
    GlareSetup setup() override;
    glm::dvec3 weights(uint, double pupil_mm) const override {
        return static_cast<double>(params_.strength) *
               glm::dvec3(1, (1 - covered()) * static_cast<double>(params_.diffraction) / pupil_mm,
                          static_cast<double>(params_.lenticular_halo) * closed_form::lenticular_share(pupil_mm));
    }

    Eye person() const { return {static_cast<double>(params_.age), static_cast<double>(params_.pigment), static_cast<double>(params_.straylight_factor)}; }
    Eye wearer() const {
        const Eye p = person();
        return {params_.wearer_age > 0 ? static_cast<double>(params_.wearer_age) : p.age,
                params_.wearer_pigment >= 0 ? static_cast<double>(params_.wearer_pigment) : p.pigment,
                params_.wearer_straylight_factor > 0 ? static_cast<double>(params_.wearer_straylight_factor) : p.factor};
    }
    // Share of the pupil that the particles cover, which is the share of the light that passes which they scatter.
    double covered() const {
        const double disc_mm2 = pi / 4 * std::pow(static_cast<double>(params_.particle_diameter_um) * 1e-3, 2);
        return -std::expm1(-static_cast<double>(params_.particles_per_mm2) * disc_mm2);
    }
    // Without straylight: particle halo, pupil, lens fibres.
    RadialProfile wave_optics(const GlareSpectrum& spectrum) const;
    RadialProfile straylight(const Eye& eye, const GlareSpectrum& white, const RadialProfile& waves) const;
    glm::dvec3 colour_of(const Eye& eye, const GlareSpectrum& spectrum) const;

    void use_emission_spectra(GlareSetup& setup, const RadialProfile& straylight) const;

    ClosedFormParams params_{};
};

RadialProfile ClosedForm::wave_optics(const GlareSpectrum& spectrum) const {
    glm::dvec3 mean_lambda_um{0};
    for (std::size_t i = 0; i < spectrum.nm.size(); ++i) mean_lambda_um += spectrum.weight[i] * (spectrum.nm[i] / 1000);
    const double scale = static_cast<double>(params_.angle_scale), share = 1 / (scale * scale);
    return make_profile([&](double theta) {
        const double inner = theta / scale, sine = std::sin(std::min(inner, 90 * degree));
        glm::dvec3 halo{0}, ring{0};
        for (std::size_t i = 0; i < spectrum.nm.size(); ++i) {
            halo += spectrum.weight[i] * glare::disc_scatter(static_cast<double>(params_.particle_diameter_um), spectrum.nm[i] / 1000, sine);
            if (params_.lenticular_halo > 0) ring += spectrum.weight[i] * closed_form::lenticular_ring(inner / degree, spectrum.nm[i]);
        }
        return RadialEntry{{halo * (covered() * share), mean_lambda_um * (glare::aperture_tail(1000, 1, sine) * share), ring * share}};
    });
}

// The straylight of a mean eye holds all that an eye scatters beyond one degree, so that particles and pupil take their light from it and
// what is scattered there in all, in luminance, is what the CIE found.
RadialProfile ClosedForm::straylight(const Eye& eye, const GlareSpectrum& white, const RadialProfile& waves) const {
    const glm::dvec3 luminance(0.2126, 0.7152, 0.0722);
    const double scale = static_cast<double>(params_.angle_scale), from = degree * scale;
    RadialProfile profile = make_profile([&](double theta) {
        const double s = closed_form::straylight(theta / (degree * scale), eye.age, eye.pigment, eye.factor) / (scale * scale);
        return RadialEntry{{glm::dvec3(s), {}, {}}};
    });
    const glm::dvec3 pupil = scattered_beyond(waves, 1, from) * ((1 - covered()) * static_cast<double>(params_.diffraction) / partition_pupil_mm);
    const double others = glm::dot(luminance, scattered_beyond(waves, 0, from) + pupil);
    const double left = std::max(1 - others / scattered_beyond(profile, 0, from).y, 0.0) / glm::dot(luminance, colour_of(eye, white));
    for (RadialEntry& entry : profile) entry.part[0] = glm::dvec3(entry.part[0]) * left;
    return profile;
}

// Straylight's colour by channel, before its luminance is set to 1.
glm::dvec3 ClosedForm::colour_of(const Eye& eye, const GlareSpectrum& spectrum) const {
    glm::dvec3 colour{0};
    for (std::size_t i = 0; i < spectrum.nm.size(); ++i) colour += spectrum.weight[i] * closed_form::straylight_colour(spectrum.nm[i], eye.pigment);
    return glm::mix(spectrum.gain, colour, static_cast<double>(params_.straylight_colour));
}

RadialProfile operator*(const RadialProfile& a, glm::dvec3 colour) {
    RadialProfile product = a;
    for (RadialEntry& entry : product)
        for (vec3& part : entry.part) part = glm::dvec3(part) * colour;
    return product;
}
RadialProfile operator+(const RadialProfile& a, const RadialProfile& b) {
    RadialProfile sum = a;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (uint part = 0; part < radial_parts; ++part) sum[i].part[part] += b[i].part[part];
    return sum;
}

GlareSetup ClosedForm::setup() {
    const GlareSpectrum white = midpoint_spectrum(table_wavelengths);
    const RadialProfile waves = wave_optics(white);
    const auto profile_of = [&](const Eye& eye) { return waves + straylight(eye, white, waves) * colour_of(eye, white); };
    const RadialProfile own = profile_of(person()), wearers = profile_of(wearer());
    const bool differ = !(person() == wearer()), photographic = params_.photographic > 0.5f;
    GlareSetup setup;
    setup.kernels = {own, wearers};
    if (differ) setup.kernels = {own, wearers, own, wearers};
    setup.terms = observer_terms(photographic, params_.rescatter, 1, differ ? std::optional(2u) : std::nullopt);
    if (params_.emission_spectra > 0.5f && !photographic) use_emission_spectra(setup, straylight(person(), white, waves));
    setup.texel_px = params_.texel_px;
    setup.near_px = params_.near_px;
    setup.near_from = params_.near_from;
    setup.rebuild_mm = params_.rebuild_mm;
    return setup;
}

// The person's kernel for what each channel gets of its own primary, of the next and of the one after.
void ClosedForm::use_emission_spectra(GlareSetup& setup, const RadialProfile& straylight) const {
    for (int turn = 0; turn < 3; ++turn) {
        const GlareSpectrum spectrum = emission_spectrum(table_wavelengths, turn);
        const RadialProfile kernel = wave_optics(spectrum) + straylight * colour_of(person(), spectrum);
        if (turn == 0) {
            setup.kernels[0] = kernel;
            continue;
        }
        setup.terms.push_back({source_excess, static_cast<uint>(setup.kernels.size()), 1, true, static_cast<uint>(turn)});
        setup.kernels.push_back(kernel);
    }
}

}  // namespace

std::unique_ptr<ReferenceModel> make_closed_form_reference();

extern const ModelEntry closed_form_entry;
const ModelEntry closed_form_entry{"glare",    "closed_form", "Straylight by age and pigment, particles and pupil, for the light that the panel cannot send",
                                   parameters, &ClosedForm::create, &make_closed_form_reference};

}  // namespace entoptic::perception
