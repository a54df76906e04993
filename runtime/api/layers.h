// From composition layers as the application gives them to interfaces/layers.h: checked, located, and with their light in cd/m².
#pragma once

#include "interfaces/layers.h"
#include "runtime/objects/outcome.h"
#include "runtime/openxr.h"

#include <memory>
#include <vector>

namespace entoptic::runtime {
class Session;
}

namespace entoptic::runtime::api {

// Blocks until the application's GPU work on the images has finished. Layers whose space cannot be located are left out.
Outcome resolve_layers(const std::shared_ptr<Session>& session, const XrFrameEndInfo& info, std::vector<Layer>& layers);

}  // namespace entoptic::runtime::api
