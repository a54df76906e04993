// XR_KHR_visibility_mask.
#include "runtime/objects/visibility_mask.h"

#include "runtime/api/call.h"
#include "runtime/api/functions.h"
#include "runtime/api/verify.h"
#include "runtime/objects/session.h"
#include "runtime/objects/views.h"

namespace entoptic::runtime::api {

namespace {

Outcome make_mask(const EyeOptics& optics, XrVisibilityMaskTypeKHR type, Mesh& mesh) {
    switch (type) {
        case XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR:
            mesh = hidden_area(optics);
            return XR_SUCCESS;
        case XR_VISIBILITY_MASK_TYPE_VISIBLE_TRIANGLE_MESH_KHR:
            mesh = visible_area(optics);
            return XR_SUCCESS;
        case XR_VISIBILITY_MASK_TYPE_LINE_LOOP_KHR:
            mesh = visible_border(optics);
            return XR_SUCCESS;
        default:
            return invalid("{} is not a visibility mask type", static_cast<int>(type));
    }
}

// Two arrays, one idiom: either capacity 0 asks for both counts.
Outcome write_mask(const Mesh& mesh, XrVisibilityMaskKHR& mask) {
    bool fill_vertices = false, fill_indices = false;
    if (mask.vertexCapacityInput == 0 || mask.indexCapacityInput == 0) {
        mask.vertexCountOutput = static_cast<std::uint32_t>(mesh.vertices.size());
        mask.indexCountOutput = static_cast<std::uint32_t>(mesh.indices.size());
        return XR_SUCCESS;
    }
    const Outcome vertices =
        two_call(mask.vertexCapacityInput, &mask.vertexCountOutput, mask.vertices, mesh.vertices.size(), fill_vertices);
    const Outcome indices = two_call(mask.indexCapacityInput, &mask.indexCountOutput, mask.indices, mesh.indices.size(), fill_indices);
    ENTOPTIC_XR_TRY(vertices);
    ENTOPTIC_XR_TRY(indices);
    for (std::size_t i = 0; fill_vertices && i < mesh.vertices.size(); ++i) mask.vertices[i] = {mesh.vertices[i].x, mesh.vertices[i].y};
    if (fill_indices) std::copy(mesh.indices.begin(), mesh.indices.end(), mask.indices);
    return XR_SUCCESS;
}

}  // namespace

XrResult XRAPI_CALL get_visibility_mask(XrSession handle, XrViewConfigurationType views, uint32_t view, XrVisibilityMaskTypeKHR type,
                                        XrVisibilityMaskKHR* mask) {
    return call("xrGetVisibilityMaskKHR", handle, [&]() -> Outcome {
        std::shared_ptr<Session> session;
        ENTOPTIC_XR_TRY(find(handle, session));
        ENTOPTIC_XR_TRY(check_view_configuration(session->instance(), views));
        if (view >= view_count(views)) return invalid("view {} is beyond the {} of this view configuration", view, view_count(views));
        ENTOPTIC_XR_TRY(require(mask, XR_TYPE_VISIBILITY_MASK_KHR, "visibilityMask"));
        // The lens hides nothing of an inset, which lies about the gaze: no mask for those.
        Mesh mesh;
        const EyeOptics& optics = session->host().headset().eyes[view % eye_count];
        ENTOPTIC_XR_TRY(make_mask(optics, type, mesh));
        if (view >= eye_count) mesh = {};
        return write_mask(mesh, *mask);
    });
}

}  // namespace entoptic::runtime::api
