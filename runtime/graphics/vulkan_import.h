// The compositor's memory as an image of another Vulkan device.
#pragma once

#include "runtime/graphics/vulkan_dispatch.h"

#include "interfaces/image_memory.h"
#include "runtime/objects/outcome.h"

#include <vector>

namespace entoptic::runtime::graphics {

// XR_ERROR_OUT_OF_MEMORY, XR_ERROR_RUNTIME_FAILURE.
Outcome failed(const char* what, VkResult result);

// Closes the file descriptors that nobody has taken over (set to -1).
struct Descriptors {
    std::vector<ImageMemory>& memories;
    ~Descriptors();
};

// An image of `memory`. What was made is written to `image` and `bound`, also when it fails: the caller destroys it. On success the file
// descriptor is the device's.
Outcome import_image(const DeviceDispatch& vk, VkDevice device, ImageMemory& memory, VkImage& image, VkDeviceMemory& bound);

}  // namespace entoptic::runtime::graphics
