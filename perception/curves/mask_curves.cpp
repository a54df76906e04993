// The point spread of fraunhofer_mask: the mean over the azimuth of the kernel that the model computes.
#include "perception/curves/curve_references.h"
#include "perception/curves/curve_table.h"
#include "perception/glare/fraunhofer_mask_math.glsl"
#include "perception/glare/fraunhofer_mask_tables.h"

#include "perception/curves/glare_psf_fraunhofer_mask.comp.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

using namespace fraunhofer_mask;

constexpr double pi = 3.14159265358979323846;

// Light per sr within the first row, then the rows' means over the azimuth, times the sine cubed.
std::vector<float> mask_table(const CurveInput& in) {
    const auto p = in.as<FraunhoferMaskParams>();
    const ApertureRaster aperture = raster_aperture(p, nullptr, {in.own[0], static_cast<double>(p.lid_open), 0}, mask_samples, mask_plane_over_pupil * in.own[0]);
    const DiffractedSpectrum spectrum = in.own[1] > 0 ? DiffractedSpectrum{{in.own[1] / 1000}, {glm::dvec3(1)}} : diffracted_spectrum(p);
    const std::vector<vec3> table = make_mask_table(make_psf(aperture), spectrum);
    std::vector<float> means{0};
    double beyond = 0;
    for (uint row = 0; row < mask_rows; ++row) {
        glm::dvec3 sum{0};
        for (uint column = 0; column < mask_columns; ++column) sum += glm::dvec3(table[row * mask_columns + column]);
        const double mean = glm::dot(glm::dvec3(0.2126, 0.7152, 0.0722), sum) / mask_columns, sine = mask_sine(row);
        if (sine < 1) beyond += mean * 2 * pi * mask_step() / sine * (row == 0 ? 0.5 : 1);
        means.push_back(static_cast<float>(mean));
    }
    // What is nearer to the source than the first row is spread evenly.
    means[0] = static_cast<float>(std::max(1 - beyond, 0.0) / (pi * mask_first_sine() * mask_first_sine()));
    return means;
}

double mask_psf(const CurveInput& in, double deg) {
    const double sine = std::sin(deg * pi / 180);
    if (sine < mask_first_sine()) return static_cast<double>(in.table[0]);
    const double row = std::min(mask_row(sine), mask_rows - 1.0);
    const auto low = std::min<std::size_t>(static_cast<std::size_t>(row), mask_rows - 2);
    return glm::mix(static_cast<double>(in.table[1 + low]), static_cast<double>(in.table[2 + low]), row - static_cast<double>(low)) / (sine * sine * sine);
}

}  // namespace

Curve mask_curve(const CurveKind& kind) {
    static const std::vector<CurveAlias> parameters = [] {
        std::vector<CurveAlias> list;
        for (const char* name : {"blades", "blade_rotation_deg", "lashes", "lash_width_mm", "lash_length_mm", "lash_curl", "lash_seed", "lids", "lid_open",
                                 "filter_directions",
                                 "filter_spacing_mm", "filter_width_mm", "filter_rotation_deg", "wavelengths", "three_lines"})
            list.push_back({name, {name}});
        return list;
    }();
    // The model's transform is coarser than the fringes of the pupil, which the reference averages: in bands of angles they agree better.
    return {&kind, "fraunhofer_mask", glare_psf_fraunhofer_mask_comp_spv, &each<mask_psf>, &curve_reference::fraunhofer_mask_scatter, parameters, {}, &mask_table, 0.3};
}

}  // namespace entoptic::perception
