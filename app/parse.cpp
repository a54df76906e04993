#include "app/parse.h"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace entoptic::app {
namespace {

template <class T> std::optional<T> whole_text(std::string_view text) {
    T value{};
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) return std::nullopt;
    return value;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::optional<double> number_from(std::string_view text) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    const auto value = whole_text<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::vector<double>> numbers_from(std::string_view text) {
    std::vector<double> values;
    while (true) {
        const auto comma = text.find(',');
        const auto value = number_from(text.substr(0, comma));
        if (!value) return std::nullopt;
        values.push_back(*value);
        if (comma == std::string_view::npos) return values;
        text.remove_prefix(comma + 1);
    }
}

std::optional<std::pair<int, int>> size_from(std::string_view text) {
    const auto x = text.find('x');
    if (x == std::string_view::npos) return std::nullopt;
    const auto width = whole_text<int>(text.substr(0, x)), height = whole_text<int>(text.substr(x + 1));
    if (!width || !height || *width < 1 || *height < 1) return std::nullopt;
    return std::pair(*width, *height);
}

Result<NumberedName> NumberedName::parse(const std::string& text) {
    NumberedName name;
    name.text_ = text;
    for (std::size_t i = text.find('%'); i != std::string::npos; i = text.find('%', i + 1)) {
        std::size_t end = i + 1;
        while (end < text.size() && is_digit(text[end])) ++end;
        const char kind = end < text.size() ? text[end] : '\0';
        if (kind == 'd' && !name.has_number() && end - i <= 3) {
            name.number_at_ = i;
            name.number_length_ = end + 1 - i;
            name.digits_ = end > i + 1 ? std::stoi(text.substr(i + 1, end - i - 1)) : 0;
        } else if (kind == 't' && end == i + 1 && !name.has_time()) {
            name.time_at_ = i;
        } else {
            return usage_error(
                fmt::format("'{}': a name may hold one frame number such as %04d and one time %t, nothing else after '%'.", text));
        }
    }
    return name;
}

std::string NumberedName::with(int number, double time_s) const {
    std::string out;
    for (std::size_t i = 0; i < text_.size();) {
        if (i == number_at_) {
            out += fmt::format("{:0{}}", number, digits_);
            i += number_length_;
        } else if (i == time_at_) {
            out += fmt::format("{:g}", time_s);
            i += 2;
        } else {
            out += text_[i++];
        }
    }
    return out;
}

}  // namespace entoptic::app
