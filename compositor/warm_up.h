// The first shader of a process.
#pragma once

#include "gpu/device.h"

namespace entoptic::compositor {

// Compiles and runs a shader that does nothing, and waits for it (errors: as of gpu::Commands). A driver that compiles with LLVM (lavapipe)
// registers LLVM's exit handlers by its first compilation. Whoever registers a handler that stops the compositor must do so after this
// call: handlers run in the opposite order, and a frame whose shaders are being compiled while LLVM's objects are destroyed ends the process with SIGSEGV.
Result<void> warm_up(gpu::Device& device);

}  // namespace entoptic::compositor
