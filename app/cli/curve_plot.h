// Curves, drawn.
#pragma once

#include "base/result.h"

#include <string>
#include <vector>

namespace entoptic::app {

struct CurvePicture {
    std::string title, subtitle, x_label, y_label;
    bool log_x = false;
    std::vector<std::string> columns;         // the first is x
    std::vector<std::vector<double>> rows;    // as many values as there are columns; what is not finite is left out
};

// An SVG picture: each column but the first as a line over it, with a legend. The y axis is logarithmic where all values are above 0 and
// span more than two decades.
Result<void> write_curve_plot(const std::string& path, const CurvePicture& picture);

}  // namespace entoptic::app
