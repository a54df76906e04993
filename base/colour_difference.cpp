#include "base/colour_difference.h"

#include <algorithm>
#include <cmath>

namespace entoptic {
namespace {

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;

// BT.709 to BT.2020 primaries, from their chromaticities (ITU-R BT.2087 gives four digits).
constexpr Matrix bt2020_from_bt709{{{0.627403895934699, 0.329283038377884, 0.043313065687417},
                                    {0.069097289358232, 0.919540395075459, 0.011362315566309},
                                    {0.016391438875150, 0.088013307877226, 0.895595253247624}}};
// ITU-R BT.2100-2, table 7: LMS of BT.2020 colours, and ICtCp of their PQ values.
constexpr Matrix lms_from_bt2020{{{1688.0 / 4096, 2146.0 / 4096, 262.0 / 4096},
                                  {683.0 / 4096, 2951.0 / 4096, 462.0 / 4096},
                                  {99.0 / 4096, 309.0 / 4096, 3688.0 / 4096}}};
constexpr Matrix ictcp_from_lms{
    {{0.5, 0.5, 0}, {6610.0 / 4096, -13613.0 / 4096, 7003.0 / 4096}, {17933.0 / 4096, -17390.0 / 4096, -543.0 / 4096}}};

Triple times(const Matrix& m, const Triple& v) {
    Triple out{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) out[i] += m[i][j] * v[j];
    return out;
}

// SMPTE ST 2084's inverse EOTF: cd/m² to 0..1.
double pq(double cd_m2) {
    constexpr double m1 = 2610.0 / 16384, m2 = 2523.0 / 32, c1 = 3424.0 / 4096, c2 = 2413.0 / 128, c3 = 2392.0 / 128;
    const double y = std::pow(std::max(cd_m2, 0.0) / 10000, m1);
    return std::pow((c1 + c2 * y) / (1 + c3 * y), m2);
}

Triple itp(const Triple& rgb) {
    Triple lms = times(lms_from_bt2020, times(bt2020_from_bt709, rgb));
    for (double& v : lms) v = pq(v);
    const Triple ictcp = times(ictcp_from_lms, lms);
    return {ictcp[0], 0.5 * ictcp[1], ictcp[2]};
}

}  // namespace

double delta_e_itp(const Triple& a, const Triple& b) {
    const Triple x = itp(a), y = itp(b);
    return 720 * std::hypot(x[0] - y[0], x[1] - y[1], x[2] - y[2]);
}

}  // namespace entoptic
