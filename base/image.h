// Images on the CPU, rows from the top, channels interleaved. Float for what crosses the GPU, double for references.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace entoptic {

template <class T> struct Image {
    int width = 0, height = 0, channels = 0;
    std::vector<T> data;

    Image() = default;
    Image(int w, int h, int c, T fill = T{}) : width(w), height(h), channels(c), data(std::size_t(w) * std::size_t(h) * std::size_t(c), fill) {}
    T& at(int x, int y, int c) { return data[(std::size_t(y) * std::size_t(width) + std::size_t(x)) * std::size_t(channels) + std::size_t(c)]; }
    const T& at(int x, int y, int c) const { return const_cast<Image*>(this)->at(x, y, c); }
    bool empty() const { return data.empty(); }
};

using ImageF = Image<float>;
using ImageD = Image<double>;
using Image8 = Image<std::uint8_t>;

template <class To, class From> Image<To> convert(const Image<From>& in) {
    Image<To> out(in.width, in.height, in.channels);
    for (std::size_t i = 0; i < in.data.size(); ++i) out.data[i] = static_cast<To>(in.data[i]);
    return out;
}

}  // namespace entoptic
