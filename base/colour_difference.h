// Visible difference of two displayed colours: ITU-R BT.2124 (2019), ΔE_ITP. 1 is the just noticeable difference of an eye adapted to the
// colour itself, the most critical state.
#pragma once

#include <array>

namespace entoptic {

// Colours are linear light in BT.709 / D65 primaries, cd/m².
double delta_e_itp(const std::array<double, 3>& a, const std::array<double, 3>& b);

}  // namespace entoptic
