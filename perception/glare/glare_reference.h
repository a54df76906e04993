// What the references of the glare models share, in double from the definition, with none of the shaders' code: every pixel gets light from
// every other pixel, each pair by its true angle on the sphere. No grid, no transform, no projection.
//
// Small pictures are summed pair by pair. In larger ones pixels far from each other are taken together (Barnes and Hut 1986): a square of
// pixels counts as one where it is seen under less than `glare_opening`, at the centre of its light. Rows are shared out among all cores.
#pragma once

#include "base/image.h"
#include "shaders/eye_geometry.h"

#include <array>
#include <functional>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace entoptic::perception::glare_reference {

using Rgb = std::array<double, 3>;

// Pictures of up to this many pixels are summed pair by pair.
constexpr std::size_t exact_pixels = 20000;
constexpr double glare_opening = 0.15;      // rad; radius of a square over its distance

// A kernel per sr over the angle, tabulated evenly in its logarithm.
class Kernel {
public:
    explicit Kernel(const std::function<Rgb(double theta)>& per_sr);
    Rgb operator()(double theta) const;

private:
    std::vector<Rgb> table_;
};

class Scatter {
public:
    explicit Scatter(const EyeGeometry& geometry);

    // At each pixel x the sum over all others y of K(x, y) (source(y) - source(x)); `leaves` false: of K(x, y) source(y).
    ImageD operator()(const ImageD& source, const Kernel& kernel, bool leaves) const;

    bool visible(int x, int y) const { return solid_angle_[index(x, y)] > 0; }
    glm::dvec3 direction(int x, int y) const { return direction_[index(x, y)]; }
    double smallest_step() const { return smallest_step_; }    // between pixels, rad
    double mean_step() const { return mean_step_; }

private:
    struct Square;
    class Tree;
    Rgb at(int x, int y, const ImageD& source, const Tree& tree, const Kernel& kernel, bool leaves) const;
    Rgb pixel_weight(glm::dvec3 here, int u, int v, int apart, const Kernel& kernel) const;
    std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * geometry_.width + static_cast<std::size_t>(x); }
    glm::dvec3 towards(double x, double y) const;

    EyeGeometry geometry_;
    bool exact_;
    double smallest_step_ = 1, mean_step_ = 0;
    std::vector<glm::dvec3> direction_;
    std::vector<double> solid_angle_;
};

// What a kernel scatters from `from` to `to` (rad), by channel.
Rgb energy(const std::function<Rgb(double theta)>& per_sr, double from, double to);

// The residual form: out = C + what the panel cannot send, scattered by the person's eye; plus the displayed light, scattered by the
// difference of person and wearer; less `rescatter` times what the wearer's eye scatters of the light that all this adds to the panel's.
// `photographic`: out = C + sum of K (C(y) - C(x)). With `primaries`, three kernels, what the panel cannot send of red, green and blue scatters
// by one each instead of the person's, which says what each channel gets of it.
ImageD seen(const ImageD& image, const Scatter& scatter, const Kernel& person, const Kernel& wearer, bool differ, double white_cd_m2, double rescatter,
            bool photographic, std::span<const Kernel> primaries = {});

// --- optics ---

struct Wave {
    double nm;
    Rgb weight;
};
// Linear BT.709 of a wavelength: Wyman, Sloan and Shirley 2013, multi-lobe fit of the CIE 1931 functions.
Rgb linear_rgb(double nm);
// Every 4 nm from 400 to 700, each channel of sum 1.
std::vector<Wave> white_spectrum();
// The same wavelengths of the light of red, green or blue (0..2) of glare_emission.h, mixed so that the sum is that primary alone.
std::vector<Wave> primary_spectrum(std::size_t primary);
// Light per sr that an aperture (um) diffracts, mean over a ring that holds whole fringes: Rayleigh 1881, encircled energy 1 - J0^2 - J1^2.
double aperture_ring(double aperture_um, double lambda_um, double theta, double least);
// Light per sr, of energy 1, that a disc scatters.
double disc(double diameter_um, double lambda_um, double theta);

}  // namespace entoptic::perception::glare_reference
