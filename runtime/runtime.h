// The OpenXR runtime's door: everything else is reached through xrGetInstanceProcAddr.
#pragma once

#include "interfaces/runtime_host.h"
#include "runtime/loader_interface.h"

namespace entoptic::runtime {

// Answers the loader's xrNegotiateLoaderRuntimeInterface. `factory` is remembered and called once per xrCreateInstance.
// XR_ERROR_INITIALIZATION_FAILED when the loader and this runtime have no interface or API version in common.
XrResult negotiate(const XrNegotiateLoaderInfo* loader_info, XrNegotiateRuntimeRequest* request, RuntimeHostFactory factory) noexcept;

// xrGetInstanceProcAddr itself, as negotiate() hands it to the loader.
XrResult XRAPI_CALL get_instance_proc_addr(XrInstance instance, const char* name, PFN_xrVoidFunction* function);

}  // namespace entoptic::runtime
