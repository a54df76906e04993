#include "runtime/objects/views.h"

#include <algorithm>
#include <cmath>

namespace entoptic::runtime {

namespace {

constexpr XrViewConfigurationType offered[] = {XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO,
                                               XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO_WITH_FOVEATED_INSET};

// choice: 15 degrees to each side. The fovea and parafovea reach to 4 degrees from the gaze; the rest takes the error of the tracker, the
// way the eye moves within a frame's delay, and the fall of acuity to what the outer view's density shows.
constexpr float inset_half_tangent = 0.268f;
// choice: the outer views of four have half the density of an eye's view that has to show everything.
constexpr float outer_scale = 0.5f;

struct Tangents {
    float left, right, up, down;
};
Tangents tangents(const Fov& fov) {
    return {std::tan(fov.angle_left), std::tan(fov.angle_right), std::tan(fov.angle_up), std::tan(fov.angle_down)};
}
Fov angles(const Tangents& t) { return {std::atan(t.left), std::atan(t.right), std::atan(t.up), std::atan(t.down)}; }

// An interval of half-width inset_half_tangent about `centre`, moved until it lies within [low, high].
void place(float centre, float low, float high, float& from, float& to) {
    const float half = std::min(inset_half_tangent, (high - low) / 2);
    const float middle = std::clamp(centre, low + half, high - half);
    from = std::max(middle - half, low);
    to = std::min(middle + half, high);
}

// Tangents of the direction in which an eye looks, in its view; 0 straight ahead.
glm::vec2 gaze_tangents(Headset& headset, std::size_t eye, TimeNs time) {
    if (!headset.eye_tracker || !headset.eye_tracker->present()) return glm::vec2(0);
    const EyeState state = headset.eye_tracker->observer_at(time).eyes[eye];
    if (state.gaze_provenance == Provenance::absent) return glm::vec2(0);
    const glm::vec3 direction = headset.eyes[eye].head_from_eye.inverse().rotate(state.gaze_direction);
    return direction.z < -0.1f ? glm::vec2(direction.x, direction.y) / -direction.z : glm::vec2(0);
}

Fov inset_fov(Headset& headset, std::size_t eye, TimeNs time) {
    const Tangents whole = tangents(headset.eyes[eye].fov);
    const glm::vec2 gaze = gaze_tangents(headset, eye, time);
    Tangents inset{};
    place(gaze.x, whole.left, whole.right, inset.left, inset.right);
    place(gaze.y, whole.down, whole.up, inset.down, inset.up);
    return angles(inset);
}

std::uint32_t scaled(std::uint32_t texels, float by) { return std::max(1u, static_cast<std::uint32_t>(std::lround(float(texels) * by))); }

}  // namespace

std::span<const XrViewConfigurationType> view_configurations(Features enabled) {
    return std::span(offered).first(available(feature_1_1 | feature_quad_views, enabled) ? 2 : 1);
}

std::size_t view_count(XrViewConfigurationType type) { return type == XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO ? 2 : 4; }

ViewSize recommended_view_size(const RuntimeHost& host, XrViewConfigurationType type, std::size_t view, Headset& headset) {
    ViewSize eye;
    host.recommended_eye_size(eye.width, eye.height);
    if (view_count(type) == 2) return eye;
    if (view < 2) return {scaled(eye.width, outer_scale), scaled(eye.height, outer_scale)};
    const Tangents whole = tangents(headset.eyes[view - 2].fov);
    return {scaled(eye.width, std::min(1.0f, 2 * inset_half_tangent / (whole.right - whole.left))),
            scaled(eye.height, std::min(1.0f, 2 * inset_half_tangent / (whole.up - whole.down)))};
}

std::array<Fov, most_views> view_fovs(Headset& headset, XrViewConfigurationType type, TimeNs time) {
    std::array<Fov, most_views> fovs{headset.eyes[0].fov, headset.eyes[1].fov, {}, {}};
    if (view_count(type) == most_views) {
        fovs[2] = inset_fov(headset, 0, time);
        fovs[3] = inset_fov(headset, 1, time);
    }
    return fovs;
}

}  // namespace entoptic::runtime
