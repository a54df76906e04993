#include "perception/eyelid/blink_math.glsl"
#include "perception/eyelid/eyelid.h"

#include "perception/eyelid/blink.comp.h"
#include "perception/eyelid/blink_gate.comp.h"

#include <algorithm>

namespace entoptic::perception {
namespace {

constexpr ParameterInfo parameters[] = {
    {"opening_mm", "mm", 2, 20, 10, "choice: an open eye's slit is some 10 mm high", "height of the open eye's slit"},
    {"lid_red", "1", 0, 1, 0.056f, "Ando and Kripke 1996", "red light that the closed eyelid lets through"},
    {"lid_green_blue", "1", 0, 1, 0.003f, "Ando and Kripke 1996", "green and blue light that the closed eyelid lets through"},
};
static_assert(sizeof(BlinkParams) == sizeof(float) * std::size(parameters));

struct GatePush {
    float least_passed;
    uint groups;
};
struct Push {
    vec3 passed;
    uint view, pixels;
};

class Blink final : public Model {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<Blink>();
        ENTOPTIC_TRY(pass, (GatedPass::create<GatePush, Push>(context, "eyelid.blink", blink_gate_comp_spv, blink_comp_spv)));
        model->pass_ = std::move(pass);
        return model;
    }
    void set_parameters(std::span<const float> v) override { params_ = {v[0], v[1], v[2]}; }
    Result<void> record(StageIo& io) override {
        const uint pixels = io.width * io.height;
        std::vector<vec3> passed;
        float least = 1;
        for (const EyeInput& eye : io.input.eyes) {
            passed.push_back(blink::passed(params_, static_cast<double>(eye.eyelid_open), static_cast<double>(eye.pupil_diameter_mm)));
            least = std::min({least, passed.back().x, passed.back().y, passed.back().z});
        }
        pass_.record_gate(io, GatePush{least, gpu::groups_for(pixels, 256)});
        for (uint view = 0; view < io.views; ++view)
            if (passed[view] != vec3(1.0f)) pass_.record_pass(io, Push{passed[view], view, pixels});
        return {};
    }

private:
    GatedPass pass_;
    BlinkParams params_{};
};

}  // namespace

std::unique_ptr<ReferenceModel> make_blink_reference();

extern const ModelEntry blink_entry;
const ModelEntry blink_entry{"eyelid",   "blink",        "The lid darkens the picture when the eye blinks",
                             parameters, &Blink::create, &make_blink_reference};

}  // namespace entoptic::perception
