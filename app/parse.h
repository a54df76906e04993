// Text that people type, to values; each error says what was wanted.
#pragma once

#include "base/result.h"

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace entoptic::app {

// A finite number, the whole text; nothing else.
std::optional<double> number_from(std::string_view text);
// "1,2,3": finite numbers, at least one.
std::optional<std::vector<double>> numbers_from(std::string_view text);
// "1440x1600": two whole numbers from 1.
std::optional<std::pair<int, int>> size_from(std::string_view text);

// A file name with at most one frame number in it: "a_%04d.exr" (also %d) and at most one time "%t".
class NumberedName {
public:
    // Usage error: another conversion, or two of one kind.
    static Result<NumberedName> parse(const std::string& text);
    bool has_number() const { return number_at_ != std::string::npos; }
    bool has_time() const { return time_at_ != std::string::npos; }
    // `time_s` is written as short as it can be: 0.5, 2, 120.
    std::string with(int number, double time_s) const;

private:
    std::string text_;
    std::size_t number_at_ = std::string::npos, number_length_ = 0, time_at_ = std::string::npos;
    int digits_ = 0;
};

}  // namespace entoptic::app
