// The perception stage on a foveated image: Liu et al. 2021's visual-polar map about the gaze. The view's picture is reduced to texels that hold as
// many samples of the retina each, the models run there, and the result is brought back to the view's pixels (visual_polar.md).
//
// The foveated image lies in the gaze's own axes: to its models the gaze is -z in every frame, and what they prepared of the geometry stays
// true while the eye moves. Only what the view holds of it changes: solid angles and visibility are written in each frame.
#pragma once

#include "perception/foveation/foveation_gpu.h"
#include "perception/foveation/foveation_settings.h"
#include "perception/stage.h"

namespace entoptic::perception {

// Where the gaze of a view lies and what is left of it: the foveated image is centred to whole texels of the fovea, so that a fixating eye's
// small movements do not sample the scene anew.
struct FoveatedGaze {
    FoveatedView axes;
    vec3 residual{0, 0, -1};  // the gaze in these axes
};
// `gaze` must be finite and not zero. A gaze more than `limit_deg` from -z is taken to be there.
FoveatedGaze foveated_gaze(const EyeGeometry& foveated, const vec3& gaze, float limit_deg);

// The foveated image of views on these grids, all alike: a square, its disc reaching the farthest pixel of a view from a gaze up to
// foveated_gaze_limit_deg() from the axis, its fovea as fine as `settings` ask for.
EyeGeometry foveated_geometry(std::span<const EyeGeometry> views, const FoveationSettings& settings);
// Half of the views' field, at most 40 degrees (choice: eyes turn less far, the head follows).
float foveated_gaze_limit_deg(std::span<const EyeGeometry> views);

class Foveation {
public:
    // `full`: options of the stage whose pictures are to be foveated; its selection says how.
    static Result<std::unique_ptr<Foveation>> create(gpu::Device& device, const StageOptions& full);

    // Why the frame has to take the full image: a sentence, empty when it need not.
    std::string refusal(const FrameInput& input) const;
    // The models of `full` that change the picture, after its adaptation. `taking_over`: the frame before was full, the models go on from its states.
    void record(gpu::Commands& commands, Stage& full, const FrameInput& input, bool taking_over);

    Stage& stage() { return *stage_; }
    const Stage& stage() const { return *stage_; }
    Result<void> select(const Selection& selection);
    const EyeGeometry& geometry() const { return geometry_; }
    const FoveationSettings& settings() const { return settings_; }

private:
    explicit Foveation(gpu::Device& device) : device_(device) {}
    Result<void> allocate(const StageOptions& full);
    Result<void> create_kernels();
    Result<void> fill_texels();
    FrameInput look(const FrameInput& input);
    void record_reduction(gpu::Commands& commands, const Stage& full);
    void record_return(gpu::Commands& commands, const Stage& full);

    gpu::Device& device_;
    FoveationSettings settings_;
    EyeGeometry geometry_{};
    float gaze_limit_deg_ = 0;
    bool whole_sphere_ = false;
    FoveationPush push_{};
    std::unique_ptr<Stage> stage_;
    gpu::Buffer views_;    // FoveatedView a view, of this frame
    gpu::Buffer texels_;   // FoveatedTexel a texel
    gpu::Buffer places_;   // vec2 a texel, views: pixels of the view
    gpu::Buffer outcome_;  // FoveationGate
    gpu::Kernel place_, reduce_, gate_, restore_;
};

}  // namespace entoptic::perception
