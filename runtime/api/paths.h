// Paths that an application gives, as what they name.
#pragma once

#include "runtime/objects/instance.h"
#include "runtime/objects/interaction_profiles.h"
#include "runtime/objects/outcome.h"

namespace entoptic::runtime::api {

// A top level user path this application may use. XR_ERROR_PATH_INVALID, XR_ERROR_PATH_UNSUPPORTED.
Outcome to_user_path(Instance& instance, XrPath path, UserPath& user);
// An interaction profile of the application's version or of an enabled extension. XR_ERROR_PATH_INVALID, XR_ERROR_PATH_UNSUPPORTED.
Outcome find_interaction_profile(Instance& instance, XrPath path, const Profile*& profile);

}  // namespace entoptic::runtime::api
