// fraunhofer_mask on the GPU: kernels that are not round, for the engine in glare_engine.h. What is done when:
//   parameters or files change    nothing but forgetting
//   pupil or lids cross a step    aperture, transform and table on the CPU in a thread of their own (fraunhofer_mask_tables.h)
//   a table is ready              to the GPU; the kernel on the grid; from the old one to it within fade_s
#include "perception/glare/fraunhofer_mask_gpu.h"
#include "perception/glare/fraunhofer_mask_math.glsl"
#include "perception/glare/fraunhofer_mask_tables.h"
#include "perception/glare/glare_engine.h"

#include "perception/glare/fraunhofer_mask_kernel.comp.h"
#include "perception/glare/fraunhofer_mask_near.comp.h"

#include <cmath>

namespace entoptic::perception {
namespace {

using namespace fraunhofer_mask;

constexpr ParameterInfo parameters[] = {
    {"strength", "1", 0, 10, 1, "choice: 1 is physical", "times the diffracted light; at most 0.9 of all light is diffracted"},
    {"blades", "1", 0, 32, 0, "Kakimoto 2004, figure 5f", "corners of a diaphragm in the pupil's place; under 3: the round pupil"},
    {"blade_rotation_deg", "deg", -180, 180, 0, "choice", "of the diaphragm's first corner from the right, counter-clockwise"},
    {"lashes", "1", 0, 100, 40, "choice: 30 to 60 stand before a half-closed pupil", "eyelashes on 10 mm of the upper lid; 0: none"},
    {"lash_width_mm", "mm", 0.02f, 0.5f, 0.08f, "choice: 0.05 to 0.1 mm", "their thickness"},
    {"lash_length_mm", "mm", 0.5f, 15, 8, "choice: lashes of adults are 8 to 12 mm long", "their length"},
    {"lash_curl", "1", 0, 1, 0.3f, "choice", "0: hang straight from the closed eye's lid; 1: come up to it again, as those of an open eye do"},
    {"lash_seed", "1", 0, 1e6f, 1, "choice", "of the small differences between lashes"},
    {"lids", "bool", 0, 1, 1, "Kakimoto 2004, figure 5a", "1: the eyelids stop light; they open as the eye's do"},
    {"lid_open", "1", 0, 1, 1, "choice", "times the opening of the eye's lids"},
    {"filter_directions", "1", 0, 8, 0, "Kakimoto 2004, figure 5d and e: 2 and 3", "directions of the lines of a cross-screen filter; 0: no filter"},
    {"filter_spacing_mm", "mm", 0.05f, 10, 0.8f, "choice", "between its lines"},
    {"filter_width_mm", "mm", 0.01f, 5, 0.04f, "choice", "of its lines"},
    {"filter_rotation_deg", "deg", -180, 180, 20, "choice", "of its lines, counter-clockwise"},
    {"mask_width_mm", "mm", 0.1f, 100, 8, "choice: the widest pupil", "full width of the picture `mask`"},
    {"obstacle_mm", "mm", 0, 25, 15, "choice: 5 to 25 mm; the paper gives none", "from the pupil forward to lashes, lids, filter and picture"},
    {"zones", "1", 1, 5, 1, "Kakimoto 2004, section 4.3: by the source's x", "parts of the view, each with the obstacles as its light meets them; time goes with it"},
    {"wavelengths", "1", 3, 64, 16, "choice: midpoints of 400..700 nm, where the eye sees", "samples of the spectrum"},
    {"three_lines", "bool", 0, 1, 0, "Kakimoto 2004, section 3.2; trap K2", "1: the paper's 680, 530 and 460 nm"},
    {"pupil_step_mm", "mm", 0.05f, 1, 0.25f, "choice: a streak's length goes with lambda / D", "distance of the pupil diameters at which kernels are built"},
    {"lid_steps", "1", 2, 64, 16, "choice: 0.6 mm of opening", "openings of the lids at which kernels are built"},
    {"texel_px", "px", 1, 16, 4, "choice: p99 dE_ITP 0.3 on a whole picture", "least width of a texel of the grid on which far light is computed"},
    {"near_px", "px", 0, max_near_px, 12, "choice: streaks are a pixel wide only in the near field", "radius of the near field, done at full resolution"},
    {"billboard_texels", "1", 0, 256, 40, "choice: about 50 sources cost one transform", "up to so many lit texels the kernel is drawn at each; 0: always by transforms"},
    {"sigmoid", "bool", 0, 1, 0, "Kakimoto 2004, eq. 7; trap K3", "1: the veil is laid over the picture through the paper's tone curve"},
    {"photographic", "bool", 0, 1, 0, "choice: the residual law", "1: all light of the scene is diffracted; 0: only what the panel cannot show"},
};
static_assert(sizeof(FraunhoferMaskParams) == sizeof(float) * std::size(parameters));

constexpr float fade_s = 0.05f;      // choice: half of the time in which a blink closes

class FraunhoferMask final : public GlareModel {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<FraunhoferMask>(context);
        ENTOPTIC_CHECK(model->make_kernels());
        ENTOPTIC_CHECK(model->make_kernel({&model->mask_kernel_, "glare.mask_kernel", fraunhofer_mask_kernel_comp_spv, 2, sizeof(MaskKernelPush), {}}));
        ENTOPTIC_CHECK(model->make_kernel({&model->mask_near_, "glare.mask_near", fraunhofer_mask_near_comp_spv, 6, sizeof(MaskNearPush), {}}));
        return model;
    }
    explicit FraunhoferMask(const ModelContext& context) : GlareModel(context) {}

    void set_parameters(std::span<const float> values) override {
        std::memcpy(&params_, values.data(), sizeof params_);
        parameters_changed();
    }
    Result<void> set_files(const FilePaths& files) override {
        std::shared_ptr<const MaskPicture> picture;
        if (const auto mask = files.find("mask"); mask != files.end()) {
            ENTOPTIC_TRY(read, read_mask_picture(mask->second));
            picture = std::move(read);
        }
        picture_ = std::move(picture);
        parameters_changed();
        return {};
    }
    bool is_identity() const override { return params_.strength <= 0; }
    std::string needs_full_image() const override { return "draws streaks a pixel wide, by the direction of their light in the view"; }

private:
    // A table and its number: even and odd ones have places of their own on the GPU.
    struct Shown {
        long number = 0;
        std::shared_ptr<const MaskTables> tables;
    };

    GlareSetup setup() override;
    glm::dvec3 weights(uint, double) const override { return {1, 0, 0}; }      // not of a profile
    double scattered(uint kernel, KernelChoice choice) const override;
    Result<void> prepare_far() override;
    KernelChoice choose_kernel(const StageIo& io) override;
    bool record_far_kernel(StageIo& io, uint kernel, long number) override;
    void record_near(StageIo& io, const GlareTerm& term, KernelChoice choice, bool add) override;

    MaskKey key_of_eyes(const StageIo& io) const;
    void show(std::shared_ptr<const MaskTables> tables, bool at_once);
    uint zones() const { return static_cast<uint>(std::max(std::lround(params_.zones), 1l)); }
    bool photographic() const { return params_.photographic > 0.5f; }
    double share_diffracted(const MaskTables& tables) const;
    double safe_strength(const MaskTables& tables) const;
    uint first_entry(long number) const { return static_cast<uint>(number & 1) * zones() * mask_entries; }

    FraunhoferMaskParams params_{};
    std::shared_ptr<const MaskPicture> picture_;
    Shown now_, next_;                     // next_.tables is null when nothing changes
    float faded_ = 0;                      // from now_ to next_
    gpu::Kernel mask_kernel_, mask_near_;
    gpu::Buffer table_;                    // parity, zone, entry
    std::vector<gpu::Buffer> staging_;     // parity, zone
    MaskTableMaker maker_;
};

GlareSetup FraunhoferMask::setup() {
    maker_.configure(params_, picture_);
    now_ = next_ = {};
    faded_ = 0;
    GlareSetup setup;
    setup.kernels.resize(zones());
    for (uint z = 0; z < zones(); ++z) setup.terms.push_back({photographic() ? source_scene : source_excess, z, 1, true, 0, z});
    setup.zones = zones();
    setup.texel_px = params_.texel_px;
    setup.near_px = params_.near_px;
    setup.positive = true;
    setup.smooth = false;
    setup.billboard_texels = static_cast<uint>(std::lround(params_.billboard_texels));
    setup.sigmoid = params_.sigmoid > 0.5f;
    return setup;
}

Result<void> FraunhoferMask::prepare_far() {
    constexpr std::size_t bytes = mask_entries * sizeof(vec3);
    ENTOPTIC_CHECK(make_buffer(table_, 2 * zones() * bytes, "glare.mask_table"));
    staging_.clear();
    for (uint i = 0; i < 2 * zones(); ++i) {
        ENTOPTIC_TRY(staging, gpu::Buffer::create(context_.device, bytes, gpu::BufferKind::upload, "glare.mask_table.staging"));
        staging_.push_back(std::move(staging));
    }
    return {};
}

double FraunhoferMask::share_diffracted(const MaskTables& tables) const {
    double share = 0;
    for (const auto& table : tables.zones) share = std::max(share, diffracted_beyond(table, 0.5 * smallest_step()));
    return std::min(share, 1.0);
}
double FraunhoferMask::safe_strength(const MaskTables& tables) const {
    return std::min(static_cast<double>(params_.strength), most_scattered / std::max(share_diffracted(tables), 1e-9));
}

double FraunhoferMask::scattered(uint, KernelChoice) const {
    double most = 0;
    for (const Shown* shown : {&now_, &next_})
        if (shown->tables) most = std::max(most, safe_strength(*shown->tables) * share_diffracted(*shown->tables));
    return most;
}

// Both eyes see through one kernel: pupils and lids move together.
MaskKey FraunhoferMask::key_of_eyes(const StageIo& io) const {
    double pupil = 0, open = 0;
    int valid = 0;
    for (const EyeInput& eye : io.input.eyes)
        if (eye.pupil_diameter_mm >= 0.5f && eye.pupil_diameter_mm <= 20 && eye.eyelid_open >= 0 && eye.eyelid_open <= 1) {      // false for NaN
            pupil += static_cast<double>(eye.pupil_diameter_mm);
            open += static_cast<double>(eye.eyelid_open);
            ++valid;
        }
    if (valid == 0) return mask_key(params_, 4, 1);
    return mask_key(params_, std::clamp(pupil / valid, smallest_pupil_mm, largest_pupil_mm), open / valid);
}

void FraunhoferMask::show(std::shared_ptr<const MaskTables> tables, bool at_once) {
    if (!now_.tables || at_once) {
        if (now_.tables != tables) now_ = {now_.number + (next_.tables ? 2 : 1), std::move(tables)};
        next_ = {};
    } else if (!next_.tables && now_.tables != tables) {
        next_ = {now_.number + 1, std::move(tables)};
        faded_ = 0;
    }
}

GlareModel::KernelChoice FraunhoferMask::choose_kernel(const StageIo& io) {
    const float dt_s = io.input.dt_s > 0 ? static_cast<float>(io.input.dt_s) : 0.0f;
    if (next_.tables && (faded_ += dt_s / fade_s) >= 1) now_ = std::exchange(next_, {});
    if (auto tables = maker_.tables(key_of_eyes(io), context_.repeatable || io.input.snap || !now_.tables)) show(std::move(tables), io.input.snap);
    return next_.tables ? KernelChoice{now_.number, next_.number, faded_} : KernelChoice{now_.number, now_.number, 0};
}

bool FraunhoferMask::record_far_kernel(StageIo& io, uint zone, long number) {
    const MaskTables& tables = number == now_.number ? *now_.tables : *next_.tables;
    const uint at = static_cast<uint>(number & 1) * zones() + zone;
    std::memcpy(staging_[at].bytes().data(), tables.zones[zone].data(), staging_[at].size());
    io.commands.copy(staging_[at], table_, staging_[at].size(), 0, at * staging_[at].size());
    io.commands.barrier();
    const MaskKernelPush push{static_cast<float>(pitch()), near_rad(zone), static_cast<float>(safe_strength(tables)), at * mask_entries};
    io.commands.dispatch(mask_kernel_, {table_, work()}, push, kernel_groups());
    return true;
}

// All zones at once: each tile has its own kernel.
void FraunhoferMask::record_near(StageIo& io, const GlareTerm& term, KernelChoice choice, bool) {
    if (term.kernel != 0) return;
    const MaskNearPush push{io.width, io.height, io.tiles_x, io.tiles_y, zones(), first_entry(choice.first), first_entry(choice.second), choice.blend,
                            static_cast<float>(safe_strength(*now_.tables)), near_rad(0), near_from(), photographic() ? 1u : 0u};
    io.commands.dispatch_indirect(mask_near_, {io.scene, io.state, near_tiles(), io.geometry, table_, near_light()}, push, io.gate,
                                  offsetof(Gate, dispatch) + gate_near * sizeof(GateDispatch));
}

Result<void> check_mask(const std::string& path) {
    ENTOPTIC_TRY(picture, read_mask_picture(path));
    (void)picture;
    return {};
}
constexpr FileInfo files[] = {
    {"mask", "picture of what stands before the pupil (.png or .exr): transmission factor of amplitude, grey value times alpha", &check_mask},
};

}  // namespace

std::unique_ptr<ReferenceModel> make_fraunhofer_mask_reference();

extern const ModelEntry fraunhofer_mask_entry;
const ModelEntry fraunhofer_mask_entry{"glare",    "fraunhofer_mask", "Diffraction by eyelashes, lids, diaphragms, filters or any mask (Kakimoto 2004)",
                                       parameters, &FraunhoferMask::create, &make_fraunhofer_mask_reference, files};

}  // namespace entoptic::perception
