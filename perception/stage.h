// The perception stage: scene luminance in, the light the panel should send out, in place. Runs the chosen models in pipeline order on
// all views of a frame at once. Knows nothing of OpenXR, swapchains or devices.
#pragma once

#include "perception/model.h"
#include "perception/preset.h"

#include <map>
#include <optional>
#include <string>

namespace entoptic::perception {

class Foveation;

struct StageOptions {
    std::vector<EyeGeometry> views;    // 1 or more, all of one size
    DisplayRange display;
    Selection selection;
    std::uint64_t seed = 1;
    bool repeatable = true;            // see ModelContext
    std::vector<EyeGeometry> full_views = {};   // see ModelContext
};

// What one model did in one frame.
struct EffectOutcome {
    std::string slot, model;
    bool recorded = false;      // work was recorded (else: identity parameters, or it failed before)
    bool gated = false;         // recorded, but the GPU found that it cannot be seen in this frame
    std::string failed;         // why it was switched off; empty when well
    std::string why;            // one plain sentence
    float bound_codes = 0;      // largest displayed change that gating may have caused
};

// After a frame: what is known of each view.
struct ViewOutcome {
    float adaptation_cd_m2 = 0, target_cd_m2 = 0;
    float min_y = 0, max_y = 0, mean_y = 0;
    std::uint32_t cleaned = 0;      // pixels that held NaN, infinity, negatives or more than 1e8 cd/m²
};

class Stage {
public:
    static Result<std::unique_ptr<Stage>> create(gpu::Device& device, const StageOptions& options);
    ~Stage();

    // The eye image: vec4 a pixel (R, G, B in cd/m², w see scene_pixel() in shaders/tile_statistics.glsl), rows, then views. The warp (or
    // ingest) writes it, then record() reduces its statistics and turns it into display light, in place.
    const gpu::Buffer& scene() const { return scene_; }
    // Solid angle of each pixel, float, sr; 0 where the lens shows nothing. Constant.
    const gpu::Buffer& solid_angle() const { return solid_angle_; }
    const gpu::Buffer& geometry() const { return geometry_; }
    std::uint32_t width() const { return width_; }
    std::uint32_t height() const { return height_; }
    std::uint32_t views() const { return views_; }
    std::uint32_t tiles_x() const { return gpu::groups_for(width_, tile_width); }
    std::uint32_t tiles_y() const { return gpu::groups_for(height_, tile_height); }
    // Whether a chosen model wants to know how far away things are. Then whoever writes the scene may also write depth() (float a pixel, laid
    // out as solid_angle(): 1/m, 0 infinity, negative unknown) and says so with depth_written(), for this frame. Nothing is kept otherwise.
    bool wants_depth() const;
    const gpu::Buffer& depth() const { return dioptre_; }
    void depth_written() { has_depth_ = true; }
    std::size_t view_bytes() const { return std::size_t(width_) * height_ * sizeof(vec4); }

    // For pictures that come from the CPU: uploads RGB (one image a view, of the stage's size, any values) and records the pass that
    // cleans it and writes the scene. Waits for nothing; call before record() in the same batch. `depths`: none, or one image a view, one
    // channel, metres from the eye along the line of sight; infinity is far, NaN, zero and negatives are unknown.
    Result<void> record_ingest(gpu::Commands& commands, std::span<const ImageF> images, std::span<const ImageF> depths = {});
    // The eyes have been adapted to this luminance (cd/m²) until now: the state before the next frame. Call between frames.
    void set_adaptation(float cd_m2);
    // Records statistics and all models. The scene must have been written earlier in the same batch, with a barrier() after it.
    // Each model is a stage of `commands` ("perceive.glare"). Leaves a barrier behind.
    void record(gpu::Commands& commands, const FrameInput& input);
    // The models leave light within the display's range alone (Model::obeys_residual_law), and
    bool obeys_residual_law() const;
    // none of them changed the picture recorded last: no state of the eye shows. True before the first frame.
    bool at_rest() const;
    // For a frame that needs no picture from the stage: both of the above, and all its light within the display's range. tiles() and the
    // points of glance_point() must have been written earlier in the batch; adaptation and the tone curve go on, the models are not recorded.
    void record_at_rest(gpu::Commands& commands, const FrameInput& input);
    const gpu::Buffer& tiles() const { return tiles_; }
    // Records the copy of one view of the image to host memory; read it with downloaded() after the batch was waited for.
    Result<void> record_download(gpu::Commands& commands, std::uint32_t view);
    ImageF downloaded(std::uint32_t view) const;   // RGB

    // The observer of the frame recorded last, as the models were told.
    const FrameInput& input() const { return input_; }
    // Of the frame recorded last; valid after its batch was waited for. When foveation was chosen its outcome is the last.
    std::vector<EffectOutcome> effects() const;
    ViewOutcome view(std::uint32_t index) const;
    // Frames each effect was recorded, gated, failed, since the start: for the report.
    struct Totals { std::uint64_t recorded = 0, gated = 0, failed = 0; std::string why; };
    const std::map<std::string, Totals>& totals() const { return totals_; }
    void accumulate_totals();      // call once a frame after the batch was waited for

    const Selection& selection() const { return selection_; }
    // Replaces models and parameters from the next frame on; state that both choices share is kept.
    Result<void> select(const Selection& selection);
    // Whether the frame recorded last was foveated.
    bool foveated() const { return foveated_; }

private:
    friend class Foveation;   // which runs the models of a second stage on a foveated image
    struct Slot {
        Choice choice;
        std::unique_ptr<Model> model;
        gpu::Buffer gate, gate_readback;
        std::string failed;
        bool recorded = false, resting = false;
    };
    // The observer as the AdjustsEyes models leave it.
    FrameInput adjusted(const FrameInput& input);
    SceneFeedback feedback(std::uint32_t view) const;
    void record_tiles(gpu::Commands& commands);
    void record_view_statistics(gpu::Commands& commands);
    void record_adaptation(gpu::Commands& commands, const FrameInput& input);
    void record_pictures(gpu::Commands& commands, const FrameInput& input);
    static bool changes_picture(const Slot& slot);
    // Of the stage whose models changed the picture last: this one, or the foveated one.
    const std::vector<Slot>& models_of_picture() const;
    // The models that change the picture go on from the states of those of `from`.
    void take_over(gpu::Commands& commands, Stage& from);
    // Sentence on the chosen model that needs the full image; empty when none does.
    std::string refusal_of_models() const;
    // Gates of the models recorded last that may have changed the picture.
    std::vector<const gpu::Buffer*> gates_of_pictures() const;
    Result<void> select_models(const Selection& selection);
    Result<void> select_foveation();
    EffectOutcome foveation_outcome() const;
    static EffectOutcome outcome_of(const Slot& slot);
    void record_gate_readbacks(gpu::Commands& commands);
    void record_readbacks(gpu::Commands& commands);
    explicit Stage(gpu::Device& device);
    Result<void> allocate(const StageOptions& options);
    Result<void> create_kernels();
    Result<void> fill_solid_angles();
    Result<void> expect_size(const ImageF& image, int channels, const char* what) const;
    Result<void> record_depth(gpu::Commands& commands, std::span<const ImageF> depths);
    Result<Slot> make_slot(const Choice& choice);
    ObserverState fresh_state() const;
    template <class Part> void record_part(Slot& slot, const char* suffix, Result<void> (Part::*part)(StageIo&), gpu::Commands& commands, const FrameInput& input);

    gpu::Device& device_;
    ModelContext context_{device_, {}, {}, 1, true, {}};
    Selection selection_;
    FrameInput input_;
    std::uint32_t width_ = 0, height_ = 0, views_ = 0;
    gpu::Buffer scene_, tiles_, solid_angle_, geometry_, statistics_, state_;
    gpu::Buffer upload_, statistics_readback_, state_readback_;
    gpu::Buffer dioptre_, depth_upload_;  // made when first wanted
    bool has_depth_ = false;              // depth_written() in this frame
    std::vector<gpu::Buffer> downloads_;
    gpu::Kernel ingest_, tiles_kernel_, statistics_kernel_;
    std::vector<Slot> slots_;
    std::map<std::string, Totals> totals_;
    std::unique_ptr<Foveation> foveation_;   // made when first chosen; its stage has the models of foveated frames
    bool foveated_ = false;                  // the frame recorded last was
    std::string not_foveated_;               // why not
};

}  // namespace entoptic::perception
