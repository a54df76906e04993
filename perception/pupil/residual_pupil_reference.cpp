// residual_pupil in double. A reference frame has no frame before it and no wearer: the pupil that it is given is already that of the eye
// in the scene, so nothing is added.
#include "perception/pupil/pupil.h"

namespace entoptic::perception {
namespace {

class ResidualPupilReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame&, std::span<const float>) override {}
};

}  // namespace

std::unique_ptr<ReferenceModel> make_residual_pupil_reference() { return std::make_unique<ResidualPupilReference>(); }

}  // namespace entoptic::perception
