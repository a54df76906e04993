#include "compositor/warm_up.h"

#include "compositor/warm_up.comp.h"
#include "gpu/commands.h"

namespace entoptic::compositor {

Result<void> warm_up(gpu::Device& device) {
    ENTOPTIC_TRY(kernel, gpu::Kernel::create(device, {"warm up", warm_up_comp_spv, {}, 0, {}}));
    ENTOPTIC_TRY(commands, gpu::Commands::create(device, "warm up"));
    ENTOPTIC_CHECK(commands.begin());
    commands.dispatch(kernel, std::span<const gpu::Binding>{}, {}, {1, 1, 1});
    ENTOPTIC_CHECK(commands.submit());
    return commands.wait();
}

}  // namespace entoptic::compositor
