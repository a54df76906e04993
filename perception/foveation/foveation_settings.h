// Whether the perception stage works on a foveated image, and how: `--set foveation.inverse=exact --set foveation.reduction=2`.
#pragma once

namespace entoptic::perception {

// How directions follow from the map's radius: Liu 2021's equation 1 integrated and inverted exactly, or by the paper's fit, equation 3.
enum class FoveationInverse { off, exact, fitted };

// Texels a pixel of the view, each way, in the fovea, at a reduction of 1. choice: on a Vive Pro's field the foveated image then has the view's
// own size, and a reduction of 2 still has 1.25 texels a pixel.
constexpr double foveal_texels_a_pixel = 2.5;
// choice: below 1 there is nothing to save, beyond 4 the fovea is much coarser than the view.
constexpr float least_foveation_reduction = 1, most_foveation_reduction = 4;

struct FoveationSettings {
    FoveationInverse inverse = FoveationInverse::off;
    // Linear: how much coarser texels are than at foveal_texels_a_pixel. choice: at 2 the fovea's pixels come back as they were.
    float reduction = 2;
    bool operator==(const FoveationSettings&) const = default;
};

const char* name_of(FoveationInverse inverse);

}  // namespace entoptic::perception
