// What a session needs of the application's graphics API. runtime/graphics/ implements it; objects/ sees no Vulkan.
#pragma once

#include "interfaces/frame_service.h"
#include "runtime/objects/outcome.h"
#include "runtime/openxr.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace entoptic::runtime {

// The images of one swapchain, imported into the application's device. Not thread-safe but for wait_released().
// The destructor waits for the runtime's own GPU work on them and destroys them in the application's device.
class SwapchainImages {
public:
    virtual ~SwapchainImages() = default;
    virtual std::uint32_t count() const = 0;
    // Fills `count()` structures of the API's own type; XR_ERROR_VALIDATION_FAILURE when their type is wrong.
    virtual Outcome enumerate(XrSwapchainImageBaseHeader* images) const = 0;
    // Hands the image to the application: work it submits afterwards finds it in the layout the specification names.
    virtual Outcome acquire(std::uint32_t index) = 0;
    // Takes the image back after the work submitted so far.
    virtual Outcome release(std::uint32_t index) = 0;
    // Returns when the work up to release() has finished.
    virtual Outcome wait_released(std::uint32_t index) = 0;
};

class GraphicsDevice {
public:
    virtual ~GraphicsDevice() = default;
    // The graphics API's numbers of the formats that describe() takes, preferred first. `compositor` are FrameService::swapchain_formats().
    virtual std::vector<std::int64_t> formats(const std::vector<std::int64_t>& compositor) const = 0;
    // The first row of an image is its lowest (OpenGL). Faces of cubes are alike in all APIs.
    virtual bool bottom_up() const { return false; }
    // XR_ERROR_SWAPCHAIN_FORMAT_UNSUPPORTED, XR_ERROR_FEATURE_UNSUPPORTED, XR_ERROR_VALIDATION_FAILURE; else fills what is API specific:
    // format, usage and create flags.
    virtual Outcome describe(const XrSwapchainCreateInfo& info, SwapchainRequest& request) const = 0;
    // Takes over the file descriptors, also when it fails.
    virtual Outcome import(SwapchainAllocation allocation, std::unique_ptr<SwapchainImages>& images) = 0;
};

}  // namespace entoptic::runtime
