// The pictures that the pupil detector works on, made from a camera's picture: smaller ones, a low-passed one, sums. A few loops of our own:
// OpenCV's would bring a dozen libraries (TBB, LAPACK, X11, GLX) and 27 ms of loading into every OpenXR application (pupil_labs.md).
#pragma once

#include "base/image.h"

#include <cstdint>

namespace entoptic::drivers {

// 8-bit grey, rows from the top. Not owned.
struct GrayView {
    const std::uint8_t* data = nullptr;
    int width = 0, height = 0;
    int stride = 0;  // bytes a row, >= width
};

inline GrayView view_of(const Image8& image) { return {image.data.data(), image.width, image.height, image.width}; }

// `to` becomes `from` with factor x factor pixels averaged into one, rounded; what is left over at the right and below is dropped.
// factor >= 1; memory of `to` is used again.
void reduce(GrayView from, int factor, Image8& to);

// `to` becomes the whole `from` low-passed with the binomial kernel 1 4 6 4 1 in both directions (standard deviation 1 px); the edge pixels
// go on outside.
void low_pass(GrayView from, ImageF& to);

// sums.at(x, y) of a picture is the sum of the pixels left of x and above y; one row and column more than the picture.
void integrate(const Image8& from, Image<std::int32_t>& sums);

}  // namespace entoptic::drivers
