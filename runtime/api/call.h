// Every function of the C ABI runs its body in call(): nothing thrown gets out, and every error is told to the messengers and the log.
#pragma once

#include "runtime/objects/handle_table.h"
#include "runtime/objects/outcome.h"
#include "runtime/openxr.h"

#include <new>

namespace entoptic::runtime::api {

void report_error(const char* function, std::uint64_t handle, const Outcome& outcome) noexcept;

template <class Handle, class Body> XrResult call(const char* function, Handle handle, Body&& body) noexcept {
    try {
        const Outcome outcome = body();
        if (outcome.failed()) report_error(function, handle_value(handle), outcome);
        return outcome.code();
    } catch (const std::bad_alloc&) {
        report_error(function, handle_value(handle), Outcome(XR_ERROR_OUT_OF_MEMORY));
        return XR_ERROR_OUT_OF_MEMORY;
    } catch (...) {
        report_error(function, handle_value(handle), Outcome(XR_ERROR_RUNTIME_FAILURE));
        return XR_ERROR_RUNTIME_FAILURE;
    }
}

}  // namespace entoptic::runtime::api
