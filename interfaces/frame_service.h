// The link between the OpenXR runtime and the compositor. Everything that crosses it is plain data and file descriptors, so a
// service process can take the compositor's side later without a second path. Thread-safe.
#pragma once

#include "base/result.h"
#include "interfaces/image_memory.h"
#include "interfaces/layers.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace entoptic {

struct SwapchainRequest {
    std::uint32_t vk_format = 0;
    std::uint32_t width = 0, height = 0, array_layers = 1, mip_levels = 1, samples = 1;
    std::uint32_t vk_usage = 0;      // what the application asked for; the compositor adds SAMPLED and TRANSFER_SRC
    std::uint32_t vk_create_flags = 0;  // VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT, VK_IMAGE_CREATE_CUBE_COMPATIBLE_BIT (six layers a cube)
    bool is_static = false;          // one image only
};

struct SwapchainAllocation {
    std::uint64_t id = 0;
    std::vector<ImageMemory> images;   // 1 when static, else 3; their fds belong to the caller
};

struct FrameTiming {
    std::uint64_t frame_id = 0;
    TimeNs predicted_display_time = 0;   // middle of the light of the frame, in the session's clock
    DurationNs period = 0;
    bool should_render = true;
};

// What became of a frame: the data model behind XR_ENTOPTICX_presentation_timing.
struct PresentationRecord {
    std::uint64_t frame_id = 0;
    TimeNs predicted_display_time = 0;   // what wait_frame() told
    TimeNs submitted_time = 0;           // when xrEndFrame arrived; 0 if never
    TimeNs display_time = 0;             // middle of its first light; 0 if never shown
    std::uint32_t refreshes_shown = 0;   // 0 never, 1 once, more: shown again, reprojected
};

class FrameService {
public:
    virtual ~FrameService() = default;

    // Identity of the device the swapchain images live on: the application must use the same one.
    virtual std::array<std::uint8_t, 16> device_uuid() const = 0;
    virtual std::array<std::uint8_t, 16> driver_uuid() const = 0;

    // VkFormats that create_swapchain accepts, preferred first (as integers).
    virtual std::vector<std::int64_t> swapchain_formats() const = 0;
    virtual Result<SwapchainAllocation> create_swapchain(const SwapchainRequest& request) = 0;
    // Frames already submitted that use it are finished first; the image memory goes with the last of them.
    virtual void destroy_swapchain(std::uint64_t id) = 0;
    // Waits until no submitted or shown frame reads this image any more. False when `timeout` passed first.
    virtual bool wait_image_idle(std::uint64_t swapchain, std::uint32_t image_index, DurationNs timeout) = 0;

    // Between begin_session() and end_session() frames flow and the display shows them.
    virtual void begin_session() = 0;
    virtual void end_session() = 0;
    // Blocks for pacing (xrWaitFrame) and predicts the next frame's display time. Calls must alternate with begin_frame().
    virtual FrameTiming wait_frame() = 0;
    // The application starts to render frame `frame_id` (xrBeginFrame).
    virtual void begin_frame(std::uint64_t frame_id) = 0;
    // The application's frame is complete: its GPU work has finished (the runtime waited for it). Does not block on composition.
    virtual void submit_frame(FrameSubmission frame) = 0;
    // Frame `frame_id` was begun but will never be submitted.
    virtual void discard_frame(std::uint64_t frame_id) = 0;
    // True once the configured number of frames has been displayed or the user closed the window: the session should stop.
    virtual bool exit_wanted() const = 0;
    // What each eye of the simulated observer is adapted to, cd/m², at the last frame shown. Nothing when nothing is simulated.
    virtual std::optional<std::array<float, 2>> adaptation_cd_m2() const { return std::nullopt; }
    // Records of the last frames, oldest first, at most `count`.
    virtual std::vector<PresentationRecord> presentation_records(std::size_t count) const = 0;

    // The application's side spent `ms` of its own time on `stage` of a frame: for the report.
    virtual void add_cpu_time(const std::string& stage, double ms) {
        static_cast<void>(stage);
        static_cast<void>(ms);
    }
};

}  // namespace entoptic
