// The parameters that buy time with error, and the values of them that `entoptic bench` tries.
#pragma once

#include <span>
#include <string_view>
#include <vector>

namespace entoptic::app {

struct Trade {
    std::string_view slot, model;  // of every model of the slot when `model` is empty
    std::string_view parameter;
    std::vector<double> values;  // the finest first
    std::string_view what;       // of which kind it is, for people
    // Another value describes another eye, not a coarser computation of the same: only the rows of this trade are compared with its finest value.
    bool changes_model = false;
    // Matters only to an eye whose pupil changes: timed with one that does, and compared between two diameters at which kernels are built.
    bool needs_moving_pupil = false;
};

std::span<const Trade> trades();

}  // namespace entoptic::app
