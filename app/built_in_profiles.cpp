// Applications and libraries that need something of the runtime, by the names that they give themselves.
#include "app/config.h"

namespace entoptic::app {

std::span<const BuiltInProfile> built_in_profiles() {
    static constexpr BuiltInProfile table[] = {
        {"gxr", R"(# gxr 0.15 (Debian 12) leaves the XrViewConfigurationView that it has enumerated as malloc gave them.
quirks = ["untyped_arrays"]
[match]
engine = "gxr"
)"},
    };
    return table;
}

}  // namespace entoptic::app
