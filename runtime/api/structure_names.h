// Names of enumerants, those of the headers and the newer ones of runtime/openxr_1_1.h and of our own extensions.
#pragma once

#include "runtime/openxr.h"

namespace entoptic::runtime::api {

// "XR_TYPE_VIEW"; null for a number that is no structure type.
const char* structure_name(XrStructureType type);
// "XR_ERROR_HANDLE_INVALID"; null for an unknown one.
const char* result_name(XrResult result);

}  // namespace entoptic::runtime::api
