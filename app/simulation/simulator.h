// One picture, one eye, through the perception stage frame by frame: on the GPU, or by the double-precision references.
#pragma once

#include "base/image.h"
#include "perception/model.h"
#include "perception/preset.h"
#include "perception/stage.h"

#include <memory>
#include <string>
#include <vector>

namespace entoptic::app {

struct SimulatorOptions {
    EyeGeometry geometry;
    perception::DisplayRange display;
    perception::Selection selection;
    std::uint64_t seed = 1;
};

class Simulator {
public:
    virtual ~Simulator() = default;
    // The eye has been adapted to this luminance before the first frame.
    virtual void set_adaptation(double cd_m2) = 0;
    // One frame of `scene` (RGB, cd/m²); `depth` (metres) may be empty. Without `want_picture` only what later frames depend on needs to be
    // computed.
    virtual Result<void> frame(const ImageF& scene, const ImageF& depth, const perception::FrameInput& input, bool want_picture) = 0;
    // Of the last frame that wanted a picture: display light in cd/m², as the models left it.
    virtual ImageF picture() const = 0;
    virtual perception::ViewOutcome view() const = 0;
    // Of the last frame, as the models were told: a pupil model may have changed the pupil that was given.
    virtual perception::EyeInput eye() const = 0;
    virtual std::vector<perception::EffectOutcome> effects() const = 0;
    virtual std::string device() const = 0;
};

// `device` must outlive the simulator.
Result<std::unique_ptr<Simulator>> make_gpu_simulator(gpu::Device& device, const SimulatorOptions& options);
std::unique_ptr<Simulator> make_reference_simulator(const SimulatorOptions& options);

// The same picture as the display can show it: each channel between its black and its white.
ImageF limited_to_display(ImageF picture, const perception::DisplayRange& display);
// Code values of a display with the sRGB curve, from display light.
Image8 display_codes(const ImageF& picture, const perception::DisplayRange& display);
// The same, dithered over time (Jacobs et al. 2015): light between two codes is shown as one of them by chance, each pixel and `frame` anew, so
// that its mean over frames is right.
Image8 dithered_codes(const ImageF& picture, const perception::DisplayRange& display, std::uint64_t seed, std::uint64_t frame);

}  // namespace entoptic::app
