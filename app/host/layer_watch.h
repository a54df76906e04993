// Frames on their way from the runtime to the compositor, watched: which luminance their layers really had.
#pragma once

#include "interfaces/frame_service.h"

#include <mutex>
#include <optional>

namespace entoptic::app {

// Passes everything on to `service`, which must outlive it.
class LayerWatch final : public FrameService {
public:
    explicit LayerWatch(FrameService& service) : service_(service) {}
    // Of the first layer of the last frame that had one.
    std::optional<LayerLuminance> luminance() const {
        const std::lock_guard lock(mutex_);
        return luminance_;
    }

    std::array<std::uint8_t, 16> device_uuid() const override { return service_.device_uuid(); }
    std::array<std::uint8_t, 16> driver_uuid() const override { return service_.driver_uuid(); }
    std::vector<std::int64_t> swapchain_formats() const override { return service_.swapchain_formats(); }
    Result<SwapchainAllocation> create_swapchain(const SwapchainRequest& request) override { return service_.create_swapchain(request); }
    void destroy_swapchain(std::uint64_t id) override { service_.destroy_swapchain(id); }
    bool wait_image_idle(std::uint64_t swapchain, std::uint32_t image_index, DurationNs timeout) override {
        return service_.wait_image_idle(swapchain, image_index, timeout);
    }
    void begin_session() override { service_.begin_session(); }
    void end_session() override { service_.end_session(); }
    FrameTiming wait_frame() override { return service_.wait_frame(); }
    void begin_frame(std::uint64_t frame_id) override { service_.begin_frame(frame_id); }
    void submit_frame(FrameSubmission frame) override {
        if (!frame.layers.empty()) {
            const std::lock_guard lock(mutex_);
            luminance_ = frame.layers.front().luminance;
        }
        service_.submit_frame(std::move(frame));
    }
    void discard_frame(std::uint64_t frame_id) override { service_.discard_frame(frame_id); }
    bool exit_wanted() const override { return service_.exit_wanted(); }
    std::optional<std::array<float, 2>> adaptation_cd_m2() const override { return service_.adaptation_cd_m2(); }
    std::vector<PresentationRecord> presentation_records(std::size_t count) const override { return service_.presentation_records(count); }
    void add_cpu_time(const std::string& stage, double ms) override { service_.add_cpu_time(stage, ms); }

private:
    FrameService& service_;
    mutable std::mutex mutex_;
    std::optional<LayerLuminance> luminance_;
};

}  // namespace entoptic::app
