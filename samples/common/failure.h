// How the samples fail: one exception that carries the process's exit code, and a main() wrapper that prints it.
#pragma once

#include <cstdio>
#include <exception>
#include <functional>
#include <stdexcept>
#include <string>

namespace samples {

// The same codes as the `entoptic` command.
enum class ExitCode { done = 0, failed = 1, usage = 2, missing = 3 };

// What went wrong and what to do about it, in one or two sentences for a person.
class Failure : public std::runtime_error {
public:
    Failure(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ExitCode code() const { return code_; }

private:
    ExitCode code_;
};

// Runs `body` and turns exceptions into a line on standard error and an exit code.
inline int run_reporting_failures(const char* program, const std::function<int()>& body) {
    try {
        return body();
    } catch (const Failure& failure) {
        std::fprintf(stderr, "%s: %s\n", program, failure.what());
        return static_cast<int>(failure.code());
    } catch (const std::bad_alloc&) { std::fprintf(stderr, "%s: out of memory\n", program); } catch (const std::exception& error) {
        std::fprintf(stderr, "%s: %s\n", program, error.what());
    }
    return static_cast<int>(ExitCode::failed);
}

}  // namespace samples
