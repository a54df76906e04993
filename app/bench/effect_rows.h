// Speed against error of every model, at its default and at other settings worth comparing, within a preset.
#pragma once

#include "base/result.h"
#include "gpu/device.h"

#include <functional>
#include <string>
#include <vector>

namespace entoptic::app {

struct Percentiles {
    double median = 0, p95 = 0;
};
// Of at least one value.
Percentiles percentiles(std::vector<double> values);

// What a picture on the display differs by from what it should be.
struct PictureError {
    double de_itp_p99 = 0, de_itp_mean = 0;  // ΔE_ITP (BT.2124) on displayed cd/m²
    double max_code = 0;                     // 8-bit code values, before rounding
    double energy = 0;                       // relative difference of all light shown
};

struct EffectRow {
    std::string effect, model, setting;  // setting: "default" or "wavelengths=3"
    bool is_default = false;            // what the preset does
    Percentiles time_ms;  // GPU time of the effect's own stage in a frame of the whole preset, with this model in its slot
    PictureError error;   // with only what it needs to be shown, against the double-precision references
};

struct EffectBenchOptions {
    std::string preset;
    bool all_models = true;                     // false: only those of the preset
    int width = 720, height = 800;              // for the times, one eye
    int error_width = 90, error_height = 100;  // for the errors: references are slow, that of diffraction at a mask most of all
    int frames = 10;                            // timed ones
    std::function<void(std::size_t done, std::size_t total)> progress;
};

Result<std::vector<EffectRow>> effect_rows(gpu::Device& device, const EffectBenchOptions& options);

}  // namespace entoptic::app
