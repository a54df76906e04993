// Speed against error of what the scene is stored in between passes (decision 0002).
#pragma once

#include "app/bench/effect_rows.h"

namespace entoptic::app {

// Times are those of one pass that does nothing but read and write the picture; errors those of the preset's picture when the scene has been
// through the format once, against the unrounded scene, at the headset's pixels per degree, on the same device.
Result<std::vector<EffectRow>> storage_rows(gpu::Device& device, const EffectBenchOptions& options);

}  // namespace entoptic::app
