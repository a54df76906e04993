// Speed against error, drawn.
#pragma once

#include "app/bench/effect_rows.h"

namespace entoptic::app {

// An SVG picture: GPU time to the right, ΔE_ITP (p99) upwards, both logarithmic. Rows of one model and parameter are joined by a line; a filled
// dot is what the model does by default, a ring around a dot the fastest whose error cannot be seen. `title` and `subtitle` stand above.
Result<void> write_plot(const std::string& path, const std::vector<EffectRow>& rows, const std::string& title, const std::string& subtitle);

}  // namespace entoptic::app
