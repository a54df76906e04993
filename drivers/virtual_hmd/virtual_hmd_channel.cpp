#include "drivers/virtual_hmd/virtual_hmd_channel.h"

namespace entoptic::drivers {

std::vector<double> monotone_slopes(const std::vector<double>& times, const std::vector<double>& values) {
    std::vector<double> slopes(times.size(), 0.0);
    for (std::size_t i = 1; i + 1 < times.size(); ++i) {
        const double before = times[i] - times[i - 1], after = times[i + 1] - times[i];
        const double left = (values[i] - values[i - 1]) / before, right = (values[i + 1] - values[i]) / after;
        if (left * right <= 0) continue;  // a turning point or a plateau: at rest
        const double w1 = 2 * after + before, w2 = after + 2 * before;
        slopes[i] = (w1 + w2) / (w1 / left + w2 / right);
    }
    return slopes;
}

}  // namespace entoptic::drivers
