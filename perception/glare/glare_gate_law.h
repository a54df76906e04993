// For tests: what the gate of every residual glare model keeps true. Header-only.
#pragma once

#include "perception/testing/gate_sweep.h"
#include "perception/testing/harness.h"
#include "perception/testing/scenes.h"

#include <cstring>

namespace entoptic::perception::testing {

// Exact: up to the panel's white (without a tone model the scene's) nothing changes, above it something does.
inline void expect_exact_gate(const Selection& selection, float white_cd_m2 = 130) {
    StageRunner runner({rectilinear(20, 20, 25)}, selection);
    GateCount count;
    for (double factor : factors_around_bound()) {
        ImageF in = uniform(20, 20, std::min(1.0f, static_cast<float>(factor)));
        for (int y = 9; y < 12; ++y)
            for (int x = 9; x < 12; ++x)
                for (int c = 0; c < 3; ++c) in.at(x, y, c) = static_cast<float>(factor) * white_cd_m2;
        const ImageF out = runner.run(in, still_input(1));
        const bool is_gated = runner.stage().effects().at(0).gated;
        count.add(is_gated, factor);
        EXPECT_EQ(is_gated, factor < 1) << factor;
        EXPECT_EQ(std::memcmp(in.data.data(), out.data.data(), in.data.size() * sizeof(float)) == 0, factor < 1) << factor;
    }
    count.expect_both_outcomes();
}

}  // namespace entoptic::perception::testing
