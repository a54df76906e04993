#include "runtime/api/structure_names.h"

#include "entoptic/XR_ENTOPTICX_observer.h"
#include "entoptic/XR_ENTOPTICX_presentation_timing.h"
#include "entoptic/XR_ENTOPTICX_scene_luminance.h"

#include <openxr/openxr_reflection.h>

namespace entoptic::runtime::api {

#define ENTOPTIC_NAME(name, number) \
    if (value == name) return #name;

const char* structure_name(XrStructureType value) {
    XR_LIST_ENUM_XrStructureType(ENTOPTIC_NAME) ENTOPTIC_XR_NEWER_STRUCTURES(ENTOPTIC_NAME);
    ENTOPTIC_NAME(XR_TYPE_COMPOSITION_LAYER_SCENE_LUMINANCE_ENTOPTICX, 0)
    ENTOPTIC_NAME(XR_TYPE_OBSERVER_GET_INFO_ENTOPTICX, 0)
    ENTOPTIC_NAME(XR_TYPE_OBSERVER_ENTOPTICX, 0)
    ENTOPTIC_NAME(XR_TYPE_OBSERVER_DETAIL_ENTOPTICX, 0)
    ENTOPTIC_NAME(XR_TYPE_PRESENTATION_TIMING_GET_INFO_ENTOPTICX, 0)
    return nullptr;
}

const char* result_name(XrResult value) {
    XR_LIST_ENUM_XrResult(ENTOPTIC_NAME) ENTOPTIC_XR_NEWER_RESULTS(ENTOPTIC_NAME);
    return nullptr;
}

#undef ENTOPTIC_NAME

}  // namespace entoptic::runtime::api
