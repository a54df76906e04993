// The images of one swapchain as textures on the compositor's memory.
//
// OpenGL keeps a texture's layout to itself, and no driver that runs here exports semaphores: release() sets a fence, and xrEndFrame waits
// for it before the compositor may read. The compositor has done with an image before acquire() gives it out.
#pragma once

#include "runtime/graphics/opengl_device.h"

#include <mutex>
#include <vector>

namespace entoptic::runtime::graphics {

class OpenGlImages final : public SwapchainImages {
public:
    explicit OpenGlImages(std::shared_ptr<OpenGlShared> shared) : shared_(std::move(shared)) {}
    ~OpenGlImages() override;

    // Once. Takes over the file descriptors, also when it fails.
    Outcome import(std::vector<ImageMemory> memories);

    std::uint32_t count() const override { return static_cast<std::uint32_t>(textures_.size()); }
    Outcome enumerate(XrSwapchainImageBaseHeader* images) const override { return enumerate_textures(textures_, images); }
    Outcome acquire(std::uint32_t) override { return XR_SUCCESS; }
    Outcome release(std::uint32_t index) override;
    Outcome wait_released(std::uint32_t index) override;

private:
    Outcome import_one(ImageMemory& memory);
    void forget_fence(std::uint32_t index);  // with mutex_

    const std::shared_ptr<OpenGlShared> shared_;
    std::vector<GLuint> memories_, textures_;
    std::mutex mutex_;
    std::vector<GLsync> released_;  // with mutex_; null: nothing to wait for
};

}  // namespace entoptic::runtime::graphics
