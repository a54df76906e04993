// For tests and benches: one Vulkan device a process, and a model run on an image in a few lines. Header-only, not in the library.
#pragma once

#include "gpu/testing/validation_guard.h"
#include "perception/gate.h"
#include "perception/stage.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include <memory>
#include <stdexcept>

namespace entoptic::perception::testing {

// The process's device. Under ENTOPTIC_TEST_VALIDATION=1 with the validation layer; ValidationGuard fails on any message.
inline gpu::Device& device() {
    static std::unique_ptr<gpu::Device> instance = [] {
        gpu::DeviceOptions options;
        options.validation = std::getenv("ENTOPTIC_TEST_VALIDATION") != nullptr;
        auto made = gpu::Device::create(options);
        if (!made) throw std::runtime_error(made.error().message);
        return std::move(*made);
    }();
    return *instance;
}

// Register once a test program:  const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
class ValidationGuard : public gpu::testing::ValidationGuard {
public:
    ValidationGuard() : gpu::testing::ValidationGuard(&device) {}
};

// A flat picture `width` x `height` of `hfov_deg` horizontally, square pixels on the tangent plane.
inline EyeGeometry rectilinear(int width, int height, double hfov_deg) {
    EyeGeometry g{};
    g.kind = geometry_rectilinear;
    g.width = static_cast<uint>(width);
    g.height = static_cast<uint>(height);
    const double half = std::tan(hfov_deg * 0.5 * 3.14159265358979323846 / 180);
    g.tan_right = static_cast<float>(half);
    g.tan_left = -g.tan_right;
    g.tan_up = static_cast<float>(half * height / width);
    g.tan_down = -g.tan_up;
    return g;
}

template <class T> T value(Result<T> result) {
    if (!result) throw std::runtime_error(result.error().message);
    return std::move(*result);
}
inline void check(Result<void> result) {
    if (!result) throw std::runtime_error(result.error().message);
}

// "glare=luidolt_spectral" etc. on top of preset off.
inline Selection only(const std::vector<std::string>& models, const std::vector<std::string>& settings = {}) {
    return value(select("off", models, settings));
}

inline FrameInput still_input(std::size_t views, double dt_s = 1.0 / 90, bool snap = true) {
    FrameInput input;
    input.dt_s = dt_s;
    input.snap = snap;
    input.eyes.resize(views);
    return input;
}

// A stage over given geometry that takes and gives CPU images, frame by frame.
class StageRunner {
public:
    StageRunner(std::vector<EyeGeometry> views, Selection selection, DisplayRange display = {})
        : stage_(value(Stage::create(device(), {std::move(views), display, std::move(selection), 1}))),
          commands_(value(gpu::Commands::create(device(), "test"))) {}

    // One frame: ingest, statistics, models. Returns what comes out of each view. `depths` as in Stage::record_ingest(), metres.
    std::vector<ImageF> run(const std::vector<ImageF>& pictures, const FrameInput& input, const std::vector<ImageF>& depths = {}) {
        check(commands_.begin());
        check(stage_->record_ingest(commands_, pictures, depths));
        stage_->record(commands_, input);
        for (std::uint32_t v = 0; v < stage_->views(); ++v) check(stage_->record_download(commands_, v));
        check(commands_.submit());
        check(commands_.wait());
        stage_->accumulate_totals();
        std::vector<ImageF> out;
        for (std::uint32_t v = 0; v < stage_->views(); ++v) out.push_back(stage_->downloaded(v));
        return out;
    }
    ImageF run(const ImageF& picture, const FrameInput& input) { return run(std::vector<ImageF>{picture}, input)[0]; }
    ImageF run(const ImageF& picture, const FrameInput& input, const ImageF& depth) {
        return run(std::vector<ImageF>{picture}, input, std::vector<ImageF>{depth})[0];
    }

    Stage& stage() { return *stage_; }
    gpu::Commands& commands() { return commands_; }   // stage_times() of the last frame

private:
    std::unique_ptr<Stage> stage_;
    gpu::Commands commands_;
};

}  // namespace entoptic::perception::testing
