#include "app/simulation/simulator.h"

#include <fmt/format.h>

namespace entoptic::app {
namespace {

class GpuSimulator final : public Simulator {
public:
    static Result<std::unique_ptr<Simulator>> create(gpu::Device& device, const SimulatorOptions& options) {
        ENTOPTIC_CHECK(check_size(device, options.geometry));
        auto simulator = std::make_unique<GpuSimulator>();
        ENTOPTIC_TRY(stage, perception::Stage::create(device, {{options.geometry}, options.display, options.selection, options.seed}));
        ENTOPTIC_TRY(commands, gpu::Commands::create(device, "simulate"));
        simulator->stage_ = std::move(stage);
        simulator->commands_ = std::move(commands);
        simulator->device_ = fmt::format("{} ({})", device.name(), device.driver());
        return simulator;
    }
    void set_adaptation(double cd_m2) override { stage_->set_adaptation(static_cast<float>(cd_m2)); }
    Result<void> frame(const ImageF& scene, const ImageF& depth, const perception::FrameInput& input, bool want_picture) override {
        ENTOPTIC_CHECK(commands_.begin());
        ENTOPTIC_CHECK(stage_->record_ingest(commands_, {&scene, 1}, {&depth, depth.data.empty() ? 0u : 1u}));
        stage_->record(commands_, input);
        if (want_picture) ENTOPTIC_CHECK(stage_->record_download(commands_, 0));
        ENTOPTIC_CHECK(commands_.submit());
        ENTOPTIC_CHECK(commands_.wait());
        if (want_picture) picture_ = stage_->downloaded(0);
        return {};
    }
    ImageF picture() const override { return picture_; }
    perception::ViewOutcome view() const override { return stage_->view(0); }
    perception::EyeInput eye() const override { return stage_->input().eyes[0]; }
    std::vector<perception::EffectOutcome> effects() const override { return stage_->effects(); }
    std::string device() const override { return device_; }

private:
    // The stage keeps four floats a pixel in one buffer, and the guaranteed group counts end at 65535.
    static Result<void> check_size(const gpu::Device& device, const EyeGeometry& g) {
        VkPhysicalDeviceProperties properties{};
        vkGetPhysicalDeviceProperties(device.physical(), &properties);
        const std::uint64_t most = std::min<std::uint64_t>(properties.limits.maxStorageBufferRange / sizeof(vec4), 65535ull * 256);
        const std::uint64_t pixels = std::uint64_t(g.width) * g.height;
        if (pixels <= most) return {};
        int k = 2;
        while (pixels / std::uint64_t(k * k) > most) ++k;
        return failure(fmt::format("The picture has {} x {} pixels; {} can work on {:.1f} million at once. Add --downscale {}.", g.width,
                                   g.height, device.name(), double(most) * 1e-6, k));
    }

    std::unique_ptr<perception::Stage> stage_;
    gpu::Commands commands_;
    ImageF picture_;
    std::string device_;
};

}  // namespace

Result<std::unique_ptr<Simulator>> make_gpu_simulator(gpu::Device& device, const SimulatorOptions& options) {
    return GpuSimulator::create(device, options);
}

}  // namespace entoptic::app
