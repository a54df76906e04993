// How commands speak: one JSON document on standard output, progress and messages on standard error.
#pragma once

#include "base/result.h"

#include <chrono>
#include <nlohmann/json.hpp>
#include <string>

namespace entoptic::app {

using Json = nlohmann::ordered_json;

// The number a person would write: 0.04f is 0.04, not 0.03999999910593033.
double decimal(float value);

void print_json(const Json& document);
// Writes the document to a file of its own, whole or not at all.
Result<void> write_json(const std::string& path, const Json& document);

// "12 of 900 frames" on standard error, for work that takes longer than a second or two. Silent where nobody looks
// (no terminal) unless `always`; but work of more than half a minute says once, wherever, how long it will take.
class Progress {
public:
    Progress(std::string what, bool always);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    void update(std::uint64_t done, std::uint64_t total);  // total 0: unknown

private:
    using Steady = std::chrono::steady_clock;
    std::string what_;
    bool terminal_, on_;
    bool shown_ = false, told_ = false;
    std::uint64_t first_done_ = 0;  // by the first update that had any: what came before is no measure
    Steady::time_point start_ = Steady::now(), last_ = start_, first_ = start_;
};

}  // namespace entoptic::app
