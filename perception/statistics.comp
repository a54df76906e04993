#version 450
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require

// Tiles of a view to its SceneStatistics: one workgroup a view, sums in a fixed order, so the same frame gives the same bits.

#include "shaders/scene_statistics.h"

layout(local_size_x = 256) in;

layout(scalar, binding = 0) readonly buffer Tiles { TileStatistics tiles[]; };
layout(scalar, binding = 1) buffer Statistics { SceneStatistics statistics[]; };

layout(scalar, push_constant) uniform Push {
    uint tile_count;
    float black_cd_m2;      // what the display shows at least
} push;

shared TileStatistics parts[256];
shared float dark_sr[256];
shared uint bins[histogram_bins];

const float histogram_low = -6.0, histogram_high = 8.0;   // log10 cd/m²

uint bin_of(float y) {
    const float position = (log(max(y, min_scene_cd_m2)) * 0.4342944819 - histogram_low) / (histogram_high - histogram_low);
    return min(uint(max(position, 0.0) * float(histogram_bins)), histogram_bins - 1u);
}

TileStatistics merged(TileStatistics a, TileStatistics b) {
    return TileStatistics(a.sum_y_sr + b.sum_y_sr, a.sum_sr + b.sum_sr, min(a.min_y, b.min_y), max(a.max_y, b.max_y),
                          max(a.max_channel, b.max_channel), a.cleaned + b.cleaned, a.visible + b.visible);
}

// Luminance of the middle of the bin that holds half of the tiles that show anything.
float median_luminance() {
    uint total = 0;
    for (uint b = 0; b < histogram_bins; ++b) total += bins[b];
    uint below = 0;
    for (uint b = 0; b < histogram_bins; ++b) {
        below += bins[b];
        if (2u * below >= total && total > 0u)
            return pow(10.0, histogram_low + (float(b) + 0.5) / float(histogram_bins) * (histogram_high - histogram_low));
    }
    return min_scene_cd_m2;
}

void main() {
    const uint i = gl_LocalInvocationID.x, view = gl_WorkGroupID.x;
    if (i < histogram_bins) bins[i] = 0u;
    barrier();
    TileStatistics sum = TileStatistics(0.0, 0.0, 3e38, 0.0, 0.0, 0u, 0u);
    float dark = 0.0;
    for (uint t = i; t < push.tile_count; t += 256u) {
        const TileStatistics tile = tiles[view * push.tile_count + t];
        if (tile.visible > 0u) atomicAdd(bins[bin_of(tile.sum_y_sr / max(tile.sum_sr, 1e-20))], 1u);
        // A thousandth below, so that a black that was only rounded does not count.
        if (tile.sum_y_sr < 0.999 * push.black_cd_m2 * tile.sum_sr) dark += tile.sum_sr;
        sum = merged(sum, tile);
    }
    parts[i] = sum;
    dark_sr[i] = dark;
    for (uint stride = 128u; stride > 0u; stride /= 2u) {
        barrier();
        if (i < stride) {
            parts[i] = merged(parts[i], parts[i + stride]);
            dark_sr[i] += dark_sr[i + stride];
        }
    }
    barrier();
    if (i != 0u) return;
    const TileStatistics all = parts[0];
    statistics[view].min_y = all.visible > 0u ? all.min_y : 0.0;
    statistics[view].max_y = all.max_y;
    statistics[view].max_channel = all.max_channel;
    statistics[view].mean_y = all.sum_y_sr / max(all.sum_sr, 1e-20);
    statistics[view].median_tile_y = median_luminance();
    statistics[view].sum_sr = all.sum_sr;
    statistics[view].dark_share = dark_sr[0] / max(all.sum_sr, 1e-20);
    statistics[view].cleaned = all.cleaned;
    statistics[view].visible = all.visible;
    for (uint b = 0; b < histogram_bins; ++b) statistics[view].histogram[b] = bins[b];
}
