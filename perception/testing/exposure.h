// For tests: a tone model that only plans, an exposure up to the panel's white, and leaves the picture as it is. What models before `tone`
// do with a brightened picture can then be seen in scene light. Header-only.
#pragma once

#include "perception/model.h"
#include "perception/observer_state.h"
#include "perception/preset.h"
#include "perception/tone_curve.glsl"

#include <algorithm>
#include <cmath>

namespace entoptic::perception::testing {

inline ToneCurve exposure_curve(float exposure, DisplayRange display) {
    ToneCurve curve{};
    curve.exposure = exposure;
    curve.straight_until_cd_m2 = curve.scene_white_cd_m2 = display.white_cd_m2 / exposure;
    for (uint i = 0; i < tone_points; ++i) {
        const double log10_y = static_cast<double>(i) / tone_points_per_decade - 6 + std::log10(static_cast<double>(exposure));
        curve.log10_displayed[i] = static_cast<float>(std::min(log10_y, std::log10(static_cast<double>(display.white_cd_m2))));
    }
    return curve;
}

class ExposureTone final : public Model, public PlansTone {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) { return std::make_unique<ExposureTone>(context.display); }
    explicit ExposureTone(DisplayRange display) : display_(display) {}
    void set_parameters(std::span<const float> v) override { exposure_ = v[0]; }
    Result<void> plan(StageIo& io) override {
        // The state is host-visible, and the batch has not been submitted yet.
        for (ObserverState& state : io.state.as<ObserverState>()) state.tone = exposure_curve(exposure_, display_);
        return {};
    }
    Result<void> record(StageIo&) override { return {}; }

private:
    DisplayRange display_;
    float exposure_ = 1;
};

inline Selection with_exposure(Selection selection, float exposure) {
    static constexpr ParameterInfo parameters[] = {{"exposure", "1", 1e-6f, 1e6f, 1, "choice: for tests", "displayed over scene luminance"}};
    static const ModelEntry entry{"tone", "exposure", "for tests", parameters, &ExposureTone::create, nullptr};
    const auto after = std::find_if(selection.choices.begin(), selection.choices.end(), [](const Choice& c) { return c.entry->slot == "tone"; });
    selection.choices.insert(after, {&entry, {exposure}});
    return selection;
}

// For the references' ReferenceFrame::displayed.
inline std::function<double(double)> exposed(double exposure, DisplayRange display = {}) {
    return [=](double y) { return std::min(exposure * y, static_cast<double>(display.white_cd_m2)); };
}

// Colours of a picture in scene light as the panel shows them at this exposure.
template <class T> ImageD on_panel(const Image<T>& picture, double exposure, DisplayRange display = {}) {
    ImageD out = convert<double>(picture);
    for (double& v : out.data)
        v = std::clamp(v * exposure, static_cast<double>(display.black_cd_m2), static_cast<double>(display.white_cd_m2));
    return out;
}

}  // namespace entoptic::perception::testing
