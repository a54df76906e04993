// dioptric_disc in double: lens and retina in metres, as Liu et al. 2021 write it in equation 12, and light that is scattered, not gathered.
#include "perception/dof/dof.h"
#include "perception/dof/dof_reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace entoptic::perception {
namespace {

constexpr double focal_mm = 22.3;
// Thibos et al. 1992, table: the eye's focus at 610, 540 and 460 nm relative to 580 nm, dioptre.
double chromatic(double nanometres) { return 1.7312 - 633.46 / (nanometres - 214.10); }

// Diameter of the disc on the retina, as an angle: the point at `depth_mm` is imaged at v, the retina stands where `focus_mm` is imaged.
double disc_rad(double focus_mm, double depth_mm, double pupil_mm) {
    // Distance of the image behind a lens in air that is focused by bending, so that the retina stays at its focal length.
    const double vergence = 1 / focal_mm + 1 / focus_mm - 1 / depth_mm;
    const double image_mm = 1 / vergence;
    return pupil_mm * std::abs(image_mm - focal_mm) / image_mm / focal_mm;
}

class DioptricDiscReference final : public ReferenceModel {
public:
    void apply(ReferenceFrame& frame, std::span<const float> values) override {
        const auto parameter = [&](std::size_t i) { return static_cast<double>(values[i]); };
        if (frame.dioptre.data.empty() || parameter(0) == 0) return;
        if (!follow_focus(frame, parameter(1), parameter(2) > 0.5, parameter(3))) return;
        const double pupil = static_cast<double>(frame.eye.pupil_diameter_mm);
        const auto disc_of = [&](double dioptre, double pixel_rad) {
            ReferenceDisc disc;
            disc.dioptre = dioptre;
            const double nanometres[3] = {610, 540, 460};
            for (int c = 0; c < 3; ++c) {
                // The eye's own refraction adds to the point's vergence.
                const double depth = dioptre + (parameter(6) > 0.5 ? chromatic(nanometres[c]) : 0);
                const double whole = disc_rad(millimetres(frame.focus_dioptre), millimetres(depth), pupil);
                const double unseen = disc_rad(millimetres(0), millimetres(parameter(4)), pupil);
                const double angle = std::sqrt(std::max(0.0, whole * whole - unseen * unseen));
                disc.radius_px[c] = std::min(parameter(0) * angle / 2 / pixel_rad, parameter(5));
            }
            return disc;
        };
        scatter(frame, disc_of, false);
    }

private:
    static double millimetres(double dioptre) { return dioptre == 0 ? std::numeric_limits<double>::infinity() : 1000 / dioptre; }
};

}  // namespace

std::unique_ptr<ReferenceModel> make_dioptric_disc_reference() { return std::make_unique<DioptricDiscReference>(); }

}  // namespace entoptic::perception
