// The images of one swapchain as textures of the driver's own, for drivers that cannot share the compositor's memory: release() reads the
// texture into the CPU's memory, and a Vulkan device of the runtime's own copies that into the compositor's image. It blocks until the
// application's drawing has ended; each copy's time goes to the report as the CPU time of the stage `copy`.
#pragma once

#include "runtime/graphics/opengl_device.h"

namespace entoptic::runtime::graphics {

// Takes over the file descriptors, also when it fails.
Outcome make_opengl_copies(std::shared_ptr<OpenGlShared> shared, std::vector<ImageMemory> memories,
                           std::unique_ptr<SwapchainImages>& images);

}  // namespace entoptic::runtime::graphics
