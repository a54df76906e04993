// What a whole frame costs: both eyes, from a layer to panel codes, through the example lens.
#pragma once

#include "app/bench/effect_rows.h"

#include <string>
#include <utility>
#include <vector>

namespace entoptic::app {

struct FrameTime {
    std::string preset;
    double total_ms = 0;
    std::vector<std::pair<std::string, double>> stages_ms;  // "warp", "perceive.glare", ... in order

    // Sum of the stages whose name is this, or begins with this and a dot.
    double stage_ms(const std::string& name) const;
};

struct FrameTimes {
    FrameTime off;             // in one pass
    FrameTime off_in_stages;   // warp and lens as passes of their own, as where something is simulated
    std::vector<FrameTime> presets;  // the bench scene, every other preset
    FrameTime idle;            // the default preset where there is nothing to see: an even grey, in a float layer, within the panel's range
};

// GPU milliseconds, medians over `options.frames` frames or as many as there is time for. `options.width` x `options.height`: panel of one eye.
Result<FrameTimes> frame_times(gpu::Device& device, const EffectBenchOptions& options);

}  // namespace entoptic::app
