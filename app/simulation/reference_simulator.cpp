#include "app/simulation/simulator.h"

#include "base/noise.h"
#include "shaders/colour_math.glsl"
#include "shaders/geometry.glsl"
#include "shaders/scene_statistics.h"

#include <algorithm>

namespace entoptic::app {
namespace {

using namespace perception;

class ReferenceSimulator final : public Simulator {
public:
    explicit ReferenceSimulator(const SimulatorOptions& options) : options_(options) {
        for (const Choice& choice : options_.selection.choices) {
            models_.push_back(choice.entry->create_reference());
            // The selection has checked them; what has gone since makes the reference fail, not the run.
            if (models_.back() && !models_.back()->set_files(choice.files)) models_.back().reset();
        }
    }
    void set_adaptation(double cd_m2) override { adaptation_ = cd_m2; }
    Result<void> frame(const ImageF& scene, const ImageF& depth, const FrameInput& input, bool want_picture) override {
        ReferenceFrame frame{cleaned(scene), options_.geometry, options_.display, input.eyes[0],
                             input.dt_s,     input.snap,        adaptation_,      options_.seed};
        frame.dioptre = dioptres(depth);
        frame.vergence_dioptre = static_cast<double>(input.vergence_dioptre);
        frame.focus_dioptre = focus_;
        if (want_picture) measure(frame.image);
        frame.scene_white_cd_m2 = static_cast<double>(options_.display.white_cd_m2);
        const auto& choices = options_.selection.choices;
        const auto each = [&](std::size_t from, std::size_t to, auto part) {
            for (std::size_t i = from; i < to; ++i)
                if (models_[i]) (models_[i].get()->*part)(frame, choices[i].parameters);
        };
        // The order of Stage::record().
        std::size_t optics = 0, tone = 0;
        while (optics < models_.size() && (choices[optics].entry->slot == "adaptation" || choices[optics].entry->slot == "pupil")) ++optics;
        while (tone < models_.size() && choices[tone].entry->slot != "eyelid" && choices[tone].entry->slot != "tone" && !(models_[tone] && models_[tone]->observes_retina())) ++tone;
        each(0, optics, &ReferenceModel::apply);
        each(0, models_.size(), &ReferenceModel::plan);
        if (want_picture || observes()) {
            each(optics, tone, &ReferenceModel::apply);
            each(0, models_.size(), &ReferenceModel::observe);
        }
        if (want_picture) each(tone, models_.size(), &ReferenceModel::apply);
        adaptation_ = frame.adaptation_cd_m2;
        focus_ = frame.focus_dioptre;
        eye_ = frame.eye;
        view_.adaptation_cd_m2 = view_.target_cd_m2 = static_cast<float>(adaptation_);
        if (want_picture) picture_ = convert<float>(frame.image);
        return {};
    }
    ImageF picture() const override { return picture_; }
    ViewOutcome view() const override { return view_; }
    EyeInput eye() const override { return eye_; }
    std::vector<EffectOutcome> effects() const override {
        std::vector<EffectOutcome> outcomes;
        for (std::size_t i = 0; i < models_.size(); ++i) {
            const ModelEntry& entry = *options_.selection.choices[i].entry;
            const std::string failed = models_[i] ? "" : "it has no reference";
            outcomes.push_back(
                {std::string(entry.slot), std::string(entry.name), failed.empty(), false, failed, failed.empty() ? "runs" : failed, 0});
        }
        return outcomes;
    }
    std::string device() const override { return "CPU, double precision"; }

private:
    // Some state is driven by every frame's light on the retina, not only by those that are wanted as pictures.
    bool observes() const {
        return std::any_of(models_.begin(), models_.end(), [](const auto& model) { return model && model->observes_retina(); });
    }
    ImageD cleaned(const ImageF& scene) {
        ImageD out(scene.width, scene.height, 3);
        const double most = static_cast<double>(max_scene_cd_m2);
        view_.cleaned = 0;
        for (std::size_t i = 0; i < out.data.size(); i += 3) {
            bool changed = false;
            for (std::size_t c = i; c < i + 3; ++c) {
                const double v = static_cast<double>(scene.data[c]);
                out.data[c] = v > 0 ? std::min(v, most) : 0;
                changed |= !(v >= 0 && v <= most);
            }
            view_.cleaned += changed;
        }
        return out;
    }
    // As Stage::record_ingest() has it.
    static ImageD dioptres(const ImageF& depth) {
        ImageD out = convert<double>(depth);
        for (double& v : out.data) v = v > 0 ? std::min(1 / v, static_cast<double>(max_dioptre)) : static_cast<double>(unknown_dioptre);
        return out;
    }
    void measure(const ImageD& image) {
        double low = 3e38, high = 0, sum = 0, sr = 0;
        for (int y = 0; y < image.height; ++y)
            for (int x = 0; x < image.width; ++x) {
                const double lum = colour::luminance({image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)});
                const double w = geometry::geometry_solid_angle(options_.geometry, {x + 0.5, y + 0.5});
                low = std::min(low, lum);
                high = std::max(high, lum);
                sum += w * lum;
                sr += w;
            }
        view_.min_y = static_cast<float>(low);
        view_.max_y = static_cast<float>(high);
        view_.mean_y = static_cast<float>(sum / sr);
    }

    SimulatorOptions options_;
    std::vector<std::unique_ptr<ReferenceModel>> models_;
    double adaptation_ = 0, focus_ = -1;
    ImageF picture_;
    EyeInput eye_;
    ViewOutcome view_;
};

}  // namespace

std::unique_ptr<Simulator> make_reference_simulator(const SimulatorOptions& options) {
    return std::make_unique<ReferenceSimulator>(options);
}

ImageF limited_to_display(ImageF picture, const DisplayRange& display) {
    // Written so that a NaN, which no model may leave, shows as black.
    for (float& v : picture.data) v = v > display.black_cd_m2 ? std::min(v, display.white_cd_m2) : display.black_cd_m2;
    return picture;
}

Image8 display_codes(const ImageF& picture, const DisplayRange& display) {
    Image8 codes(picture.width, picture.height, picture.channels);
    const double black = static_cast<double>(display.black_cd_m2), white = static_cast<double>(display.white_cd_m2);
    for (std::size_t i = 0; i < codes.data.size(); ++i) {
        const double linear = (static_cast<double>(picture.data[i]) - black) / (white - black);
        const double code = 255 * colour::srgb_encode(linear > 0 ? std::min(linear, 1.0) : 0);
        codes.data[i] = static_cast<std::uint8_t>(code + 0.5);
    }
    return codes;
}

Image8 dithered_codes(const ImageF& picture, const DisplayRange& display, std::uint64_t seed, std::uint64_t frame) {
    Image8 codes(picture.width, picture.height, picture.channels);
    const double black = static_cast<double>(display.black_cd_m2), white = static_cast<double>(display.white_cd_m2);
    for (std::size_t i = 0; i < codes.data.size(); ++i) {
        const double linear = (static_cast<double>(picture.data[i]) - black) / (white - black), light = linear > 0 ? std::min(linear, 1.0) : 0;
        // A hair above, so that light of a code, rounded, is that code.
        const double lower = std::min(std::floor(255 * colour::srgb_encode(light) + 1e-4), 254.0);
        const double below = colour::srgb_decode(lower / 255), above = colour::srgb_decode((lower + 1) / 255);
        const bool up = uniform01(seed ^ mix64(frame), i) < (light - below) / (above - below) - 1e-6;
        codes.data[i] = static_cast<std::uint8_t>(lower + up);
    }
    return codes;
}

}  // namespace entoptic::app
