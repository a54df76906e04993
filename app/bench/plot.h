// Speed against error, drawn.
#pragma once

#include "app/bench/effect_rows.h"

namespace entoptic::app {

// An SVG picture: GPU time to the right, ΔE_ITP (p99) upwards, both logarithmic; a filled dot is the default setting.
Result<void> write_plot(const std::string& path, const std::vector<EffectRow>& rows, const std::string& title);

}  // namespace entoptic::app
