#include "perception/pupil/pupil.h"
#include "perception/pupil/residual_pupil_math.glsl"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"age", "years", 20, 83, 30, "Watson and Yellott 2012", "age of the wearer and of the eye"},
    {"least_mm", "mm", 1.5f, 9, 2, "Watson and Yellott 2012", "smallest pupil that is simulated"},
    {"most_mm", "mm", 1.5f, 9, 8, "Watson and Yellott 2012", "largest pupil that is simulated"},
    {"constriction_mm_s", "mm/s", 0.1f, 20, 6, "choice: about the fastest after a flash", "fastest constriction"},
    {"dilation_mm_s", "mm/s", 0.1f, 20, 2, "choice: dilation is slower", "fastest dilation"},
};
static_assert(sizeof(ResidualPupilParams) == sizeof(float) * std::size(parameters));

class ResidualPupil final : public Model, public AdjustsEyes {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<ResidualPupil>();
        model->opening_mm_.assign(context.views.size(), 0.0);
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], std::min(v[1], v[2]), std::max(v[1], v[2]), v[3], v[4]}; }
    bool obeys_residual_law() const override { return true; }
    Result<void> record(StageIo&) override { return {}; }
    void adjust(FrameInput& input, std::span<const SceneFeedback> feedback) override {
        for (std::size_t view = 0; view < input.eyes.size(); ++view) {
            const SceneFeedback& f = feedback[view];
            const auto light = [](double y) { return std::min(std::max(y, 0.0), 1e8); };
            const double target = residual_pupil::opening_mm(params_, light(f.scene_cd_m2), light(f.displayed_cd_m2), light(f.area_deg2));
            double& opening = opening_mm_[view];
            opening = input.snap ? target : residual_pupil::followed_mm(params_, opening, target, input.dt_s);
            const auto measured = static_cast<double>(input.eyes[view].pupil_diameter_mm);
            input.eyes[view].pupil_diameter_mm = static_cast<float>(residual_pupil::simulated_mm(params_, measured, opening));
        }
    }

private:
    ResidualPupilParams params_{};
    std::vector<double> opening_mm_;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_residual_pupil_reference();

extern const ModelEntry residual_pupil_entry;
const ModelEntry residual_pupil_entry{"pupil",    "residual_pupil",       "The measured pupil, as much wider or narrower as the scene's light differs from the panel's",
                                      parameters, &ResidualPupil::create, &make_residual_pupil_reference};

}  // namespace entoptic::perception
