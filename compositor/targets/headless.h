// Shows nothing: for dumps, tests and machines without a display.
#pragma once

#include "compositor/targets/target.h"

#include <memory>

namespace entoptic::compositor {

std::unique_ptr<DisplayTarget> make_headless_target();

}  // namespace entoptic::compositor
