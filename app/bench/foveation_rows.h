// Speed against error of foveated processing: a preset's models on the whole image, and on images that are as dense as the retina.
#pragma once

#include "app/bench/effect_rows.h"

namespace entoptic::app {

// Times are those of all models together; errors those of the whole picture against the full image on the same device, gaze straight ahead.
// What an eye that looks there does not see of them is not taken off: perception/foveation/visual_polar.md has it.
Result<std::vector<EffectRow>> foveation_rows(gpu::Device& device, const EffectBenchOptions& options);

}  // namespace entoptic::app
