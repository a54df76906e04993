// Results and errors of everything inside the C ABI. No exception crosses a room's border.
#pragma once

#include <string>
#include <tl/expected.hpp>

namespace entoptic {

// What kind of failure this is; `entoptic` turns it into its exit code (design: 1 failed, 2 usage, 3 missing).
enum class ErrorKind { failed = 1, usage = 2, missing = 3 };

// An error says what happened, where, and what to do next, in one or two plain sentences.
struct Error {
    ErrorKind kind = ErrorKind::failed;
    std::string message;
};

template <class T> using Result = tl::expected<T, Error>;

inline tl::unexpected<Error> failure(std::string message) { return tl::make_unexpected(Error{ErrorKind::failed, std::move(message)}); }
inline tl::unexpected<Error> usage_error(std::string message) { return tl::make_unexpected(Error{ErrorKind::usage, std::move(message)}); }
inline tl::unexpected<Error> missing(std::string message) { return tl::make_unexpected(Error{ErrorKind::missing, std::move(message)}); }
inline tl::unexpected<Error> forward_error(Error error) { return tl::make_unexpected(std::move(error)); }

}  // namespace entoptic

// Evaluates `expression` (a Result<T>), returns its error from the calling function, or declares `variable` with its value.
#define ENTOPTIC_TRY_CONCAT_(a, b) a##b
#define ENTOPTIC_TRY_NAME_(line) ENTOPTIC_TRY_CONCAT_(entoptic_try_, line)
#define ENTOPTIC_TRY(variable, expression)                                                                      \
    auto ENTOPTIC_TRY_NAME_(__LINE__) = (expression);                                                           \
    if (!ENTOPTIC_TRY_NAME_(__LINE__)) return ::entoptic::forward_error(std::move(ENTOPTIC_TRY_NAME_(__LINE__).error())); \
    auto variable = std::move(*ENTOPTIC_TRY_NAME_(__LINE__))
#define ENTOPTIC_CHECK(expression)                                                                              \
    if (auto entoptic_check = (expression); !entoptic_check) return ::entoptic::forward_error(std::move(entoptic_check.error()))
