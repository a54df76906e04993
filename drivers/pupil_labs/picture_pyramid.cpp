// Compiled with -O3 (drivers/CMakeLists.txt): plain loops that the compiler turns into vector instructions.
#include "drivers/pupil_labs/picture_pyramid.h"

#include <algorithm>
#include <cstddef>

namespace entoptic::drivers {

namespace {

template <class T> void set_size(Image<T>& image, int width, int height) {
    image.width = width;
    image.height = height;
    image.channels = 1;
    image.data.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
}

template <class T> T* row_of(Image<T>& image, int y) { return image.data.data() + static_cast<std::ptrdiff_t>(y) * image.width; }

const std::uint8_t* row_of(GrayView image, int y) { return image.data + static_cast<std::ptrdiff_t>(y) * image.stride; }

void halve_row(const std::uint8_t* __restrict above, const std::uint8_t* __restrict below, std::uint8_t* __restrict to, int width) {
    for (int x = 0; x < width; ++x)
        to[x] = static_cast<std::uint8_t>((above[2 * x] + above[2 * x + 1] + below[2 * x] + below[2 * x + 1] + 2) >> 2);
}

void filter_columns(const std::uint8_t* const (&rows)[5], float* __restrict to, int width) {
    const std::uint8_t* __restrict a = rows[0], * __restrict b = rows[1], * __restrict c = rows[2], * __restrict d = rows[3], * __restrict e = rows[4];
    for (int x = 0; x < width; ++x) to[x] = static_cast<float>(a[x] + e[x] + 4 * (b[x] + d[x]) + 6 * c[x]);
}

// `from` has two columns more on either side.
void filter_row(const float* __restrict from, float* __restrict to, int width) {
    for (int x = 0; x < width; ++x) to[x] = (from[x] + from[x + 4] + 4 * (from[x + 1] + from[x + 3]) + 6 * from[x + 2]) * (1.0f / 256);
}

}  // namespace

void reduce(GrayView from, int factor, Image8& to) {
    set_size(to, from.width / factor, from.height / factor);
    if (factor == 2) {
        for (int y = 0; y < to.height; ++y) halve_row(row_of(from, 2 * y), row_of(from, 2 * y + 1), row_of(to, y), to.width);
        return;
    }
    const int area = factor * factor;
    for (int y = 0; y < to.height; ++y) {
        for (int x = 0; x < to.width; ++x) {
            int sum = area / 2;
            for (int v = 0; v < factor; ++v) {
                const std::uint8_t* row = row_of(from, y * factor + v) + static_cast<std::ptrdiff_t>(x) * factor;
                for (int u = 0; u < factor; ++u) sum += row[u];
            }
            row_of(to, y)[x] = static_cast<std::uint8_t>(sum / area);
        }
    }
}

void low_pass(GrayView from, ImageF& to) {
    set_size(to, from.width, from.height);
    std::vector<float> padded(static_cast<std::size_t>(from.width) + 4);
    for (int y = 0; y < from.height; ++y) {
        const auto row = [&](int dy) { return row_of(from, std::clamp(y + dy, 0, from.height - 1)); };
        const std::uint8_t* const rows[5] = {row(-2), row(-1), row(0), row(1), row(2)};
        filter_columns(rows, padded.data() + 2, from.width);
        padded[0] = padded[1] = padded[2];
        padded[padded.size() - 1] = padded[padded.size() - 2] = padded[padded.size() - 3];
        filter_row(padded.data(), row_of(to, y), from.width);
    }
}

void integrate(const Image8& from, Image<std::int32_t>& sums) {
    set_size(sums, from.width + 1, from.height + 1);
    std::fill_n(sums.data.begin(), sums.width, 0);
    for (int y = 0; y < from.height; ++y) {
        const std::uint8_t* in = from.data.data() + static_cast<std::ptrdiff_t>(y) * from.width;
        const std::int32_t* above = row_of(sums, y);
        std::int32_t* out = row_of(sums, y + 1);
        out[0] = 0;
        for (int x = 0, sum = 0; x < from.width; ++x) {
            sum += in[x];
            out[x + 1] = above[x + 1] + sum;
        }
    }
}

}  // namespace entoptic::drivers
