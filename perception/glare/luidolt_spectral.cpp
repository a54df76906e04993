// luidolt_spectral on the GPU. What is done when:
//   parameters change      spectrum, halo table and particles on the CPU; transforms of the pupil's patches
//   pupil crosses a step   a kernel for that diameter: sum of the patches, kernel, its spectrum, its coverage
//   every frame            gate; pixels -> nodes -> texels; transform, product, transform; texels -> nodes -> pixels; near field
#include "perception/glare/glare.h"
#include "perception/glare/glare_grid.h"
#include "perception/glare/luidolt_spectral_pupil.h"

#include "perception/glare/luidolt_spectral_apply.comp.h"
#include "perception/glare/luidolt_spectral_columns.comp.h"
#include "perception/glare/luidolt_spectral_coverage.comp.h"
#include "perception/glare/luidolt_spectral_gate.comp.h"
#include "perception/glare/luidolt_spectral_gather.comp.h"
#include "perception/glare/luidolt_spectral_kernel.comp.h"
#include "perception/glare/luidolt_spectral_near.comp.h"
#include "perception/glare/luidolt_spectral_particles.comp.h"
#include "perception/glare/luidolt_spectral_pixels.comp.h"
#include "perception/glare/luidolt_spectral_pupil_sum.comp.h"
#include "perception/glare/luidolt_spectral_rows.comp.h"
#include "perception/glare/luidolt_spectral_splat.comp.h"
#include "perception/glare/luidolt_spectral_structure.comp.h"
#include "perception/glare/luidolt_spectral_tiles.comp.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

namespace entoptic::perception {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double degree = pi / 180;

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 10, 1, "choice: 1 is the eye that the other parameters describe", "times the scattered light; at most 0.9 of all light is scattered"},
    {"particle_diameter_um", "um", 1, 20, 6, "Luidolt 2020, figure 4", "diameter of the particles in cornea and lens"},
    {"particles_per_mm2", "1/mm2", 0, 1e5f, 79.577f, "Luidolt 2020, figure 4: 1000 in a pupil of 4 mm", "particles per area of the pupil; they stay where they are when the pupil moves"},
    {"wavelengths", "1", 3, 32, 8, "facts 3.3, trap L9: midpoints of 400..700 nm", "samples of the spectrum in the halo's texture; its mean has 96"},
    {"diffraction", "1", 0, 1, 1, "Luidolt 2020, eq. 5", "share of the light that the edge of the pupil diffracts; 0 with no particles: no glare at all"},
    {"patches", "1", 0, 256, 64, "choice: error and time in the ledger (Welch 1967)", "patches of the pupil whose particles give the halo its texture; 0: smooth"},
    {"texel_px", "px", 1, 16, 4, "facts 3.4.2: 4 has p99 dE_ITP 0.3", "least width of a texel of the grid on which wide glare is computed"},
    {"near_px", "px", 0, 8, 8, "facts 3.3c and 3.4.2", "radius of the near field, done at full resolution"},
    {"near_from", "1", 0, 1e6f, 16, "choice: dimmer light the panel shows as it is, and the wearer's own eye scatters it", "light above this many times the adaptation luminance has a near field; 0: all light"},
    {"rebuild_mm", "mm", 0.02f, 1, 0.2f, "facts 3.4.6; linear between diameters, so twice as far is as good", "distance of the pupil diameters at which the kernel is built"},
    {"angle_scale", "1", 1, 17.5f, 1, "trap L10: 17.5 is the paper's texel for pixel", "enlarges the kernel"},
    {"radius_deg", "deg", 2, 180, 180, "trap L13: the veil counts out to the edge", "the kernel ends here"},
    {"window_sigma_deg", "deg", 0, 90, 0, "Luidolt 2020, section 4.2.3; trap L13", "Gaussian window around the gaze; 0: whole field"},
    {"as_printed", "bool", 0, 1, 0, "Luidolt 2020, eq. 9 and 10", "1: colour cast, 380..770 nm, 1000 particles in any pupil, all light has a near field, window of 10 degrees"},
};
static_assert(sizeof(LuidoltSpectralParams) == sizeof(float) * std::size(parameters));

using enum gpu::BindingKind;

// Data made on the CPU, read by the GPU for many frames: copied to the device's own memory by the first batch that is recorded.
struct StaticBuffer {
    gpu::Buffer staging, buffer;

    template <class T> static Result<StaticBuffer> create(const gpu::Device& device, const std::vector<T>& data, const std::string& name) {
        StaticBuffer made;
        const std::size_t bytes = std::max<std::size_t>(data.size() * sizeof(T), 64);
        ENTOPTIC_TRY(staging, gpu::Buffer::create(device, bytes, gpu::BufferKind::upload, name + ".staging"));
        ENTOPTIC_TRY(buffer, gpu::Buffer::create(device, bytes, gpu::BufferKind::device, name));
        if (!data.empty()) std::memcpy(staging.bytes().data(), data.data(), data.size() * sizeof(T));
        made.staging = std::move(staging);
        made.buffer = std::move(buffer);
        return made;
    }
    void record_copy(gpu::Commands& commands) const { commands.copy(staging, buffer, buffer.size()); }
};

std::vector<vec2> make_twiddles() {
    std::vector<vec2> table(glare_n);
    for (uint n = 0; n < glare_n; ++n) table[n] = glm::dvec2(std::cos(2 * pi * n / glare_n), -std::sin(2 * pi * n / glare_n));
    return table;
}

// The two built kernels between which the pupil lies.
struct KernelChoice {
    long first = 0;       // diameter in steps; first + 1 is the other
    float blend = 0;      // 0: first .. 1: first + 1
};

class LuidoltSpectral final : public Model {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<LuidoltSpectral>(context);
        ENTOPTIC_CHECK(model->make_kernels());
        return model;
    }
    explicit LuidoltSpectral(const ModelContext& context) : context_(context) {}

    void set_parameters(std::span<const float> values) override {
        std::memcpy(&params_, values.data(), sizeof params_);
        prepared_ = false;
    }
    bool is_identity() const override {
        return params_.strength <= 0 || (params_.particles_per_mm2 <= 0 && params_.diffraction <= 0 && params_.as_printed <= 0.5f);
    }
    Result<void> record(StageIo& io) override;

private:
    struct Wanted {
        gpu::Kernel* kernel;
        const char* name;
        std::span<const std::uint32_t> spirv;
        std::uint32_t buffers, push_bytes;
        std::vector<std::uint32_t> specialization;
    };
    Result<void> make_kernel(const Wanted& w);
    Result<void> make_kernels();
    Result<void> prepare();
    Result<void> make_buffers();
    void record_first(StageIo& io);
    void record_texture(StageIo& io);
    void record_kernel(StageIo& io, long steps);
    void record_frame(StageIo& io, KernelChoice choice);

    KernelChoice choose_kernel(const StageIo& io) const;
    double diameter_mm(long steps) const { return std::max(static_cast<double>(steps) * static_cast<double>(params_.rebuild_mm), 0.5); }
    uint pairs() const { return static_cast<uint>(grid_.patches.size() + 1) / 2; }
    uint nodes() const { return grid_.nodes_x * grid_.nodes_y; }
    bool as_printed() const { return params_.as_printed > 0.5f; }
    float near_rad() const;
    float window_sigma_rad() const;
    float near_from() const { return as_printed() ? 0 : params_.near_from; }
    LatticePush lattice(const StageIo& io) const {
        return {io.width, io.height, grid_.nodes_x, grid_.nodes_y, grid_.step, io.tiles_x, io.tiles_y, params_.near_px >= 1 ? 1u : 0u};
    }
    FftPush all_rows() const { return {0, glare_n, 3, 0, 0, 0, static_cast<float>(grid_.damping)}; }
    FftPush light_rows() const { return {grid_.first_row, grid_.rows, 3, 0, 0, 0, 0}; }
    Result<gpu::Buffer> device_buffer(std::size_t bytes, const char* name) {
        return gpu::Buffer::create(context_.device, bytes, gpu::BufferKind::device, name);
    }

    ModelContext context_;
    LuidoltSpectralParams params_{};
    bool prepared_ = false, first_recorded_ = false;
    GlareGrid grid_;
    float grid_texel_px_ = 0;
    SpectralTable spectrum_{};
    ParticleField particles_;
    std::optional<long> built_[2];       // diameters (in steps) of the kernels in the two planes

    gpu::Kernel gate_, tiles_, pixels_, coverage_, splat_, rows_forward_, rows_inverse_, columns_transform_, columns_convolve_, columns_kernel_,
        gather_coverage_, gather_veil_, near_, apply_, particles_kernel_, structure_kernel_, pupil_sum_, kernel_kernel_;
    StaticBuffer twiddle_, taps_, splat_offsets_, splat_entries_, spectrum_table_, halo_table_, cell_offsets_, particle_list_, particle_mean_, radii_;
    gpu::Buffer work_, coverage_rows_, spectra_, node_values_, node_exchange_, node_coverage_, near_tiles_, flags_, near_light_, structure_, pupil_structure_;
};

Result<void> LuidoltSpectral::make_kernels() {
    const Wanted wanted[] = {
        {&gate_, "glare.gate", luidolt_spectral_gate_comp_spv, 3, sizeof(GatePush), {}},
        {&tiles_, "glare.tiles", luidolt_spectral_tiles_comp_spv, 5, sizeof(TilesPush), {}},
        {&coverage_, "glare.coverage", luidolt_spectral_coverage_comp_spv, 2, sizeof(LatticePush), {}},
        {&splat_, "glare.splat", luidolt_spectral_splat_comp_spv, 4, sizeof(SplatPush), {}},
        {&rows_forward_, "glare.rows", luidolt_spectral_rows_comp_spv, 2, sizeof(FftPush), {0}},
        {&rows_inverse_, "glare.rows_inverse", luidolt_spectral_rows_comp_spv, 2, sizeof(FftPush), {1}},
        {&columns_transform_, "glare.columns", luidolt_spectral_columns_comp_spv, 4, sizeof(FftPush), {0}},
        {&columns_convolve_, "glare.columns_convolve", luidolt_spectral_columns_comp_spv, 4, sizeof(FftPush), {1}},
        {&columns_kernel_, "glare.columns_kernel", luidolt_spectral_columns_comp_spv, 4, sizeof(FftPush), {2}},
        {&gather_coverage_, "glare.gather_coverage", luidolt_spectral_gather_comp_spv, 5, sizeof(GatherPush), {0}},
        {&gather_veil_, "glare.gather", luidolt_spectral_gather_comp_spv, 5, sizeof(GatherPush), {1}},
        {&near_, "glare.near", luidolt_spectral_near_comp_spv, 7, sizeof(NearPush), {}},
        {&particles_kernel_, "glare.particles", luidolt_spectral_particles_comp_spv, 4, sizeof(StructurePush), {}},
        {&structure_kernel_, "glare.structure", luidolt_spectral_structure_comp_spv, 3, sizeof(StructurePush), {}},
        {&pupil_sum_, "glare.pupil_sum", luidolt_spectral_pupil_sum_comp_spv, 3, sizeof(StructurePush), {}},
        {&kernel_kernel_, "glare.kernel", luidolt_spectral_kernel_comp_spv, 4, sizeof(KernelPush), {}},
    };
    for (const Wanted& w : wanted) ENTOPTIC_CHECK(make_kernel(w));
    return {};
}

Result<void> LuidoltSpectral::make_kernel(const Wanted& w) {
    ENTOPTIC_TRY(kernel, gpu::Kernel::create(context_.device, {w.name, w.spirv, std::vector<gpu::BindingKind>(w.buffers, storage_buffer), w.push_bytes,
                                                               w.specialization}));
    *w.kernel = std::move(kernel);
    return {};
}

float LuidoltSpectral::near_rad() const {
    // Without a near field the light of half a texel stays where it is.
    const double near = std::floor(static_cast<double>(params_.near_px)) * grid_.pixel_rad;
    return static_cast<float>(std::max(near, 0.5 * grid_.pitch));
}

float LuidoltSpectral::window_sigma_rad() const {
    // The paper states no width of its window; 10 degrees is a choice.
    const float deg = as_printed() && params_.window_sigma_deg <= 0 ? 10.0f : params_.window_sigma_deg;
    return deg * static_cast<float>(degree);
}

// Everything that depends on parameters and geometry. Waits for the device, since buffers of earlier frames may go.
Result<void> LuidoltSpectral::prepare() {
    {
        const std::lock_guard lock(context_.device.queue_mutex());
        ENTOPTIC_VK(vkDeviceWaitIdle(context_.device.handle()));
    }
    spectrum_ = make_spectrum(params_);
    particles_ = make_particles(params_, context_.seed);
    built_[0].reset();
    built_[1].reset();
    first_recorded_ = false;
    if (params_.texel_px != grid_texel_px_) {
        grid_ = make_glare_grid(context_.views, static_cast<double>(params_.texel_px));
        grid_texel_px_ = params_.texel_px;
        // The two passes over the whole picture have the lattice's step compiled in.
        ENTOPTIC_CHECK(make_kernel({&pixels_, "glare.pixels", luidolt_spectral_pixels_comp_spv, 3, sizeof(LatticePush), {grid_.step}}));
        ENTOPTIC_CHECK(make_kernel({&apply_, "glare.apply", luidolt_spectral_apply_comp_spv, 4, sizeof(LatticePush), {grid_.step}}));
    }
    ENTOPTIC_CHECK(make_buffers());
    prepared_ = true;
    return {};
}

Result<void> LuidoltSpectral::make_buffers() {
    const gpu::Device& device = context_.device;
    const auto make_static = [&](StaticBuffer& to, const auto& data, const char* name) -> Result<void> {
        ENTOPTIC_TRY(made, StaticBuffer::create(device, data, name));
        to = std::move(made);
        return {};
    };
    ENTOPTIC_CHECK(make_static(twiddle_, make_twiddles(), "glare.twiddle"));
    ENTOPTIC_CHECK(make_static(taps_, grid_.node_taps, "glare.taps"));
    ENTOPTIC_CHECK(make_static(splat_offsets_, grid_.splat_offsets, "glare.splat_offsets"));
    ENTOPTIC_CHECK(make_static(splat_entries_, grid_.splat_entries, "glare.splat_entries"));
    ENTOPTIC_CHECK(make_static(spectrum_table_, std::vector<SpectralTable>{spectrum_}, "glare.spectrum"));
    ENTOPTIC_CHECK(make_static(halo_table_, make_halo_table(params_), "glare.halo"));
    ENTOPTIC_CHECK(make_static(cell_offsets_, particles_.cell_offsets, "glare.cells"));
    ENTOPTIC_CHECK(make_static(particle_list_, particles_.particles, "glare.particles"));
    ENTOPTIC_CHECK(make_static(particle_mean_, particles_.mean, "glare.particle_mean"));
    ENTOPTIC_CHECK(make_static(radii_, particles_.radius_mm, "glare.radii"));

    const EyeGeometry& g = context_.views[0];
    const std::size_t views = context_.views.size(), all_nodes = views * nodes(), pixels = std::size_t(g.width) * g.height * views;
    const std::size_t tiles = std::size_t(gpu::groups_for(g.width, tile_width)) * gpu::groups_for(g.height, tile_height) * views;
    const std::size_t complex_plane = glare_plane * sizeof(vec2);
    const struct { gpu::Buffer* buffer; std::size_t bytes; const char* name; } wanted[] = {
        {&work_, 3 * pairs() * complex_plane, "glare.work"},
        {&coverage_rows_, pairs() * complex_plane, "glare.coverage_rows"},
        {&spectra_, 2 * 3 * glare_plane * sizeof(float), "glare.spectra"},
        {&node_values_, all_nodes * sizeof(vec3), "glare.nodes"},
        {&node_exchange_, 2 * all_nodes * sizeof(vec3), "glare.exchange"},
        {&node_coverage_, 2 * all_nodes * sizeof(vec3), "glare.node_coverage"},
        {&near_tiles_, (tiles + 1) * sizeof(uint), "glare.near_tiles"},
        {&flags_, tiles * sizeof(uint), "glare.near_flags"},
        {&near_light_, params_.near_px >= 1 ? pixels * sizeof(vec3) : 64, "glare.near_light"},
        {&structure_, std::max<std::size_t>(particles_.pairs, 1) * structure_n * structure_n * sizeof(float), "glare.structure"},
        {&pupil_structure_, structure_n * structure_n * sizeof(float), "glare.pupil_structure"},
    };
    for (const auto& w : wanted) {
        ENTOPTIC_TRY(buffer, device_buffer(w.bytes, w.name));
        *w.buffer = std::move(buffer);
    }
    return {};
}

// Copies, the coverage of the grid and the transforms of the pupil's patches: once per parameter set.
void LuidoltSpectral::record_first(StageIo& io) {
    gpu::Commands& c = io.commands;
    for (const StaticBuffer* s : {&twiddle_, &taps_, &splat_offsets_, &splat_entries_, &spectrum_table_, &halo_table_, &cell_offsets_, &particle_list_,
                                  &particle_mean_, &radii_})
        s->record_copy(c);
    c.fill(flags_, 0);
    c.dispatch(coverage_, {io.solid_angle, node_values_}, lattice(io), {gpu::groups_for(nodes(), 64), 1, io.views});
    c.barrier();
    const SplatPush splat{0, grid_.first_row, glare_n, grid_.rows, static_cast<uint>(grid_.patches.size()), 1};
    c.dispatch(splat_, {node_values_, splat_offsets_.buffer, splat_entries_.buffer, coverage_rows_}, splat, {glare_n / 64, grid_.rows, pairs()});
    c.barrier();
    c.dispatch(rows_forward_, {coverage_rows_, twiddle_.buffer}, light_rows(), {gpu::groups_for(grid_.rows, fft_lines), pairs(), 1});
    record_texture(io);
}

void LuidoltSpectral::record_texture(StageIo& io) {
    gpu::Commands& c = io.commands;
    const uint batch = 3 * pairs();      // as many planes as the work buffer has
    for (uint first = 0; first < particles_.pairs; first += batch) {
        const uint count = std::min(batch, particles_.pairs - first);
        const StructurePush push{first, count, 0};
        c.barrier();
        c.dispatch(particles_kernel_, {cell_offsets_.buffer, particle_list_.buffer, particle_mean_.buffer, work_}, push, {glare_n / 32, glare_n / 8, count});
        c.barrier();
        c.dispatch(rows_forward_, {work_, twiddle_.buffer}, all_rows(), {glare_n / fft_lines, count, 1});
        c.barrier();
        c.dispatch(columns_transform_, {work_, work_, twiddle_.buffer, spectra_}, all_rows(), {glare_n / fft_lines, count, 1});
        c.barrier();
        c.dispatch(structure_kernel_, {work_, particle_mean_.buffer, structure_}, push, {structure_n / 32, structure_n / 8, count});
    }
}

// Kernel, spectrum and coverage of one pupil diameter, into the plane of its parity.
void LuidoltSpectral::record_kernel(StageIo& io, long steps) {
    gpu::Commands& c = io.commands;
    const uint key = static_cast<uint>(steps & 1);
    const double pupil_mm = diameter_mm(steps);
    if (particles_.pairs > 0) {
        const StructurePush push{0, particles_.pairs, static_cast<float>(pupil_mm / 2)};
        c.barrier();
        c.dispatch(pupil_sum_, {structure_, radii_.buffer, pupil_structure_}, push, {structure_n * structure_n / 256, 1, 1});
    }
    const KernelPush push{static_cast<float>(grid_.pitch),
                          near_rad(),
                          params_.radius_deg * static_cast<float>(degree),
                          static_cast<float>(pupil_mm * 1000),
                          params_.particle_diameter_um,
                          static_cast<float>(covered_share(params_, pupil_mm)),
                          params_.diffraction,
                          params_.angle_scale,
                          static_cast<float>(safe_strength(params_, spectrum_, pupil_mm, grid_.smallest_step)),
                          static_cast<float>(glare_patch_um),
                          particles_.pairs > 0 ? 1u : 0u};
    c.barrier();
    c.dispatch(kernel_kernel_, {spectrum_table_.buffer, halo_table_.buffer, pupil_structure_, work_}, push, {glare_n / 64, glare_n, 1});
    c.barrier();
    c.dispatch(rows_forward_, {work_, twiddle_.buffer}, all_rows(), {glare_n / fft_lines, 2, 1});
    c.barrier();
    FftPush spectrum = all_rows();
    spectrum.first_key = spectrum.second_key = key;
    c.dispatch(columns_kernel_, {work_, work_, twiddle_.buffer, spectra_}, spectrum, {glare_n / fft_lines, 2, 1});
    c.barrier();
    FftPush convolve = light_rows();
    convolve.input_channels = 1;
    convolve.first_key = convolve.second_key = key;
    c.dispatch(columns_convolve_, {coverage_rows_, work_, twiddle_.buffer, spectra_}, convolve, {glare_n / fft_lines, 3 * pairs(), 1});
    c.barrier();
    c.dispatch(rows_inverse_, {work_, twiddle_.buffer}, light_rows(), {gpu::groups_for(grid_.rows, fft_lines), 3 * pairs(), 1});
    c.barrier();
    GatherPush gather{grid_.nodes_x, grid_.nodes_y, grid_.step, grid_.taps, key, key, key, 0, vec3(1), 0, {}};
    c.dispatch(gather_coverage_, {work_, taps_.buffer, node_coverage_, node_exchange_, io.geometry}, gather, {gpu::groups_for(nodes(), 256), 1, io.views});
    built_[key] = steps;
}

// The kernel is a function of the pupil diameter alone, and a continuous one: kernels stand at multiples of rebuild_mm, and what lies between
// is interpolated. No history, so nothing can flicker or differ between two runs. Both pupils move together (consensual reflex): their mean.
KernelChoice LuidoltSpectral::choose_kernel(const StageIo& io) const {
    double sum = 0;
    int valid = 0;
    for (const EyeInput& eye : io.input.eyes)
        if (eye.pupil_diameter_mm >= 0.5f && eye.pupil_diameter_mm <= 20) {      // false for NaN
            sum += static_cast<double>(eye.pupil_diameter_mm);
            ++valid;
        }
    const double steps = std::clamp(valid > 0 ? sum / valid : 4.0, 1.0, largest_pupil_mm) / static_cast<double>(params_.rebuild_mm);
    const double floor = std::floor(steps);
    return {static_cast<long>(floor), static_cast<float>(steps - floor)};
}

Result<void> LuidoltSpectral::record(StageIo& io) {
    if (!prepared_) ENTOPTIC_CHECK(prepare());
    if (!first_recorded_) record_first(io);
    first_recorded_ = true;
    const KernelChoice choice = choose_kernel(io);
    for (const long steps : {choice.first, choice.first + 1})
        if (built_[steps & 1] != steps) record_kernel(io, steps);
    io.commands.barrier();
    record_frame(io, choice);
    return {};
}

void LuidoltSpectral::record_frame(StageIo& io, KernelChoice choice) {
    gpu::Commands& c = io.commands;
    const uint first = static_cast<uint>(choice.first & 1), second = 1 - first;
    const double pupil_mm = diameter_mm(choice.first) * (1 - static_cast<double>(choice.blend)) + diameter_mm(choice.first + 1) * static_cast<double>(choice.blend);
    const double strength = safe_strength(params_, spectrum_, diameter_mm(choice.first), grid_.smallest_step);
    const auto entry = [&](uint i) { return offsetof(Gate, dispatch) + i * sizeof(GateDispatch); };
    const bool near = params_.near_px >= 1;

    GatePush gate{};
    gate.scattered = static_cast<float>(strength * scattered_share(params_, spectrum_, diameter_mm(choice.first), grid_.smallest_step));
    gate.views = io.views;
    gate.always = as_printed() ? 1 : 0;
    const uint lattice_groups = gpu::groups_for(grid_.nodes_x, 256 / grid_.step - 2);
    gate.groups[gate_tiles] = {near ? gpu::groups_for(io.tiles_x * io.tiles_y * io.views, 256) : 0, 1, 1};
    gate.groups[gate_pixels] = {lattice_groups, gpu::groups_for(grid_.nodes_y, 8), io.views};
    gate.groups[gate_splat] = {glare_n / 64, grid_.rows, pairs()};
    gate.groups[gate_rows] = {gpu::groups_for(grid_.rows, fft_lines), 3 * pairs(), 1};
    gate.groups[gate_columns] = {glare_n / fft_lines, 3 * pairs(), 1};
    gate.groups[gate_gather] = {gpu::groups_for(nodes(), 256), 1, io.views};
    gate.groups[gate_near] = {0, 1, 1};
    gate.groups[gate_apply] = {gpu::groups_for(io.width, 256), gpu::groups_for(io.height + grid_.step / 2, grid_.step), io.views};
    c.dispatch(gate_, {io.statistics, io.gate, near_tiles_}, gate, {1, 1, 1});
    c.barrier();

    const LatticePush lattice_push = lattice(io);
    const TilesPush tiles{io.tiles_x, io.tiles_y, io.views, near_from()};
    c.dispatch_indirect(tiles_, {io.tiles, io.state, io.gate, near_tiles_, flags_}, tiles, io.gate, entry(gate_tiles));
    c.dispatch_indirect(pixels_, {io.scene, io.solid_angle, node_values_}, lattice_push, io.gate, entry(gate_pixels));
    c.barrier();
    const SplatPush splat{0, grid_.first_row, glare_n, grid_.rows, static_cast<uint>(grid_.patches.size()), 3};
    c.dispatch_indirect(splat_, {node_values_, splat_offsets_.buffer, splat_entries_.buffer, work_}, splat, io.gate, entry(gate_splat));
    vec3 gaze[2] = {{0, 0, -1}, {0, 0, -1}};
    for (std::size_t i = 0; i < std::min<std::size_t>(io.input.eyes.size(), 2); ++i) gaze[i] = io.input.eyes[i].gaze_direction;
    if (near) {
        const NearPush push{io.width, io.height, io.tiles_x, io.tiles_y, near_rad(),
                            static_cast<float>(pupil_mm * 1000), static_cast<float>(covered_share(params_, pupil_mm)), params_.diffraction,
                            params_.angle_scale, params_.radius_deg * static_cast<float>(degree), static_cast<float>(strength), near_from(),
                            window_sigma_rad(), {gaze[0], gaze[1]}};
        c.dispatch_indirect(near_, {io.scene, io.state, near_tiles_, io.geometry, spectrum_table_.buffer, halo_table_.buffer, near_light_}, push, io.gate,
                            entry(gate_near));
    }
    c.barrier();
    c.dispatch_indirect(rows_forward_, {work_, twiddle_.buffer}, light_rows(), io.gate, entry(gate_rows));
    c.barrier();
    FftPush convolve = light_rows();
    convolve.first_key = first;
    convolve.second_key = second;
    convolve.blend = choice.blend;
    c.dispatch_indirect(columns_convolve_, {work_, work_, twiddle_.buffer, spectra_}, convolve, io.gate, entry(gate_columns));
    c.barrier();
    c.dispatch_indirect(rows_inverse_, {work_, twiddle_.buffer}, light_rows(), io.gate, entry(gate_rows));
    c.barrier();
    const GatherPush gather{grid_.nodes_x, grid_.nodes_y, grid_.step, grid_.taps, 0, first, second, choice.blend, spectrum_.gain, window_sigma_rad(),
                            {gaze[0], gaze[1]}};
    c.dispatch_indirect(gather_veil_, {work_, taps_.buffer, node_coverage_, node_exchange_, io.geometry}, gather, io.gate, entry(gate_gather));
    c.barrier();
    c.dispatch_indirect(apply_, {io.scene, node_exchange_, near_light_, flags_}, lattice_push, io.gate, entry(gate_apply));
}

}  // namespace

std::unique_ptr<ReferenceModel> make_luidolt_spectral_reference();

extern const ModelEntry luidolt_spectral_entry;
const ModelEntry luidolt_spectral_entry{"glare",    "luidolt_spectral", "Particles and pupil as wave optics sees them, spectral (Luidolt 2020)",
                                        parameters, &LuidoltSpectral::create, &make_luidolt_spectral_reference};

}  // namespace entoptic::perception
