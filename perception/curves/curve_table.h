// For the files that make the table of curves, one a slot.
#pragma once

#include "perception/curves/curve.h"

namespace entoptic::perception {

// A function of one x as a CurveFunction. `f` returns a double or a vector of them.
template <auto f> std::vector<double> each(const CurveInput& input, std::span<const double> xs) {
    std::vector<double> values;
    for (const double x : xs) {
        if constexpr (requires { double{f(input, x)}; }) values.push_back(f(input, x));
        else
            for (int i = 0; i < 3; ++i) values.push_back(f(input, x)[i]);
    }
    return values;
}

std::vector<Curve> pupil_curves();
std::vector<Curve> adaptation_curves();
std::vector<Curve> tone_curves();
std::vector<Curve> glare_curves();
std::vector<Curve> acuity_curves();
std::vector<Curve> mesopic_curves();
std::vector<Curve> afterimage_curves();
std::vector<Curve> dof_curves();
std::vector<Curve> foveation_curves();

}  // namespace entoptic::perception
