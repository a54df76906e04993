// A low-passed grey picture in float, read between its pixels.
#pragma once

#include <algorithm>

namespace entoptic::drivers {

// Coordinates as in ellipse.h: pixel centres at whole numbers + 0.5. Points outside take the value of the nearest edge pixel.
struct SmoothImage {
    const float* data = nullptr;
    int width = 0, height = 0;  // >= 2
    int stride = 0;             // floats a row

    float at(double x, double y) const {
        const float fx = std::clamp(static_cast<float>(x) - 0.5f, 0.0f, static_cast<float>(width) - 1.001f);
        const float fy = std::clamp(static_cast<float>(y) - 0.5f, 0.0f, static_cast<float>(height) - 1.001f);
        const int ix = static_cast<int>(fx), iy = static_cast<int>(fy);
        const float u = fx - static_cast<float>(ix), v = fy - static_cast<float>(iy);
        const float* row = data + static_cast<long>(iy) * stride + ix;
        const float above = row[0] + u * (row[1] - row[0]), below = row[stride] + u * (row[stride + 1] - row[stride]);
        return above + v * (below - above);
    }
    bool inside(double x, double y, double margin) const {
        return x >= margin && y >= margin && x <= width - margin && y <= height - margin;
    }
};

}  // namespace entoptic::drivers
