#include "runtime/api/paths.h"

namespace entoptic::runtime::api {

Outcome to_user_path(Instance& instance, XrPath path, UserPath& user) {
    std::string text;
    ENTOPTIC_XR_TRY(instance.paths().to_string(path, text));
    const auto parsed = parse_user_path(text);
    const bool allowed = parsed && (*parsed != UserPath::eyes || instance.has(feature_eye_gaze));
    if (!allowed) return error(XR_ERROR_PATH_UNSUPPORTED, "{} is not a top level user path", text);
    user = *parsed;
    return XR_SUCCESS;
}

Outcome find_interaction_profile(Instance& instance, XrPath path, const Profile*& profile) {
    std::string text;
    ENTOPTIC_XR_TRY(instance.paths().to_string(path, text));
    profile = find_profile(text);
    if (profile && instance.has(profile->needs)) return XR_SUCCESS;
    return error(XR_ERROR_PATH_UNSUPPORTED, "{} is not an interaction profile of this version of OpenXR or of an enabled extension", text);
}

}  // namespace entoptic::runtime::api
