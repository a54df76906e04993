#include "runtime/objects/instance.h"

#include <algorithm>

namespace entoptic::runtime {

bool Instance::enabled(std::string_view extension) const {
    return std::find(application_.extensions.begin(), application_.extensions.end(), extension) != application_.extensions.end();
}

}  // namespace entoptic::runtime
