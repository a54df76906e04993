// Speed against error of every model, at its default and at the settings that buy time with error (trades.h).
#pragma once

#include "base/image.h"
#include "base/result.h"
#include "gpu/device.h"

#include <functional>
#include <string>
#include <vector>

namespace entoptic::app {

struct Percentiles {
    double median = 0, p95 = 0, mean = 0, least = 0;
};
// Of at least one value.
Percentiles percentiles(std::vector<double> values);

// What a picture on the display differs by from what it should be.
struct PictureError {
    double de_itp_p99 = 0, de_itp_mean = 0;  // ΔE_ITP (BT.2124) on displayed cd/m²
    double max_code = 0;                     // 8-bit code values, before rounding
    double energy = 0;                       // relative difference of all light shown

    // choice: facts/perception.md 5, for approximations.
    bool is_unseen() const { return de_itp_p99 <= 1 && de_itp_mean <= 0.2; }
};
// Of two pictures of display light (cd/m²) of one size, as the panel can show them.
PictureError picture_error(const ImageF& got, const ImageF& wanted);

struct EffectRow {
    std::string effect, model, setting;  // setting: "default" or "wavelengths=3"
    std::string parameter;               // what is varied; empty: nothing
    bool is_chosen = false;              // this is what the model does by default
    bool is_default = false;             // and the preset has this model
    bool is_fastest_unseen = false;      // of the rows that it may be compared with, the fastest whose error cannot be seen
    bool apart = false;                  // compared with the other rows of its parameter only (Trade)
    Percentiles time_ms;                 // GPU time of the effect's own stage, the model with only what it needs to be shown
    PictureError error;                  // against the double-precision references

    // What rows are compared by: the fastest frame, which keeps the machine's other work out. Kernels are rebuilt in few frames: there the mean counts.
    double typical_ms() const { return parameter == "rebuild_mm" ? time_ms.mean : time_ms.least; }
};

// Sets is_fastest_unseen. The default is it when no other is faster by a twentieth or more: less is the same on a machine that does other things, too.
void mark_fastest(std::vector<EffectRow>& rows);

struct EffectBenchOptions {
    std::string preset;
    std::string slot, model;        // only these; empty: all
    bool all_models = true;         // false: only those of the preset
    int width = 720, height = 800;  // for the times, one eye
    // For the errors, at the headset's pixels per degree: references are slow. With far fewer pixels the tiles by which models know the scene
    // are so few that their median is not the references', and exposures differ.
    int error_width = 90, error_height = 100;
    int frames = 10;     // timed ones at most
    double seconds = 1;  // that the timed frames of a row may take, but for the least number
    std::function<void(std::size_t done, std::size_t total)> progress;
};

// Rows of a model are together: its default first, then parameter by parameter from fine to coarse.
Result<std::vector<EffectRow>> effect_rows(gpu::Device& device, const EffectBenchOptions& options);

}  // namespace entoptic::app
