// What the pictures of `entoptic curve` and `entoptic bench` share: axes, a grid, and a file of 800 x 500 pixels.
#pragma once

#include "base/result.h"

#include <cmath>
#include <string>
#include <vector>

namespace entoptic::app::svg {

// The plot's frame, pixels.
constexpr double left = 100, right = 760, top = 50, bottom = 440;

// Values to pixels; over whole decades when logarithmic.
struct Axis {
    bool logarithmic = false;
    double from = 0, to = 1;    // values, exponents when logarithmic
    double start = 0, end = 0;  // pixels

    double place(double value) const { return logarithmic ? std::log10(value) : value; }
    bool shows(double value) const { return std::isfinite(value) && (!logarithmic || value > 0); }
    double at(double value) const { return start + (place(value) - from) / (to - from) * (end - start); }
    double value(double place) const { return logarithmic ? std::pow(10, place) : place; }
};

// An axis on which all finite values have room (of a logarithmic one: those above 0).
Axis axis_over(const std::vector<double>& values, bool logarithmic, double start, double end);

// Text within an element.
std::string escaped(const std::string& text);

struct Labels {
    std::string title, subtitle, x, y;
};
// Writes a picture: title, labelled grid, and `marks`, elements in its pixels.
Result<void> write_plot_file(const std::string& path, const Labels& labels, const Axis& x, const Axis& y, const std::string& marks);

}  // namespace entoptic::app::svg
