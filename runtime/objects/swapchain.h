// XrSwapchain: the order of acquire, wait and release, and which image a layer shows. Thread-safe.
#pragma once

#include "runtime/objects/graphics.h"
#include "runtime/objects/handle_table.h"

#include <deque>
#include <mutex>
#include <optional>
#include <vector>

namespace entoptic::runtime {

class Session;

class Swapchain final : public Object {
public:
    Swapchain(std::shared_ptr<Session> session, const XrSwapchainCreateInfo& info, std::uint64_t id,
              std::unique_ptr<SwapchainImages> images);
    ~Swapchain() override;
    Instance& instance() override;
    // Gives the application's images back and the memory to the compositor, which keeps it while a frame shows it.
    void retire() override;

    std::uint32_t image_count() const { return image_count_; }
    Outcome enumerate(XrSwapchainImageBaseHeader* images);
    // The next image in turn. XR_ERROR_CALL_ORDER_INVALID when all are acquired, or for a second time of a static one.
    Outcome acquire(std::uint32_t& index);
    // The oldest acquired image; XR_TIMEOUT_EXPIRED while the compositor still reads it. Blocks without a lock.
    Outcome wait(XrDuration timeout);
    // The waited image.
    Outcome release();

    // The image a layer of this frame shows: the one released last, once its GPU work has finished. XR_ERROR_LAYER_INVALID when none was.
    Outcome take_for_layer(std::uint32_t& index);

    const std::shared_ptr<Session>& session() const { return session_; }
    const XrSwapchainCreateInfo& info() const { return info_; }
    std::uint64_t id() const { return id_; }  // FrameService's

private:
    struct Acquired {
        std::uint32_t index = 0;
        bool handed_over = false;  // the images' acquire() has been done
    };
    bool all_acquired() const { return acquired_.size() + (waited_ ? 1u : 0u) >= image_count_; }

    const std::shared_ptr<Session> session_;
    const XrSwapchainCreateInfo info_;
    const std::uint64_t id_;
    const std::uint32_t image_count_;

    std::mutex mutex_;
    std::shared_ptr<SwapchainImages> images_;  // null after retire()
    std::deque<Acquired> acquired_;            // not yet waited for, oldest first
    std::optional<std::uint32_t> waited_;      // waited for and not yet released
    std::optional<std::uint32_t> last_released_;
    std::uint32_t next_ = 0;
    bool waiting_ = false;
    bool static_used_ = false;
};

}  // namespace entoptic::runtime
