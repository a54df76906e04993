// What the body of an OpenXR function comes to: a code and, for an error, a sentence that says what was wrong and what to do next.
// The sentence goes to the application's debug messengers and to the log.
#pragma once

#include <fmt/format.h>
#include <openxr/openxr.h>
#include <string>
#include <utility>

namespace entoptic::runtime {

class [[nodiscard]] Outcome {
public:
    Outcome() = default;
    Outcome(XrResult code) : code_(code) {}
    Outcome(XrResult code, std::string message) : code_(code), message_(std::move(message)) {}

    XrResult code() const { return code_; }
    bool failed() const { return XR_FAILED(code_); }
    const std::string& message() const { return message_; }

private:
    XrResult code_ = XR_SUCCESS;
    std::string message_;
};

template <class... Args> Outcome error(XrResult code, fmt::format_string<Args...> format, Args&&... args) {
    return {code, fmt::format(format, std::forward<Args>(args)...)};
}
template <class... Args> Outcome invalid(fmt::format_string<Args...> format, Args&&... args) {
    return {XR_ERROR_VALIDATION_FAILURE, fmt::format(format, std::forward<Args>(args)...)};
}

}  // namespace entoptic::runtime

// Returns from the calling function when `expression` (an Outcome) is an error.
#define ENTOPTIC_XR_TRY(expression)                                                                   \
    do {                                                                                              \
        if (::entoptic::runtime::Outcome outcome_ = (expression); outcome_.failed()) return outcome_; \
    } while (false)
