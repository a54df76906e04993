// One frame on one screen: what it is made from, and the path from submitted layers to panel codes. The stages of the path are collect,
// predict, warp, perceive, lens, panel and present; these are also the labels of its times and the names of its dumps.
#pragma once

#include "compositor/depth_pass.h"
#include "compositor/layer_views.h"
#include "compositor/passes.h"
#include "interfaces/headset.h"
#include "interfaces/layers.h"
#include "interfaces/observer.h"
#include "interfaces/vergence.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace entoptic::compositor {

// Everything that a frame's picture depends on, but for the pixels of its images and the state of perception. A plain value.
struct FrameDescription {
    static constexpr std::uint32_t current_version = 1;
    std::uint32_t version = current_version;
    std::uint64_t index = 0;            // counts compositions, from 0; seeds noise and names dumps
    std::uint64_t frame_id = 0;         // of the FrameSubmission
    bool reprojected = false;           // this submission was shown before
    TimeNs predicted_display_time = 0;  // what the application was told
    TimeNs submitted_time = 0;
    TimeNs pose_time = 0;     // when the poses were sampled
    TimeNs display_time = 0;  // middle of the light this composition is made for: poses and observer are of this time
    Pose world_from_head;
    std::array<Pose, eye_count> head_from_eye;
    std::vector<Layer> layers;
    Observer observer;
    perception::FrameInput perception;  // time step, and the observer in the axes of each eye
};

// The predict stage: where head and eyes will be at `display_time`, asked of the headset at `now`. `last_display_time` is the time of the
// composition before, 0 for none: FrameInput::snap after more than 2 s.
void predict(FrameDescription& frame, Headset& headset, TimeNs now, TimeNs display_time, TimeNs last_display_time);

struct FramePathOptions {
    PictureSize panel;     // of one eye, pixels
    double eye_scale = 1;  // size of the eye image over the panel's, 0.05..2
    std::array<EyeOptics, eye_count> eyes;
    perception::DisplayRange display;
    MeasuredPanels measured;  // null: a nominal panel. Else frames go the long way, and codes are not passed through
    perception::Selection selection;  // no choices: nothing is simulated
    LensFilter lens_filter = LensFilter::catmull_rom;
    bool dither = true;
    bool fuse = true;  // one pass where nothing is simulated; false always takes the long way
    std::uint64_t seed = 1;
    bool repeatable = true;  // lockstep: see perception::ModelContext
    const Clock* stopwatch = nullptr;  // for CPU times; null leaves them out
};

// Pictures a caller wants of a frame, besides the panel's codes.
struct WantedPictures {
    bool warp = false, perceive = false, lens = false, panel = false, seen = false;
    bool any() const { return warp || perceive || lens || panel || seen; }
    bool needs_stages() const { return warp || perceive || lens; }  // that the fused pass does not have
};

struct StageMs {
    std::string name;
    double ms = 0;
};

// What became of a frame.
struct FrameOutcome {
    bool fused = false;
    bool ordinary = false;  // models were chosen, but all light was known to be within the panel's range: nothing to simulate
    std::vector<StageMs> gpu_ms, cpu_ms;  // by stage, in order
    std::vector<perception::EffectOutcome> effects;
    std::array<perception::ViewOutcome, eye_count> views;  // zeroes where nothing was simulated, but for `cleaned`
    std::string problem;                                   // a layer that could not be shown; empty when well
};

class FramePath {
public:
    static Result<std::unique_ptr<FramePath>> create(gpu::Device& device, const FramePathOptions& options);
    ~FramePath();

    // Composes one frame and waits for the GPU. `images` holds the images of the layers until then.
    // Layers that cannot be shown are left out (FrameOutcome::problem); other errors leave the panel as it was.
    Result<FrameOutcome> compose(const FrameDescription& frame, const ImageUse& images, const WantedPictures& wanted = {});

    // The panel's codes, for display targets. Valid between calls of compose().
    PanelCodes panel() const { return {&codes_, options_.panel}; }
    // Codes of what the eyes see through the lenses, for display targets: record and read within one batch.
    Result<const SeenThroughLensPass*> record_seen(gpu::Commands& commands);

    // Pictures of the frame composed last, as far as they were wanted then. RGB, cd/m².
    ImageF warp_picture(int eye) const;
    ImageF perceive_picture(int eye) const;
    ImageF lens_picture(int eye) const;
    Image8 panel_picture(int eye) const;  // RGB codes
    Image8 seen_picture(int eye) const;

    Result<void> select(const perception::Selection& selection);
    const FramePathOptions& options() const { return options_; }
    PictureSize eye_size() const { return eye_size_; }
    perception::Stage* stage() { return stage_.get(); }  // null until something is simulated or its stages are wanted

private:
    explicit FramePath(gpu::Device& device, const FramePathOptions& options) : device_(device), options_(options) {}
    class CpuTimes;
    struct Download {
        gpu::Buffer buffer;
        bool filled = false;
    };

    Result<void> allocate();
    Result<void> ensure_stages();
    std::string collect(const FrameDescription& frame, const ImageUse& images, bool with_depth);
    Result<void> collect_depth(const Layer& layer, int eye, const EyePlace& place, const ImageUse& images, const SampledImage& colour);
    void transfer_images(bool acquire);
    Result<void> record(const FrameDescription& frame, const WantedPictures& wanted, const FrameOutcome& path, CpuTimes& times);
    Result<void> record_fused(const FrameDescription& frame, bool ordinary, CpuTimes& times);
    Result<void> record_stages(const FrameDescription& frame, const WantedPictures& wanted, CpuTimes& times);
    Result<void> download(const gpu::Buffer& from, Download& into, const char* name);
    PanelCurve curve(const FrameDescription& frame) const;
    // The frame's light is within the panel's range, and no state of the eye changes how it is seen.
    bool is_ordinary() const;
    ImageF eye_picture(const Download& download, int eye) const;
    Image8 code_picture(const Download& download, PictureSize size, int eye) const;

    gpu::Device& device_;
    FramePathOptions options_;
    PictureSize eye_size_;
    std::array<EyeGeometry, eye_count> panel_geometry_{}, eye_geometry_{};
    gpu::Commands commands_;
    LayerTable layers_;
    gpu::Buffer codes_;
    FusedPass fused_;
    std::unique_ptr<perception::Stage> stage_;
    std::optional<WarpPass> warp_;
    std::optional<GlancePass> glance_;
    std::optional<DepthPass> depth_;  // made when a model first wants depth
    std::optional<LensPass> lens_;
    std::optional<MeasuredPanelPass> measured_;
    std::optional<SeenThroughLensPass> seen_;
    Download warp_download_, perceive_download_, lens_download_, panel_download_, seen_download_;
};

}  // namespace entoptic::compositor
