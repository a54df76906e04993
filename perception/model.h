// A perception model: what fills a slot. Every model is a group of files in perception/<slot>/ and a row of perception/models.list;
// CMake makes the table below from that list, in pipeline order.
#pragma once

#include "base/image.h"
#include "base/result.h"
#include "gpu/commands.h"
#include "shaders/eye_geometry.h"
#include "shaders/scene_statistics.h"

#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace entoptic::perception {

// One parameter of a model. All parameters are floats; a model's *_params.h struct holds them in this order and nothing else, so that
// a span of values is the struct.
struct ParameterInfo {
    const char* name;
    const char* unit;     // "1" for pure numbers, "bool" for 0/1 switches
    float min, max, default_value;
    const char* source;   // paper and equation, standard, or "choice: why"
    const char* meaning;  // one line for people

    // Within the range as it is stored: bounds such as 0.1 are floats.
    bool allows(double value) const { return static_cast<float>(value) >= min && static_cast<float>(value) <= max; }
};

// One file that a model reads, named by its path. Set like a parameter: slot.name=PATH; an empty path: none.
struct FileInfo {
    const char* name;
    const char* meaning;                                // one line for people
    Result<void> (*check)(const std::string& path);     // errors name the file and what may be in it
};
// Paths by name of the file; what is not set does not appear.
using FilePaths = std::map<std::string, std::string, std::less<>>;

// What the display can show: where tone maps end.
struct DisplayRange {
    float white_cd_m2 = 130;
    float black_cd_m2 = 0.04f;
};

// One eye's input for one frame, already filtered: always finite, pupil within 1.5..9 mm.
struct EyeInput {
    vec3 gaze_direction{0, 0, -1};   // unit, in the axes of the eye image's geometry
    float pupil_diameter_mm = 4;
    float eyelid_open = 1;           // 0 closed .. 1 open
    bool gaze_known = true;          // false: gaze_direction stands in for one that nobody has measured
};

// What changes from frame to frame.
struct FrameInput {
    double dt_s = 0;            // since the frame before; <= 0 or NaN: states do not move
    bool snap = false;          // states jump to their steady state (first frame, stall over 2 s, focus regained)
    std::vector<EyeInput> eyes; // one a view
    std::uint64_t index = 0;    // counts frames; seeds noise
    bool within_display = false;   // known without looking: all light of this frame lies within the display's range (ordinary 8-bit layers)
    bool glanced = false;          // of the scene only the points of glance_point() were written in this frame; the tiles' statistics are theirs
    float vergence_dioptre = -1;    // 1/m: where both lines of sight meet; negative: nobody has measured it
};

// State that models hand to each other, one a view, on the GPU. Scalar layout, shared with GLSL: perception/observer_state.h.
struct ObserverState;

// Indirect dispatches of one model and the outcome of its gate, on the GPU: perception/gate.h.
struct Gate;

// Everything a model may touch while it records one frame. All buffers are storage buffers.
struct StageIo {
    gpu::Commands& commands;
    const gpu::Buffer& scene;        // vec4 a pixel, rows, then views: R, G, B in cd/m² (before `tone` scene light, after it display light),
                                     // w = 0 where the lens shows nothing, else more. Models work in place and keep w.
    const gpu::Buffer& geometry;     // EyeGeometry a view
    const gpu::Buffer& solid_angle;  // float a pixel, rows, then views: sr, 0 where the lens shows nothing
    const gpu::Buffer& tiles;        // TileStatistics a tile, rows, then views; of the scene as the warp wrote it
    const gpu::Buffer& statistics;   // SceneStatistics a view
    const gpu::Buffer& state;        // ObserverState a view; kept between frames
    const gpu::Buffer& gate;         // this model's Gate; zeroed at creation, kept between frames
    std::uint32_t width = 0, height = 0, views = 0;
    std::uint32_t tiles_x = 0, tiles_y = 0;
    DisplayRange display;
    const FrameInput& input;
    const gpu::Buffer* dioptre = nullptr;   // float a pixel, as solid_angle: 1 over the distance from the eye, 1/m; 0 infinity, negative
                                            // unknown. Null when nobody knows a depth in this frame, or no chosen model NeedsDepth.
};

struct ModelContext {
    gpu::Device& device;
    std::vector<EyeGeometry> views;      // all of one size
    DisplayRange display;
    std::uint64_t seed = 1;
    bool repeatable = true;              // work of other threads is waited for, so that two runs give the same bits; false: no frame waits
    // Where `views` are foveated (geometry_foveated): the views that they are images of; else empty.
    std::vector<EyeGeometry> full_views = {};
};

// A model on the GPU.
class Model {
public:
    virtual ~Model() = default;
    // `parameters` as in the entry's list, already checked. Called before the first record() and whenever the user changes one.
    virtual void set_parameters(std::span<const float> parameters) = 0;
    // The files of the entry's list, already checked; called before set_parameters(). On an error what was set before stays.
    virtual Result<void> set_files(const FilePaths&) { return {}; }
    // True when these parameters change nothing for any scene: the model is not recorded at all.
    virtual bool is_identity() const { return false; }
    // True when these parameters leave every picture alone whose light is within the display's range (FrameInput::within_display), once the
    // model's states are at rest: its gate then says that it did not run. Adaptation, which never touches the picture, always does.
    virtual bool obeys_residual_law() const { return false; }
    // Why the model cannot work on a foveated image, as the end of a sentence; empty when it can.
    virtual std::string needs_full_image() const { return {}; }
    // `from` is the same model with the same parameters on another image of the same views: goes on from its states, by copies recorded in
    // `commands`. Models without states of their own (StageIo::state and gates are the stage's) have nothing to do.
    virtual void take_over(gpu::Commands&, Model& /*from*/) {}
    // Records the model for one frame: gate, then work through indirect dispatches, so that a gated frame costs nothing.
    // Every dispatch that depends on an earlier one is preceded by io.commands.barrier(); the stage puts barriers around the model.
    // Errors switch the model off, with the reason in the report; the frame is shown without it.
    virtual Result<void> record(StageIo& io) = 0;
};

// A tone model also says beforehand what it will do: recorded after the adaptation models, before any model changes the picture. Writes
// ObserverState::tone of each view.
class PlansTone {
public:
    virtual ~PlansTone() = default;
    virtual Result<void> plan(StageIo& io) = 0;
};

// What the stage knows of a view from the frame before; zeroes before the first.
struct SceneFeedback {
    double scene_cd_m2 = 0;      // mean luminance of the scene
    double displayed_cd_m2 = 0;  // mean luminance that the panel showed of it
    double area_deg2 = 0;        // of the view
};

// A model that changes what is known of the eyes before the other models hear of it; it records no GPU work.
class AdjustsEyes {
public:
    virtual ~AdjustsEyes() = default;
    // `feedback` of each view. Leaves finite values within the ranges of EyeInput.
    virtual void adjust(FrameInput& input, std::span<const SceneFeedback> feedback) = 0;
};

// A model that acts late on states driven by the light on the retina: recorded just before the tone models, when the picture is that
// light. Reads the scene only.
class ObservesRetina {
public:
    virtual ~ObservesRetina() = default;
    virtual Result<void> observe(StageIo& io) = 0;
};

// A model that reads StageIo::dioptre. Only while such a model is chosen and does something is depth kept and computed.
class NeedsDepth {
public:
    virtual ~NeedsDepth() = default;
};

// The same model in double precision by an independent, slow and obvious algorithm. Works on whole images, one view.
struct ReferenceFrame {
    ImageD image;                  // RGB, cd/m²; in place
    EyeGeometry geometry;
    DisplayRange display;
    EyeInput eye;
    double dt_s = 0;
    bool snap = false;
    double adaptation_cd_m2 = 0;   // state, in and out: written by `adaptation`, read by others
    std::uint64_t seed = 1;
    // The tone curve of this frame, written by the tone model's plan(); see ToneCurve.
    double exposure = 1, scene_white_cd_m2 = 130;
    std::function<double(double)> displayed = nullptr;   // displayed of scene luminance, cd/m²; empty: no tone model
    ImageD dioptre{};              // one channel, as StageIo::dioptre; empty: no depth is known
    double vergence_dioptre = -1;  // as FrameInput's
    double focus_dioptre = -1;     // state, in and out: written by `dof`; negative before the first known depth
};
class ReferenceModel {
public:
    virtual ~ReferenceModel() = default;
    virtual void apply(ReferenceFrame& frame, std::span<const float> parameters) = 0;
    virtual Result<void> set_files(const FilePaths&) { return {}; }
    // As PlansTone::plan() and ObservesRetina::observe().
    virtual void plan(ReferenceFrame&, std::span<const float>) {}
    virtual void observe(ReferenceFrame&, std::span<const float>) {}
    virtual bool observes_retina() const { return false; }
};

struct ModelEntry {
    std::string_view slot, name;
    std::string_view summary;                          // one line for `entoptic effects`
    std::span<const ParameterInfo> parameters;
    Result<std::unique_ptr<Model>> (*create)(const ModelContext&);
    std::unique_ptr<ReferenceModel> (*create_reference)();
    std::span<const FileInfo> files = {};
};

// Whether any model of the slot reads a file of this name.
bool names_file(std::string_view slot, std::string_view name);
// All models, in pipeline order (generated from models.list).
std::span<const ModelEntry* const> models();
// Null when there is none.
const ModelEntry* find_model(std::string_view slot, std::string_view name);
// Slots in pipeline order, each once.
std::vector<std::string_view> slots();

std::vector<float> default_parameters(const ModelEntry& entry);

}  // namespace entoptic::perception
