#include "perception/pupil/luidolt_pupil_math.glsl"
#include "perception/pupil/pupil.h"

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"white_mm", "mm", 1.5f, 9, 2.5f, "Luidolt 2020, section 4: measured for each user", "the tracker's pupil while the panel is white"},
    {"black_mm", "mm", 1.5f, 9, 6, "Luidolt 2020, section 4: measured for each user", "the tracker's pupil while the panel is black"},
    {"least_mm", "mm", 1.5f, 9, 2, "Luidolt 2020, section 4", "the pupil that white stands for"},
    {"most_mm", "mm", 1.5f, 9, 8, "Luidolt 2020, section 4", "the pupil that black stands for"},
};
static_assert(sizeof(LuidoltPupilParams) == sizeof(float) * std::size(parameters));

class LuidoltPupil final : public Model, public AdjustsEyes {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext&) { return std::make_unique<LuidoltPupil>(); }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1], v[2], v[3]}; }
    Result<void> record(StageIo&) override { return {}; }
    void adjust(FrameInput& input, std::span<const SceneFeedback>) override {
        for (EyeInput& eye : input.eyes)
            eye.pupil_diameter_mm = static_cast<float>(luidolt_pupil::simulated_mm(params_, static_cast<double>(eye.pupil_diameter_mm)));
    }

private:
    LuidoltPupilParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_luidolt_pupil_reference();

extern const ModelEntry luidolt_pupil_entry;
const ModelEntry luidolt_pupil_entry{"pupil",    "luidolt_pupil",       "The wearer's range of pupils, measured with a white and a black frame, stands for 2 to 8 mm (Luidolt 2020)",
                                     parameters, &LuidoltPupil::create, &make_luidolt_pupil_reference};

}  // namespace entoptic::perception
