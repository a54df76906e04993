// For tests: oracle tables (tests/oracles/*.csv), error metrics on displayed light, and lines for the accuracy ledger. Header-only.
#pragma once

#include "base/image.h"
#include "base/testing/ledger.h"
#include "perception/model.h"
#include "shaders/colour_math.glsl"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace entoptic::perception::testing {

// Rows of a table by column name; cells that are not numbers are NaN.
using OracleRow = std::map<std::string, double>;
inline std::vector<OracleRow> oracle(const std::string& name) {
    std::ifstream file(std::string(ENTOPTIC_SOURCE_DIR) + "/tests/oracles/" + name + ".csv");
    if (!file) throw std::runtime_error("no oracle table " + name);
    const auto cells = [](const std::string& line) {
        std::vector<std::string> list;
        std::stringstream stream(line);
        for (std::string cell; std::getline(stream, cell, ',');) list.push_back(cell.substr(0, cell.find('\r')));
        return list;
    };
    std::string line;
    std::getline(file, line);
    const std::vector<std::string> header = cells(line);
    std::vector<OracleRow> rows;
    while (std::getline(file, line)) {
        OracleRow row;
        const auto values = cells(line);
        for (std::size_t i = 0; i < std::min(values.size(), header.size()); ++i) {
            char* end = nullptr;
            const double number = std::strtod(values[i].c_str(), &end);
            row[header[i]] = end == values[i].c_str() ? std::nan("") : number;
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

// |a - b| over |b|, or over `floor` where b is smaller.
inline double relative_error(double a, double b, double floor = 1e-30) { return std::abs(a - b) / std::max(std::abs(b), floor); }

using entoptic::testing::ledger;

struct ErrorSummary {
    double max = 0, p99 = 0, mean = 0;
};
inline ErrorSummary summary(std::vector<double> errors) {
    if (errors.empty()) return {};
    std::sort(errors.begin(), errors.end());
    double sum = 0;
    for (double e : errors) sum += e;
    return {errors.back(), errors[std::min(errors.size() - 1, errors.size() * 99 / 100)], sum / static_cast<double>(errors.size())};
}

// Relative error of every channel, over at least `floor`.
template <class A, class B> std::vector<double> relative_errors(const Image<A>& a, const Image<B>& b, double floor) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        errors.push_back(relative_error(static_cast<double>(a.data[i]), static_cast<double>(b.data[i]), floor));
    return errors;
}

// 8-bit code, not rounded, of display light in cd/m².
inline double code(double cd_m2, const DisplayRange& d = {}) {
    const double black = static_cast<double>(d.black_cd_m2), white = static_cast<double>(d.white_cd_m2);
    return 255 * colour::srgb_encode(std::clamp((cd_m2 - black) / (white - black), 0.0, 1.0));
}
template <class A, class B> std::vector<double> code_errors(const Image<A>& a, const Image<B>& b, const DisplayRange& d = {}) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        errors.push_back(std::abs(code(static_cast<double>(a.data[i]), d) - code(static_cast<double>(b.data[i]), d)));
    return errors;
}

// ITU-R BT.2124: difference of two display colours (BT.709, cd/m²); 1 is just noticeable in the most critical state.
inline double delta_e_itp(const double (&a)[3], const double (&b)[3]) {
    const auto pq = [](double light) {
        const double y = std::pow(std::max(light, 0.0) / 10000, 0.1593017578125);
        return std::pow((0.8359375 + 18.8515625 * y) / (1 + 18.6875 * y), 78.84375);
    };
    const auto itp = [&](const double(&c)[3], double(&out)[3]) {
        const double r = 0.627403896 * c[0] + 0.329283039 * c[1] + 0.043313065 * c[2],
                     g = 0.069097289 * c[0] + 0.919540395 * c[1] + 0.011362316 * c[2],
                     blue = 0.016391439 * c[0] + 0.088013308 * c[1] + 0.895595253 * c[2];
        const double l = pq((1688 * r + 2146 * g + 262 * blue) / 4096), m = pq((683 * r + 2951 * g + 462 * blue) / 4096),
                     s = pq((99 * r + 309 * g + 3688 * blue) / 4096);
        out[0] = 0.5 * (l + m);
        out[1] = 0.5 * (6610 * l - 13613 * m + 7003 * s) / 4096;
        out[2] = (17933 * l - 17390 * m - 543 * s) / 4096;
    };
    double p[3], q[3];
    itp(a, p);
    itp(b, q);
    return 720 * std::sqrt(std::pow(p[0] - q[0], 2) + std::pow(p[1] - q[1], 2) + std::pow(p[2] - q[2], 2));
}
template <class A, class B> std::vector<double> delta_e_itp(const Image<A>& a, const Image<B>& b) {
    std::vector<double> errors;
    for (std::size_t i = 0; i + 2 < a.data.size(); i += 3) {
        const double p[3] = {static_cast<double>(a.data[i]), static_cast<double>(a.data[i + 1]), static_cast<double>(a.data[i + 2])};
        const double q[3] = {static_cast<double>(b.data[i]), static_cast<double>(b.data[i + 1]), static_cast<double>(b.data[i + 2])};
        errors.push_back(delta_e_itp(p, q));
    }
    return errors;
}

// True when every value is a number.
template <class T> bool all_finite(const Image<T>& image) {
    return std::all_of(image.data.begin(), image.data.end(), [](T v) { return std::isfinite(v); });
}

}  // namespace entoptic::perception::testing
