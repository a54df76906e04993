// For tests: what models that change a picture of scene light keep true, as functions that take the model's slot and name. Header-only.
#pragma once

#include "perception/testing/exposure.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"

#include <limits>

namespace entoptic::perception::testing {

// A textured picture of median luminance `light` with lamps (cd/m²), shown `exposure` times as bright.
struct PictureCase {
    std::string setting;
    EyeGeometry geometry;
    double light, lamp;
    float exposure;
    std::vector<std::string> settings;
};

// dE_ITP on the panel: the most that float may differ from the reference, and the least that the effect itself must do.
struct PictureTolerance {
    double p99, mean, least_effect_p99;
};

inline std::vector<EyeGeometry> odd_geometries(int width = 1011, int height = 27) {
    return {rectilinear(1, 1, 100), rectilinear(width, height, 104), rectilinear(33, 9, 0.2), vive_lens(90, 100)};
}

class PictureLaws {
public:
    PictureLaws(std::string slot, std::string model) : slot_(std::move(slot)), model_(std::move(model)) {}

    std::string name() const { return slot_ + "." + model_; }
    Selection selection(const std::vector<std::string>& settings = {}) const { return only({slot_ + "=" + model_}, settings); }
    std::vector<float> parameters(const std::vector<std::string>& settings = {}) const {
        return selection(settings).find(slot_)->parameters;
    }
    ImageD reference(const ImageF& picture, const EyeGeometry& g, const std::vector<float>& parameters, double exposure = 1,
                     double adaptation = 1, double dt_s = 0) const {
        ReferenceFrame frame{convert<double>(picture), g, {}, {}, dt_s, false, adaptation, 1};
        frame.displayed = exposed(exposure);
        find_model(slot_, model_)->create_reference()->apply(frame, parameters);
        return frame.image;
    }

    void gpu_is_the_reference(const PictureCase& c, const PictureTolerance& tolerance) const {
        const ImageF picture =
            through_lens(textured(static_cast<int>(c.geometry.width), static_cast<int>(c.geometry.height), c.light, c.lamp), c.geometry);
        const Selection chosen = with_exposure(selection(c.settings), c.exposure);
        const auto adaptation = static_cast<float>(c.light);
        const auto exposure = static_cast<double>(c.exposure);
        const double dt_s = 0.3;
        StageRunner runner({c.geometry}, chosen);
        runner.stage().set_adaptation(adaptation);
        ImageF gpu = runner.run(picture, still_input(1, dt_s));
        ImageD truth = reference(picture, c.geometry, chosen.find(slot_)->parameters, exposure, static_cast<double>(adaptation), dt_s);
        for (int y = 0; y < gpu.height; ++y)
            for (int x = 0; x < gpu.width; ++x)
                if (is_on_the_rim(c.geometry, x, y))
                    for (int k = 0; k < 3; ++k) gpu.at(x, y, k) = 0, truth.at(x, y, k) = 0;
        const ErrorSummary error = summary(delta_e_itp(on_panel(gpu, exposure), on_panel(truth, exposure)));
        const ErrorSummary effect = summary(delta_e_itp(on_panel(picture, exposure), on_panel(truth, exposure)));
        ledger(name().c_str(), c.setting, "float against reference p99 dE_ITP", error.p99);
        ledger(name().c_str(), c.setting, "float against reference mean dE_ITP", error.mean);
        ledger(name().c_str(), c.setting, "float against reference max dE_ITP", error.max);
        std::printf("  (the effect itself: p99 dE_ITP %.3g, mean %.3g)\n", effect.p99, effect.mean);
        EXPECT_GT(effect.p99, tolerance.least_effect_p99) << c.setting;
        EXPECT_LT(error.p99, tolerance.p99) << c.setting;
        EXPECT_LT(error.mean, tolerance.mean) << c.setting;
    }
    // The residual law: what the panel shows no brighter than it is stays as it is, whatever the settings and the adaptation.
    void panel_range_keeps_its_bits(const std::vector<std::string>& each_setting, const std::vector<float>& adaptations = {1}) const {
        for (const std::string& setting : each_setting) {
            const EyeGeometry g = rectilinear(240, 136, 20);
            StageRunner plain({g}, selection({setting})), same({g}, with_exposure(selection({setting}), 1)),
                darker({g}, with_exposure(selection({setting}), 0.3f));
            for (double light : {1e-4, 0.01, 3.0, 40.0}) {
                ImageF picture = textured(240, 136, light);
                for (float& v : picture.data) v = std::min(v, 130.0f);
                for (float adaptation : adaptations)
                    for (StageRunner* runner : {&plain, &same, &darker}) {
                        runner->stage().set_adaptation(adaptation);
                        EXPECT_EQ(runner->run(picture, still_input(1)).data, picture.data) << setting << " " << light << " " << adaptation;
                        EXPECT_TRUE(runner->stage().effects().at(0).gated) << setting << " " << light << " " << adaptation;
                    }
            }
        }
    }
    void strength_zero_is_bit_exact() const {
        StageRunner runner({rectilinear(240, 136, 20)}, with_exposure(selection({slot_ + ".strength=0"}), 1000));
        const ImageF picture = textured(240, 136, 1e-3);
        EXPECT_EQ(runner.run(picture, still_input(1)).data, picture.data);
    }
    void mirrored_stays_mirrored(double hfov_deg, double light, float exposure, double tolerance) const {
        StageRunner runner({rectilinear(192, 96, hfov_deg)}, with_exposure(selection(), exposure));
        const ImageF picture = textured(192, 96, light);
        EXPECT_LT(
            summary(relative_errors(runner.run(mirrored(picture), still_input(1)), mirrored(runner.run(picture, still_input(1))), 1e-6))
                .max,
            tolerance);
    }
    void hard_cases_stay_finite(const std::vector<std::string>& each_setting,
                                const std::vector<EyeGeometry>& geometries = odd_geometries()) const {
        const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
        for (const EyeGeometry& g : geometries)
            for (const std::string& setting : each_setting) {
                const int width = static_cast<int>(g.width), height = static_cast<int>(g.height);
                StageRunner runner({g}, with_exposure(selection({setting}), 1e4f));
                for (float y : {0.0f, 1e-6f, 1e8f, nan, inf})
                    EXPECT_TRUE(all_finite(runner.run(uniform(width, height, y), still_input(1)))) << setting << " " << width << " " << y;
                ImageF picture = textured(width, height, 1e-5, 1e8);
                picture.data[0] = nan;
                picture.data[picture.data.size() / 2] = inf;
                picture.data.back() = -5;
                const ImageF out = runner.run(picture, still_input(1, static_cast<double>(nan)));
                EXPECT_TRUE(all_finite(out)) << setting << " " << width;
                for (float v : out.data) ASSERT_GE(v, 0.0f);
            }
    }

protected:
    std::string slot_, model_;
};

}  // namespace entoptic::perception::testing
