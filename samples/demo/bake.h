// The lightmap: illuminance of every patch under each of four lights, with shadows and interreflection, computed at start-up.
// At run time lights are mixed by weights, so that dimming costs nothing.
#pragma once

#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "samples/demo/canvas.h"
#include "samples/demo/office.h"

namespace samples {

// The channels of a lightmap texel. Each holds illuminance in lux.
enum LightChannel : int {
    light_sky = 0,      // under a uniform sky of 1 cd/m², over a landscape a fifth as bright
    light_ceiling = 1,  // from a ceiling panel of 1 cd/m²
    light_lamp = 2,     // from a bulb of 1 lm
    light_moon = 3,     // from a moon that gives 1 lx on a surface facing it, outside
};

// Where a patch lies in the lightmap. Texel centres at the block's edges lie on the patch's edges, and a border of one texel
// beyond repeats them, so that a bilinear lookup never sees another patch.
struct LightmapBlock {
    std::uint32_t x = 0, y = 0;           // first texel, without the border
    std::uint32_t width = 0, height = 0;  // 0: the patch does not reflect and has none
};

struct Lightmap {
    std::uint32_t width = 0, height = 0;
    std::vector<glm::vec4> texels;
    std::vector<LightmapBlock> blocks;  // one a patch
};

// Deterministic: the same on every run and with any number of threads. `materials` gives the mean albedo of each texture.
Lightmap bake(const Office& office, const std::vector<Canvas>& materials);

// Flux of light the lamp's reflector returns, over that of its first reflection: between its walls light bounces again.
// For a cavity of albedo `albedo` the gain is 1 / (1 - albedo (1 - opening / wall)), by reciprocity of the form factors.
float cavity_gain(float albedo, float opening_area, float wall_area);

}  // namespace samples
