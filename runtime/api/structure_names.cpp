#include "runtime/api/structure_names.h"

#include "entoptic/XR_ENTOPTICX_scene_luminance.h"

#include <openxr/openxr_reflection.h>

namespace entoptic::runtime::api {

#define ENTOPTIC_NAME(name, number) \
    if (value == name) return #name;

const char* structure_name(XrStructureType value) {
    XR_LIST_ENUM_XrStructureType(ENTOPTIC_NAME) ENTOPTIC_XR_NEWER_STRUCTURES(ENTOPTIC_NAME);
    if (value == XR_TYPE_COMPOSITION_LAYER_SCENE_LUMINANCE_ENTOPTICX) return "XR_TYPE_COMPOSITION_LAYER_SCENE_LUMINANCE_ENTOPTICX";
    return nullptr;
}

const char* result_name(XrResult value) {
    XR_LIST_ENUM_XrResult(ENTOPTIC_NAME) ENTOPTIC_XR_NEWER_RESULTS(ENTOPTIC_NAME);
    return nullptr;
}

#undef ENTOPTIC_NAME

}  // namespace entoptic::runtime::api
