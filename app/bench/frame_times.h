// What a whole frame costs: both eyes, from a layer to panel codes, through the example lens.
#pragma once

#include "app/bench/effect_rows.h"

#include <map>

namespace entoptic::app {

struct FrameTimes {
    double off_ms = 0;                        // preset off
    std::map<std::string, double> preset_ms;  // the bench scene, every other preset
    double idle_ms = 0;                       // the default preset where there is nothing to see: an even grey, in a float layer, within the panel's range
};

// GPU milliseconds, medians over `options.frames` frames or as many as there is time for. `options.width` x `options.height`: panel of one eye.
Result<FrameTimes> frame_times(gpu::Device& device, const EffectBenchOptions& options);

}  // namespace entoptic::app
