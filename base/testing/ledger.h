// For tests: lines for the accuracy ledger. Header-only.
#pragma once

#include <cstdio>
#include <string>

namespace entoptic::testing {

// One row of the accuracy ledger: bench/ledger/accuracy.csv is made from these lines. No commas in the texts.
inline void ledger(const char* what, const std::string& setting, const char* metric, double value) {
    std::printf("LEDGER,%s,%s,%s,%.3g\n", what, setting.c_str(), metric, value);
}

}  // namespace entoptic::testing
