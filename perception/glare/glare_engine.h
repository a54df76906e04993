// The engine of all glare models: convolution of a picture's light with kernels of any width, on the sphere. A model says what the kernels
// are (GlareSetup, made when parameters change; their weights, by pupil) and which light each of them scatters (GlareTerm); everything
// per frame is done here:
//   gate; pixels -> nodes -> texels of an equi-angular grid; transform, product, transform; texels -> nodes -> pixels; near field in space.
// Kernels stand at multiples of rebuild_mm of the pupil's diameter, and what lies between is interpolated: a pupil that moves cannot flash.
//
// A kernel is round and given by its profile, unless the model overrides record_far_kernel(): then the profile serves the near field only.
#pragma once

#include "perception/glare/glare.h"
#include "perception/glare/glare_gpu.h"
#include "perception/glare/glare_grid.h"

#include <algorithm>
#include <cstring>
#include <functional>
#include <optional>
#include <string>

namespace entoptic::perception {

// Pupils are taken from 1 to 9 mm.
constexpr double smallest_pupil_mm = 1, typical_pupil_mm = 4, largest_pupil_mm = 9;
// Reach of the near field of the light that was drawn, times near_px: a halo is smoother than a source.
constexpr double drawn_near_share = 0.75;
// Largest share of the light that may leave its pixel.
constexpr double most_scattered = 0.9;

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

using RadialProfile = std::vector<RadialEntry>;

// `entry` of each angle (rad) of a profile.
RadialProfile make_profile(const std::function<RadialEntry(double)>& entry);
// What a part of a profile scatters farther than `from_rad`, a share of the light, by channel; of the sizes where a kernel has both signs.
glm::dvec3 scattered_beyond(const RadialProfile& profile, uint part, double from_rad);

// How a workgroup of 256 invocations takes lines of n = 64, 128, 256 or 512 values: specialization of glare_rows.comp and glare_columns.comp.
struct FftSize {
    uint n;
    explicit FftSize(uint texels) : n(texels) {}
    uint lines() const { return 256 / (n / 8); }
    uint groups() const { return n / lines(); }  // for n lines
    std::vector<std::uint32_t> specialization(uint mode) const { return {mode, n, n / 8, lines()}; }
};

// One convolution. Those of all sources but `source_drawn` see the same picture and are added; one of `source_drawn` comes last.
struct GlareTerm {
    uint source = source_scene;  // see glare_gpu.h. Light of source_excess stays in its place, too; other light leaves it
    uint kernel = 0;
    float sign = 1;
    bool near = true;  // with a near field; source_displayed cannot have one. That of source_drawn is narrower, and only where another term's is
    uint turn = 0;     // channel c takes the source's channel (c + turn) mod 3
    uint zone = 0;     // of GlareSetup::zones, each with a kernel of its own
};

// Terms of an eye in the scene, seen by a wearer in front of a panel. `photographic`: the whole scene is scattered by kernel 0. Else the wearer's
// own eye already scatters what the panel sends, and what is left is
//   the light that the panel cannot send, scattered by the person's eye (kernel 0),
//   less what the wearer's eye (`wearer`) scatters of what this draws: `rescatter` of it,
//   and, where they differ, the displayed light scattered by the person's eye (`persons`, again) less that scattered by the wearer's (the next, again).
// Kernels with and without a near field are not the same on the grid: hence "again".
// The displayed light has no near field.
std::vector<GlareTerm> observer_terms(bool photographic, float rescatter, uint wearer, std::optional<uint> persons);

struct GlareSetup {
    std::vector<RadialProfile> kernels;
    std::vector<GlareTerm> terms;
    float texel_px = 4;                 // least width of a texel of the grid, pixels
    uint least_texels = least_glare_n;  // of a side of the grid, which is as small as texel_px allows
    float near_px = 8;                  // radius of the near field, pixels; below 1: none
    float near_from = 0;                // source_scene: light above this many times the adaptation luminance has a near field
    float rebuild_mm = 0.2f;            // distance of the kernels' pupil diameters; 0: the pupil does not matter
    float window_sigma_deg = 0;         // Gaussian window around the gaze; 0: whole field
    vec3 gain{1};                       // energy of the whole kernel; not 1 for a kernel with a colour cast
    uint zones = 1;                     // parts of the view from left to right, blended: a term scatters the light of its zone
    uint billboard_texels = 0;          // up to so many lit texels of the grid the kernel is drawn at each of them, else by transforms
    bool smooth = true;     // beyond the near field kernels have no detail as fine as a texel
    bool positive = false;  // what arrives is cut off at 0: for kernels with streaks, which the grid sharpens; not for signed ones
    bool sigmoid = false;   // what is scattered is drawn through tumblin_sigmoid(), and nothing leaves its place
};

class GlareModel : public Model {
public:
    Result<void> record(StageIo& io) final;

protected:
    explicit GlareModel(const ModelContext& context) : context_(context) {}
    // Called by create() of the model.
    Result<void> make_kernels();
    // Called by set_parameters() of the model.
    void parameters_changed() { prepared_ = false; }

    virtual GlareSetup setup() = 0;
    // Of the parts of a kernel's profile. Lowered here where more than 0.9 of the light would leave its pixel and the direct light turn negative.
    virtual glm::dvec3 weights(uint kernel, double pupil_mm) const = 0;

    // For kernels that are not round. prepare_far() makes buffers after setup(), record_first() fills them; both once per parameter set.
    // record_far_kernel() writes a kernel to work(), as glare_kernel.comp does, and says true. `steps`: see KernelChoice.
    virtual Result<void> prepare_far() { return {}; }
    virtual void record_first(StageIo&) {}
    virtual bool record_far_kernel(StageIo&, uint /*kernel*/, long /*steps*/) { return false; }
    // Forward transform of whole planes of glare_n^2 values of work(), from the first on.
    void record_transform(gpu::Commands& commands, uint planes);
    const gpu::Buffer& work() const { return work_; }
    // Of passes that draw a kernel into work(), 64 texels a workgroup.
    gpu::Groups kernel_groups() const { return {grid_.n / 64, grid_.n, 1}; }

    // The two built kernels between which the eye is: by default diameters in steps of rebuild_mm. Kernels of even and odd steps are kept.
    struct KernelChoice {
        long first = 0, second = 0;
        float blend = 0;  // 0: first .. 1: second
    };
    virtual KernelChoice choose_kernel(const StageIo& io);
    double diameter_mm(long steps) const {
        return setup_.rebuild_mm > 0 ? std::max(static_cast<double>(steps) * static_cast<double>(setup_.rebuild_mm), 0.5) : 4;
    }
    // Upper bound of the share of the light that leaves its pixel, for the gate.
    virtual double scattered(uint kernel, KernelChoice choice) const;
    // The near field of a term, into near_light() of the tiles in near_tiles(); `add`: to what is there.
    virtual void record_near(StageIo& io, const GlareTerm& term, KernelChoice choice, bool add);
    const gpu::Buffer& near_tiles() const { return near_tiles_; }
    const gpu::Buffer& near_light() const { return near_light_; }
    float near_from() const { return near_source() == source_excess ? -1.0f : setup_.near_from; }
    uint work_planes() const { return 3 * pairs(); }

    struct Wanted {
        gpu::Kernel* kernel;
        const char* name;
        std::span<const std::uint32_t> spirv;
        std::uint32_t buffers, push_bytes;
        std::vector<std::uint32_t> specialization;
    };
    Result<void> make_kernel(const Wanted& w);
    Result<void> make_buffer(gpu::Buffer& buffer, std::size_t bytes, const char* name);
    template <class T> Result<void> make_static(StaticBuffer& to, const std::vector<T>& data, const char* name) {
        ENTOPTIC_TRY(made, StaticBuffer::create(context_.device, data, name));
        to = std::move(made);
        return {};
    }

    float near_rad(uint kernel) const { return near_rad_[kernel]; }  // the near field of a kernel ends here
    // Parts of a kernel's profile (glare_split.h) in profiles(): first entries. Their weights: at most 0.9 of all light is scattered.
    uint near_profile(uint kernel) const { return 2 * kernel * radial_entries; }
    uint far_profile(uint kernel) const { return (2 * kernel + 1) * radial_entries; }
    const gpu::Buffer& profiles() const { return profiles_.buffer; }
    glm::dvec3 safe_weights(uint kernel, double pupil_mm) const;
    double smallest_step() const { return grid_.smallest_step; }
    double pitch() const { return grid_.pitch; }
    const ModelContext context_;

private:
    Result<void> prepare();
    Result<void> make_buffers();
    Result<void> make_profiles();
    Result<void> make_sized_passes();
    void record_coverage(StageIo& io);
    void record_kernel(StageIo& io, uint kernel, long steps);
    NearPush near_push(const StageIo& io, const GlareTerm& term, KernelChoice choice, bool add) const;
    void record_near_drawn(StageIo& io, const GlareTerm& term, KernelChoice choice);
    void record_node_coverage(StageIo& io, uint kernel, uint key);
    void record_zone(StageIo& io, const gpu::Buffer& nodes, uint zone, std::size_t first, bool gated);
    void record_billboard(StageIo& io, uint key);
    Result<void> make_billboard_buffers();
    void record_scattered(StageIo& io, const GlareTerm& term, KernelChoice choice);
    void record_gate(StageIo& io, KernelChoice choice);
    void record_far(StageIo& io, const GlareTerm& term, KernelChoice choice, bool add);
    void record_apply(StageIo& io, const gpu::Kernel& apply);

    glm::dvec3 blended(uint kernel, KernelChoice choice) const;
    bool has_near_field(uint kernel) const;
    float widest_near_rad(uint kernel) const;
    bool near_field() const { return setup_.near_px >= 1 && (near_source() == source_scene || near_source() == source_excess); }
    uint near_source() const;
    bool has(uint source) const;
    bool leaves(const GlareTerm& term) const { return term.source != source_excess; }
    uint key_of(uint kernel, long steps) const { return 2 * kernel + static_cast<uint>(steps & 1); }
    uint pairs() const { return static_cast<uint>(grid_.patches.size() + 1) / 2; }
    uint nodes() const { return grid_.nodes_x * grid_.nodes_y; }
    float window_sigma_rad() const;
    LatticePush lattice(const StageIo& io, uint turn = 0) const {
        return {io.width, io.height, grid_.nodes_x, grid_.nodes_y, grid_.step, io.tiles_x, io.tiles_y, near_field() ? 1u : 0u, turn};
    }
    uint row_groups() const { return gpu::groups_for(grid_.rows, FftSize(grid_.n).lines()); }
    FftPush all_rows() const { return {0, grid_.n, 3, 0, 0, 0, 0, 0}; }
    FftPush light_rows() const { return {grid_.first_row, grid_.rows, 3, 0, 0, 0, 0, 0}; }

    GlareSetup setup_;
    bool prepared_ = false, first_recorded_ = false;
    GlareGrid grid_;
    float grid_texel_px_ = 0;
    std::vector<glm::dvec3> shares_;          // by kernel: share of the light that leaves its pixel by each part of weight 1
    std::vector<float> near_rad_;             // by kernel, and
    std::vector<bool> capped_;                // whether its far part is a cap
    std::vector<std::optional<long>> built_;  // by key: diameter (in steps) of the kernel there

    gpu::Kernel gate_, tiles_, coverage_, splat_, rows_transform_, columns_transform_, rows_forward_, rows_inverse_, columns_convolve_,
        columns_kernel_, gather_coverage_, gather_veil_, near_, near_drawn_, kernel_kernel_, apply_, apply_drawn_;
    gpu::Kernel pixels_[4];  // by source
    gpu::Kernel zone_, lit_, billboard_choice_, billboard_kernel_, billboards_;
    StaticBuffer delta_rows_;
    gpu::Buffer lit_texels_, billboard_;
    StaticBuffer twiddle_, taps_, splat_offsets_, splat_entries_, profiles_;
    gpu::Buffer work_, coverage_rows_, spectra_, node_values_, node_exchange_, node_coverage_, near_tiles_, flags_, near_light_;
};

}  // namespace entoptic::perception
