#include "perception/glare/glare_engine.h"

#include "perception/glare/glare_math.glsl"
#include "perception/glare/glare_split.h"
#include "shaders/scene_statistics.h"

#include "perception/glare/glare_apply.comp.h"
#include "perception/glare/glare_billboard_choice.comp.h"
#include "perception/glare/glare_billboard_kernel.comp.h"
#include "perception/glare/glare_billboards.comp.h"
#include "perception/glare/glare_columns.comp.h"
#include "perception/glare/glare_coverage.comp.h"
#include "perception/glare/glare_gate.comp.h"
#include "perception/glare/glare_gather.comp.h"
#include "perception/glare/glare_kernel.comp.h"
#include "perception/glare/glare_lit.comp.h"
#include "perception/glare/glare_near.comp.h"
#include "perception/glare/glare_near_drawn.comp.h"
#include "perception/glare/glare_pixels.comp.h"
#include "perception/glare/glare_rows.comp.h"
#include "perception/glare/glare_splat.comp.h"
#include "perception/glare/glare_tiles.comp.h"
#include "perception/glare/glare_zone.comp.h"

#include <cmath>

namespace entoptic::perception {
namespace {

constexpr double pi = 3.14159265358979323846;

using enum gpu::BindingKind;

std::vector<vec2> make_twiddles() {
    std::vector<vec2> table(glare_n);
    for (uint n = 0; n < glare_n; ++n) table[n] = glm::dvec2(std::cos(2 * pi * n / glare_n), -std::sin(2 * pi * n / glare_n));
    return table;
}

std::size_t entry(uint i) { return offsetof(Gate, dispatch) + i * sizeof(GateDispatch); }

struct Gaze {
    vec3 of[2] = {{0, 0, -1}, {0, 0, -1}};
    explicit Gaze(const StageIo& io) {
        for (std::size_t i = 0; i < std::min<std::size_t>(io.input.eyes.size(), 2); ++i) of[i] = io.input.eyes[i].gaze_direction;
    }
};

}  // namespace

RadialProfile make_profile(const std::function<RadialEntry(double)>& entry_of) {
    RadialProfile profile(radial_entries);
    for (uint i = 0; i < radial_entries; ++i) profile[i] = entry_of(glare::radial_angle(i, static_cast<double>(radial_first), radial_entries));
    return profile;
}

glm::dvec3 scattered_beyond(const RadialProfile& profile, uint part, double from_rad) {
    const double step = std::log(pi / static_cast<double>(radial_first)) / (radial_entries - 1);
    glm::dvec3 sum{0};
    if (profile.empty()) return sum;      // of a kernel that is not round
    for (uint i = 0; i < radial_entries; ++i) {
        const double theta = glare::radial_angle(i, static_cast<double>(radial_first), radial_entries);
        // d(omega) = 2 pi sin(theta) dtheta, dtheta = theta d(log theta).
        if (theta >= from_rad) sum += glm::abs(glm::dvec3(profile[i].part[part])) * (2 * pi * std::sin(theta) * theta * step);
    }
    return sum;
}

namespace {

glm::dvec3 part_at(const RadialProfile& profile, uint part, double theta) {
    const double place = glare::radial_place(theta, static_cast<double>(radial_first), radial_entries);
    const auto i = std::min<std::size_t>(static_cast<std::size_t>(place), radial_entries - 2);
    return glm::mix(glm::dvec3(profile[i].part[part]), glm::dvec3(profile[i + 1].part[part]), place - static_cast<double>(i));
}

// The near part of a profile, and behind it the far part.
void append_split(const RadialProfile& profile, double near_rad, bool capped, RadialProfile& to) {
    const std::size_t near = to.size(), far = near + radial_entries;
    to.resize(far + radial_entries);
    for (uint part = 0; part < radial_parts; ++part) {
        const FarPart far_part([&](double theta) { return part_at(profile, part, theta); }, near_rad, capped);
        for (uint i = 0; i < radial_entries; ++i) {
            const double theta = glare::radial_angle(i, static_cast<double>(radial_first), radial_entries);
            const glm::dvec3 whole = profile[i].part[part], smooth = far_part(theta, whole);
            to[near + i].part[part] = whole - smooth;
            to[far + i].part[part] = smooth;
        }
    }
}

}  // namespace

std::vector<GlareTerm> observer_terms(bool photographic, float rescatter, uint wearer, std::optional<uint> persons) {
    if (photographic) return {{source_scene, 0}};
    std::vector<GlareTerm> terms = {{source_excess, 0}};
    if (persons) {
        terms.push_back({source_displayed, *persons, 1, false});
        terms.push_back({source_displayed, *persons + 1, -1, false});
    }
    // What is drawn at edges of the displayed light lies far from the tiles that have a near field.
    if (rescatter > 0) terms.push_back({source_drawn, wearer, -rescatter, !persons});
    return terms;
}

Result<void> GlareModel::make_kernels() {
    const Wanted wanted[] = {
        {&gate_, "glare.gate", glare_gate_comp_spv, 4, sizeof(GatePush), {}},
        {&tiles_, "glare.tiles", glare_tiles_comp_spv, 5, sizeof(TilesPush), {}},
        {&coverage_, "glare.coverage", glare_coverage_comp_spv, 2, sizeof(LatticePush), {}},
        {&splat_, "glare.splat", glare_splat_comp_spv, 4, sizeof(SplatPush), {}},
        {&rows_transform_, "glare.rows_transform", glare_rows_comp_spv, 2, sizeof(FftPush), FftSize(glare_n).specialization(0)},
        {&columns_transform_, "glare.columns_transform", glare_columns_comp_spv, 4, sizeof(FftPush), FftSize(glare_n).specialization(0)},
        {&gather_coverage_, "glare.gather_coverage", glare_gather_comp_spv, 5, sizeof(GatherPush), {0}},
        {&gather_veil_, "glare.gather", glare_gather_comp_spv, 5, sizeof(GatherPush), {1}},
        {&near_, "glare.near", glare_near_comp_spv, 6, sizeof(NearPush), {}},
        {&near_drawn_, "glare.near_drawn", glare_near_drawn_comp_spv, 7, sizeof(NearPush), {}},
        {&kernel_kernel_, "glare.kernel", glare_kernel_comp_spv, 2, sizeof(KernelPush), {}},
        {&zone_, "glare.zone", glare_zone_comp_spv, 2, sizeof(ZonePush), {}},
        {&lit_, "glare.lit", glare_lit_comp_spv, 2, sizeof(BillboardPush), {}},
        {&billboard_choice_, "glare.billboard_choice", glare_billboard_choice_comp_spv, 2, sizeof(BillboardPush), {}},
        {&billboard_kernel_, "glare.billboard_kernel", glare_billboard_kernel_comp_spv, 2, sizeof(BillboardPush), {}},
        {&billboards_, "glare.billboards", glare_billboards_comp_spv, 3, sizeof(BillboardPush), {}},
    };
    for (const Wanted& w : wanted) ENTOPTIC_CHECK(make_kernel(w));
    return {};
}

Result<void> GlareModel::make_kernel(const Wanted& w) {
    ENTOPTIC_TRY(kernel, gpu::Kernel::create(context_.device, {w.name, w.spirv, std::vector<gpu::BindingKind>(w.buffers, storage_buffer), w.push_bytes,
                                                               w.specialization}));
    *w.kernel = std::move(kernel);
    return {};
}

Result<void> GlareModel::make_buffer(gpu::Buffer& buffer, std::size_t bytes, const char* name) {
    ENTOPTIC_TRY(made, gpu::Buffer::create(context_.device, bytes, gpu::BufferKind::device, name));
    buffer = std::move(made);
    return {};
}

bool GlareModel::has(uint source) const {
    return std::any_of(setup_.terms.begin(), setup_.terms.end(), [&](const GlareTerm& t) { return t.source == source; });
}

uint GlareModel::near_source() const {
    const auto found = std::find_if(setup_.terms.begin(), setup_.terms.end(), [](const GlareTerm& t) { return t.near; });
    return found == setup_.terms.end() ? source_drawn : found->source;
}

bool GlareModel::has_near_field(uint kernel) const {
    return near_field() && std::any_of(setup_.terms.begin(), setup_.terms.end(), [&](const GlareTerm& t) { return t.near && t.kernel == kernel; });
}

float GlareModel::widest_near_rad(uint kernel) const {
    const bool drawn = std::any_of(setup_.terms.begin(), setup_.terms.end(), [&](const GlareTerm& t) { return t.source == source_drawn && t.kernel == kernel; });
    const double px = std::floor(static_cast<double>(setup_.near_px) * (drawn ? drawn_near_share : 1));
    // Without a near field the light of half a texel stays where it is.
    return static_cast<float>(std::max(has_near_field(kernel) ? px * grid_.pixel_rad : 0.0, 0.5 * grid_.pitch));
}

float GlareModel::window_sigma_rad() const { return setup_.window_sigma_deg * static_cast<float>(pi / 180); }

// Everything that depends on parameters and geometry. Waits for the device, since buffers of earlier frames may go.
Result<void> GlareModel::prepare() {
    {
        const std::lock_guard lock(context_.device.queue_mutex());
        ENTOPTIC_VK(vkDeviceWaitIdle(context_.device.handle()));
    }
    setup_ = setup();
    built_.assign(2 * setup_.kernels.size(), std::nullopt);
    first_recorded_ = false;
    if (!grid_.n || setup_.texel_px != grid_texel_px_) {
        grid_ = make_glare_grid(context_.views, static_cast<double>(setup_.texel_px), setup_.least_texels);
        grid_texel_px_ = setup_.texel_px;
    }
    shares_.clear();
    for (const RadialProfile& profile : setup_.kernels) {
        glm::dvec3 share;
        for (uint part = 0; part < radial_parts; ++part) {
            const glm::dvec3 rgb = scattered_beyond(profile, part, 0.5 * grid_.smallest_step);
            share[static_cast<int>(part)] = std::max({rgb.x, rgb.y, rgb.z});
        }
        shares_.push_back(share);
    }
    ENTOPTIC_CHECK(make_sized_passes());
    ENTOPTIC_CHECK(make_buffers());
    ENTOPTIC_CHECK(prepare_far());
    prepared_ = true;
    return {};
}

// Transforms have the size of the grid compiled in, passes over the whole picture the lattice's step and the source.
Result<void> GlareModel::make_sized_passes() {
    const FftSize size(grid_.n);
    const Wanted transforms[] = {
        {&rows_forward_, "glare.rows", glare_rows_comp_spv, 2, sizeof(FftPush), size.specialization(0)},
        {&rows_inverse_, "glare.rows_inverse", glare_rows_comp_spv, 2, sizeof(FftPush), size.specialization(1)},
        {&columns_convolve_, "glare.columns_convolve", glare_columns_comp_spv, 4, sizeof(FftPush), size.specialization(1)},
        {&columns_kernel_, "glare.columns_kernel", glare_columns_comp_spv, 4, sizeof(FftPush), size.specialization(2)},
    };
    for (const Wanted& w : transforms) ENTOPTIC_CHECK(make_kernel(w));
    const uint kept = has(source_scene) ? source_scene : has(source_displayed) ? source_displayed : source_excess;
    for (const GlareTerm& term : setup_.terms)
        ENTOPTIC_CHECK(make_kernel({&pixels_[term.source], "glare.pixels", glare_pixels_comp_spv, 5, sizeof(LatticePush), {grid_.step, term.source}}));
    ENTOPTIC_CHECK(make_kernel({&apply_, "glare.apply", glare_apply_comp_spv, 5, sizeof(LatticePush), {grid_.step, kept, has(source_drawn) ? 1u : 0u, setup_.sigmoid ? 1u : 0u}}));
    return make_kernel({&apply_drawn_, "glare.apply_drawn", glare_apply_comp_spv, 5, sizeof(LatticePush), {grid_.step, source_drawn, 0}});
}

// Near and far part of every kernel.
Result<void> GlareModel::make_profiles() {
    RadialProfile profiles;
    capped_.assign(setup_.kernels.size(), false);
    near_rad_.clear();
    for (uint kernel = 0; kernel < setup_.kernels.size(); ++kernel) {
        const RadialProfile& profile = setup_.kernels[kernel];
        near_rad_.push_back(widest_near_rad(kernel));
        if (profile.empty()) continue;
        const glm::dvec3 weight = safe_weights(kernel, typical_pupil_mm);
        const auto whole = [&](double theta) {
            glm::dvec3 sum{0};
            for (uint part = 0; part < radial_parts; ++part) sum += weight[static_cast<int>(part)] * part_at(profile, part, theta);
            return sum;
        };
        const double reach = has_near_field(kernel) ? FarPart::reach(whole, static_cast<double>(near_rad_[kernel]), grid_.pitch) : 0;
        capped_[kernel] = reach > 0;
        if (reach > 0) near_rad_[kernel] = static_cast<float>(reach);
        append_split(profile, static_cast<double>(near_rad_[kernel]), capped_[kernel], profiles);
    }
    return make_static(profiles_, profiles, "glare.profiles");
}

Result<void> GlareModel::make_buffers() {
    ENTOPTIC_CHECK(make_static(twiddle_, make_twiddles(), "glare.twiddle"));
    ENTOPTIC_CHECK(make_static(taps_, grid_.node_taps, "glare.taps"));
    ENTOPTIC_CHECK(make_static(splat_offsets_, grid_.splat_offsets, "glare.splat_offsets"));
    ENTOPTIC_CHECK(make_static(splat_entries_, grid_.splat_entries, "glare.splat_entries"));
    ENTOPTIC_CHECK(make_profiles());

    const EyeGeometry& g = context_.views[0];
    const std::size_t views = context_.views.size(), all_nodes = views * nodes(), pixels = std::size_t(g.width) * g.height * views, keys = built_.size();
    const std::size_t tiles = std::size_t(gpu::groups_for(g.width, tile_width)) * gpu::groups_for(g.height, tile_height) * views;
    const std::size_t complex_plane = glare_plane * sizeof(vec2);
    const struct { gpu::Buffer* buffer; std::size_t bytes; const char* name; } wanted[] = {
        {&work_, 3 * pairs() * complex_plane, "glare.work"},
        {&coverage_rows_, pairs() * complex_plane, "glare.coverage_rows"},
        {&spectra_, keys * 3 * glare_plane * sizeof(float), "glare.spectra"},
        {&node_values_, all_nodes * sizeof(vec3), "glare.nodes"},
        {&node_exchange_, 2 * all_nodes * sizeof(vec3), "glare.exchange"},
        {&node_coverage_, keys * all_nodes * sizeof(vec3), "glare.node_coverage"},
        {&near_tiles_, (tiles + 1) * sizeof(uint), "glare.near_tiles"},
        {&flags_, tiles * sizeof(uint), "glare.near_flags"},
        {&near_light_, near_field() || has(source_drawn) ? pixels * sizeof(vec3) : 64, "glare.near_light"},
    };
    for (const auto& w : wanted) ENTOPTIC_CHECK(make_buffer(*w.buffer, w.bytes, w.name));
    return make_billboard_buffers();
}

Result<void> GlareModel::make_billboard_buffers() {
    if (setup_.billboard_texels == 0) return {};
    ENTOPTIC_CHECK(make_buffer(lit_texels_, sizeof(uint) + max_billboards * sizeof(LitTexel), "glare.lit_texels"));
    // One texel of light, transformed along its row: 1 everywhere.
    std::vector<vec2> delta(glare_plane, vec2(0));
    std::fill(delta.begin(), delta.begin() + glare_n, vec2(1, 0));
    ENTOPTIC_CHECK(make_static(delta_rows_, delta, "glare.delta_rows"));
    return make_buffer(billboard_, built_.size() * glare_n * glare_n * sizeof(vec3), "glare.billboard");
}

// Copies and the coverage of the grid: once per parameter set.
void GlareModel::record_coverage(StageIo& io) {
    gpu::Commands& c = io.commands;
    for (const StaticBuffer* s : {&twiddle_, &taps_, &splat_offsets_, &splat_entries_, &profiles_}) s->record_copy(c);
    c.fill(flags_, 0);
    if (setup_.billboard_texels > 0) delta_rows_.record_copy(c);
    c.dispatch(coverage_, {io.solid_angle, node_values_}, lattice(io), {gpu::groups_for(nodes(), 64), 1, io.views});
    c.barrier();
    const SplatPush splat{0, grid_.first_row, grid_.n, grid_.rows, static_cast<uint>(grid_.patches.size()), 1};
    c.dispatch(splat_, {node_values_, splat_offsets_.buffer, splat_entries_.buffer, coverage_rows_}, splat, {grid_.n / 64, grid_.rows, pairs()});
    c.barrier();
    c.dispatch(rows_forward_, {coverage_rows_, twiddle_.buffer}, light_rows(), {row_groups(), pairs(), 1});
}

void GlareModel::record_transform(gpu::Commands& c, uint planes) {
    const FftPush whole{0, glare_n, 3, 0, 0, 0, 0, 0};
    const uint groups = FftSize(glare_n).groups();
    c.dispatch(rows_transform_, {work_, twiddle_.buffer}, whole, {groups, planes, 1});
    c.barrier();
    c.dispatch(columns_transform_, {work_, work_, twiddle_.buffer, spectra_}, whole, {groups, planes, 1});
}

// Kernel, spectrum and coverage of one pupil diameter, into the plane of its parity.
void GlareModel::record_kernel(StageIo& io, uint kernel, long steps) {
    gpu::Commands& c = io.commands;
    const uint key = key_of(kernel, steps);
    const double pupil_mm = diameter_mm(steps);
    c.barrier();
    if (!record_far_kernel(io, kernel, steps)) {
        const KernelPush push{static_cast<float>(grid_.pitch), far_profile(kernel), vec3(safe_weights(kernel, pupil_mm))};
        c.dispatch(kernel_kernel_, {profiles_.buffer, work_}, push, kernel_groups());
    }
    c.barrier();
    c.dispatch(rows_forward_, {work_, twiddle_.buffer}, all_rows(), {FftSize(grid_.n).groups(), 2, 1});
    c.barrier();
    FftPush spectrum = all_rows();
    const Sharpening sharpening = sharpening_for(static_cast<double>(near_rad(kernel)), grid_.pitch, grid_.damping, capped_[kernel], setup_.smooth);
    spectrum.damping = static_cast<float>(sharpening.damping);
    spectrum.order = sharpening.order;
    spectrum.first_key = spectrum.second_key = key;
    c.dispatch(columns_kernel_, {work_, work_, twiddle_.buffer, spectra_}, spectrum, {FftSize(grid_.n).groups(), 2, 1});
    if (std::any_of(setup_.terms.begin(), setup_.terms.end(), [&](const GlareTerm& t) { return t.kernel == kernel && leaves(t); }))
        record_node_coverage(io, kernel, key);
    if (setup_.billboard_texels > 0) record_billboard(io, key);
    built_[key] = steps;
}

// The share of each node's light that the kernel moves away: the convolution of a picture of ones.
void GlareModel::record_node_coverage(StageIo& io, uint kernel, uint key) {
    gpu::Commands& c = io.commands;
    FftPush convolve = light_rows();
    convolve.input_channels = 1;
    convolve.first_key = convolve.second_key = key;
    c.barrier();
    c.dispatch(columns_convolve_, {coverage_rows_, work_, twiddle_.buffer, spectra_}, convolve, {FftSize(grid_.n).groups(), 3 * pairs(), 1});
    c.barrier();
    c.dispatch(rows_inverse_, {work_, twiddle_.buffer}, light_rows(), {row_groups(), 3 * pairs(), 1});
    c.barrier();
    const GatherPush gather{grid_.nodes_x, grid_.nodes_y, grid_.step, grid_.taps, key, key, key, 0, 1, 1, 0, 0, 0, vec3(1), {}};
    c.dispatch(gather_coverage_, {work_, taps_.buffer, node_coverage_, node_exchange_, io.geometry}, gather, {gpu::groups_for(nodes(), 256), 1, io.views});
    for (const GlareTerm& term : setup_.terms)
        if (term.kernel == kernel && leaves(term)) {
            record_zone(io, node_coverage_, term.zone, std::size_t(key) * nodes() * io.views, false);
            break;
        }
}

// Weighs one vector a node by how far it lies in the zone.
void GlareModel::record_zone(StageIo& io, const gpu::Buffer& values, uint zone, std::size_t first, bool gated) {
    if (setup_.zones < 2) return;
    const ZonePush push{grid_.nodes_x, grid_.nodes_y, grid_.step, static_cast<uint>(first), zone, setup_.zones};
    io.commands.barrier();
    if (gated) io.commands.dispatch_indirect(zone_, {values, io.geometry}, push, io.gate, entry(gate_gather));
    else io.commands.dispatch(zone_, {values, io.geometry}, push, {gpu::groups_for(nodes(), 256), 1, io.views});
}

// The kernel as the transforms draw it, in space: its convolution with one texel of light.
void GlareModel::record_billboard(StageIo& io, uint key) {
    gpu::Commands& c = io.commands;
    FftPush convolve = all_rows();
    convolve.input_channels = 1;
    convolve.first_key = convolve.second_key = key;
    c.barrier();
    c.dispatch(columns_convolve_, {delta_rows_.buffer, work_, twiddle_.buffer, spectra_}, convolve, {FftSize(grid_.n).groups(), 3, 1});
    c.barrier();
    c.dispatch(rows_inverse_, {work_, twiddle_.buffer}, all_rows(), {FftSize(grid_.n).groups(), 3, 1});
    c.barrier();
    c.dispatch(billboard_kernel_, {work_, billboard_}, BillboardPush{.first_key = key}, kernel_groups());
}

// The kernel is a function of the pupil diameter alone, and a continuous one: no history, so nothing can flicker or differ between two runs.
// Both pupils move together (consensual reflex): their mean.
GlareModel::KernelChoice GlareModel::choose_kernel(const StageIo& io) {
    if (setup_.rebuild_mm <= 0) return {};
    double sum = 0;
    int valid = 0;
    for (const EyeInput& eye : io.input.eyes)
        if (eye.pupil_diameter_mm >= 0.5f && eye.pupil_diameter_mm <= 20) {      // false for NaN
            sum += static_cast<double>(eye.pupil_diameter_mm);
            ++valid;
        }
    const double steps = std::clamp(valid > 0 ? sum / valid : 4.0, smallest_pupil_mm, largest_pupil_mm) / static_cast<double>(setup_.rebuild_mm);
    const double floor = std::floor(steps);
    return {static_cast<long>(floor), static_cast<long>(floor) + 1, static_cast<float>(steps - floor)};
}

glm::dvec3 GlareModel::safe_weights(uint kernel, double pupil_mm) const {
    const glm::dvec3 wanted = weights(kernel, pupil_mm);
    const double scattered = glm::dot(glm::abs(wanted), shares_[kernel]);
    return wanted * std::min(1.0, most_scattered / std::max(scattered, 1e-9));
}

glm::dvec3 GlareModel::blended(uint kernel, KernelChoice choice) const {
    return glm::mix(safe_weights(kernel, diameter_mm(choice.first)), safe_weights(kernel, diameter_mm(choice.second)), static_cast<double>(choice.blend));
}

double GlareModel::scattered(uint kernel, KernelChoice choice) const { return glm::dot(glm::abs(blended(kernel, choice)), shares_[kernel]); }

Result<void> GlareModel::record(StageIo& io) {
    if (!prepared_) ENTOPTIC_CHECK(prepare());
    if (!first_recorded_) {
        record_coverage(io);
        record_first(io);
    }
    first_recorded_ = true;
    const KernelChoice choice = choose_kernel(io);
    for (uint kernel = 0; kernel < setup_.kernels.size(); ++kernel)
        for (const long steps : {choice.first, choice.second})
            if (built_[key_of(kernel, steps)] != steps) record_kernel(io, kernel, steps);
    io.commands.barrier();
    record_gate(io, choice);
    bool near_before = false, before = false;
    for (const GlareTerm& term : setup_.terms)
        if (term.near && near_field() && term.source != source_drawn) {
            record_near(io, term, choice, near_before);
            near_before = true;
        }
    if (near_before) io.commands.barrier();
    for (const GlareTerm& term : setup_.terms)
        if (term.source != source_drawn) {
            record_far(io, term, choice, before);
            before = true;
        }
    record_apply(io, apply_);
    for (const GlareTerm& term : setup_.terms)
        if (term.source == source_drawn) {
            io.commands.barrier();
            record_far(io, term, choice, false);
            if (term.near && near_field()) {
                record_near_drawn(io, term, choice);
                io.commands.barrier();
            }
            record_apply(io, apply_drawn_);
        }
    return {};
}

void GlareModel::record_gate(StageIo& io, KernelChoice choice) {
    GatePush gate{};
    for (const GlareTerm& term : setup_.terms) {
        if (term.source == source_excess) gate.excess = 1;
        if (term.source == source_scene || term.source == source_displayed) gate.scattered += static_cast<float>(scattered(term.kernel, choice));
    }
    gate.views = io.views;
    gate.always = setup_.gain == vec3(1) ? 0 : 1;
    gate.groups[gate_tiles] = {near_field() ? gpu::groups_for(io.tiles_x * io.tiles_y * io.views, 256) : 0, 1, 1};
    gate.groups[gate_pixels] = {gpu::groups_for(grid_.nodes_x, 256 / grid_.step - 2), gpu::groups_for(grid_.nodes_y, 8), io.views};
    gate.groups[gate_splat] = {grid_.n / 64, grid_.rows, pairs()};
    gate.groups[gate_rows] = {row_groups(), 3 * pairs(), 1};
    gate.groups[gate_columns] = {FftSize(grid_.n).groups(), 3 * pairs(), 1};
    gate.groups[gate_gather] = {gpu::groups_for(nodes(), 256), 1, io.views};
    gate.groups[gate_near] = {0, 1, 1};
    gate.groups[gate_apply] = {gpu::groups_for(io.width, 256), gpu::groups_for(io.height + grid_.step / 2, grid_.step), io.views};
    io.commands.dispatch(gate_, {io.statistics, io.gate, near_tiles_, io.state}, gate, {1, 1, 1});
    io.commands.barrier();
    const double widest = near_rad_.empty() ? 0 : static_cast<double>(*std::max_element(near_rad_.begin(), near_rad_.end()));
    const double reach_px = std::min(std::ceil(widest / grid_.smallest_step), static_cast<double>(max_near_px));
    const TilesPush tiles{io.tiles_x, io.tiles_y, io.views, near_from(), gpu::groups_for(static_cast<uint>(reach_px), tile_height)};
    io.commands.dispatch_indirect(tiles_, {io.tiles, io.state, io.gate, near_tiles_, flags_}, tiles, io.gate, entry(gate_tiles));
    io.commands.barrier();
}

NearPush GlareModel::near_push(const StageIo& io, const GlareTerm& term, KernelChoice choice, bool add) const {
    const Gaze gaze(io);
    return {io.width, io.height, io.tiles_x, io.tiles_y, near_profile(term.kernel), term.turn, leaves(term) ? 1u : 0u, add ? 1u : 0u,
            near_rad(term.kernel), near_from(), window_sigma_rad(), vec3(blended(term.kernel, choice) * static_cast<double>(term.sign)),
            {gaze.of[0], gaze.of[1]}};
}

void GlareModel::record_near(StageIo& io, const GlareTerm& term, KernelChoice choice, bool add) {
    if (add) io.commands.barrier();
    io.commands.dispatch_indirect(near_, {io.scene, io.state, near_tiles_, io.geometry, profiles_.buffer, near_light_}, near_push(io, term, choice, add),
                                  io.gate, entry(gate_near));
}

// After apply(): near_light_ holds what was drawn, in the tiles around the sources and everywhere else.
void GlareModel::record_near_drawn(StageIo& io, const GlareTerm& term, KernelChoice choice) {
    io.commands.dispatch_indirect(near_drawn_, {io.scene, io.state, near_tiles_, io.geometry, profiles_.buffer, near_light_, flags_},
                                  near_push(io, term, choice, false), io.gate, entry(gate_near));
}

// Pixels to nodes' exchange: what arrives and what leaves.
void GlareModel::record_far(StageIo& io, const GlareTerm& term, KernelChoice choice, bool add) {
    gpu::Commands& c = io.commands;
    const uint first = key_of(term.kernel, choice.first), second = key_of(term.kernel, choice.second);
    if (add) c.barrier();
    c.dispatch_indirect(pixels_[term.source], {io.scene, io.solid_angle, node_values_, io.state, near_light_}, lattice(io, term.turn), io.gate,
                        entry(gate_pixels));
    record_zone(io, node_values_, term.zone, 0, true);
    c.barrier();
    const SplatPush splat{0, grid_.first_row, grid_.n, grid_.rows, static_cast<uint>(grid_.patches.size()), 3};
    c.dispatch_indirect(splat_, {node_values_, splat_offsets_.buffer, splat_entries_.buffer, work_}, splat, io.gate, entry(gate_splat));
    c.barrier();
    record_scattered(io, term, choice);
    const Gaze gaze(io);
    const GatherPush gather{grid_.nodes_x, grid_.nodes_y, grid_.step, grid_.taps, 0, first, second, choice.blend, term.sign,
                            leaves(term) ? 1u : 0u, add ? 1u : 0u, setup_.positive ? 1u : 0u, window_sigma_rad(), setup_.gain, {gaze.of[0], gaze.of[1]}};
    c.dispatch_indirect(gather_veil_, {work_, taps_.buffer, node_coverage_, node_exchange_, io.geometry}, gather, io.gate, entry(gate_gather));
    c.barrier();
}

// Light on the grid to scattered light: by transforms, or where few texels are lit by drawing the kernel at each. The GPU chooses: it leaves
// either dispatch without groups.
void GlareModel::record_scattered(StageIo& io, const GlareTerm& term, KernelChoice choice) {
    gpu::Commands& c = io.commands;
    const uint first = key_of(term.kernel, choice.first), second = key_of(term.kernel, choice.second);
    BillboardPush billboard{grid_.first_row, grid_.rows, pairs(), setup_.billboard_texels, first, second, choice.blend, {}};
    if (setup_.billboard_texels > 0) {
        billboard.groups[0] = {row_groups(), 3 * pairs(), 1};
        billboard.groups[1] = {FftSize(grid_.n).groups(), 3 * pairs(), 1};
        billboard.groups[2] = {grid_.n / 64, grid_.rows, pairs()};
        c.fill(lit_texels_, 0, 0, sizeof(uint));
        c.barrier();
        c.dispatch_indirect(lit_, {work_, lit_texels_}, billboard, io.gate, entry(gate_splat));
        c.barrier();
        c.dispatch_indirect(billboard_choice_, {lit_texels_, io.gate}, billboard, io.gate, entry(gate_billboard_choice));
        c.barrier();
        c.dispatch_indirect(billboards_, {lit_texels_, billboard_, work_}, billboard, io.gate, entry(gate_billboards));
    }
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
}

void GlareModel::record_apply(StageIo& io, const gpu::Kernel& apply) {
    io.commands.dispatch_indirect(apply, {io.scene, node_exchange_, near_light_, flags_, io.state}, lattice(io), io.gate, entry(gate_apply));
}

}  // namespace entoptic::perception
