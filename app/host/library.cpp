// libopenxr_entoptic.so: the one symbol that the OpenXR loader looks for.
#include "app/host/host.h"
#include "runtime/runtime.h"

extern "C" __attribute__((visibility("default"))) XrResult xrNegotiateLoaderRuntimeInterface(const XrNegotiateLoaderInfo* loader_info,
                                                                                             XrNegotiateRuntimeRequest* request) {
    return entoptic::runtime::negotiate(loader_info, request, &entoptic::app::make_host);
}
