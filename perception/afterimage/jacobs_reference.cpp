// jacobs in double from the paper: bleaching B and calcium concentration C by equations 5, 6, 9 and 10 as printed, one receptor of each
// cone type a pixel, gain and sum by equations 11 and 12. The retina's map is that of angles (azimuthal equidistant), with turns by
// matrices; diffusion is the exact solution of the discrete heat equation, not a small step of it.
#include "perception/afterimage/afterimage.h"
#include "perception/afterimage/jacobs_params.h"
#include "shaders/colour_math.glsl"
#include "shaders/geometry.glsl"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>

namespace entoptic::perception {
namespace {

using Triple = glm::dvec3;
constexpr double degree = 0.017453292519943295;

// Hunt, Pointer and Estevez, D65, white-normalised; appendix A's H.
const glm::dmat3 lms_of_rgb =
    glm::transpose(glm::dmat3(0.313947576, 0.63954264, 0.0465097845, 0.155350447, 0.757925749, 0.0867238036, 0.0177500401, 0.109447621, 0.872802339));
const glm::dmat3 h = glm::transpose(glm::dmat3(1.14, -1.18, 0.36, -0.08, 1.02, 0.18, 0.30, -0.11, 1.25));

struct Stimulus {
    Triple light{0}, response{0};  // I and R, LMS
};
struct Receptor {
    Triple b{0}, c{1};  // B; C with C_max = c1/c2 = 1
    Stimulus now;
};

class JacobsReference final : public ReferenceModel {
public:
    bool observes_retina() const override { return true; }

    void observe(ReferenceFrame& frame, std::span<const float> values) override {
        std::memcpy(&p_, values.data(), sizeof(p_));
        fit(frame);
        const glm::dmat3 world_from_eye = turn_of(frame.eye);
        const bool first = !begun_;
        begun_ = true;
        if (!first && !frame.snap) diffuse(frame.dt_s);
        for (int y = 0; y < size_; ++y)
            for (int x = 0; x < size_; ++x) {
                Receptor& receptor = at(x, y);
                receptor.now = seen_from(frame, world_from_eye * direction(x, y));
                if (frame.snap) settle(receptor, receptor.now);
                else if (first) settle(receptor, surround(frame));
                step(receptor, frame.dt_s);
            }
    }

    void apply(ReferenceFrame& frame, std::span<const float>) override {
        const double black = static_cast<double>(frame.display.black_cd_m2), range = static_cast<double>(frame.display.white_cd_m2) - black;
        const glm::dmat3 eye_from_world = glm::transpose(turn_of(frame.eye));
        for (int y = 0; y < frame.image.height; ++y)
            for (int x = 0; x < frame.image.width; ++x) {
                const Triple toward = eye_from_world * geometry::geometry_direction(frame.geometry, {x + 0.5, y + 0.5});
                const double eccentricity = std::acos(std::clamp(-toward.z, -1.0, 1.0)) / degree;
                const double weight = static_cast<double>(p_.strength) * visibility(eccentricity);
                if (weight <= 0) continue;
                const Receptor& receptor = nearest(toward);
                Triple light, response;
                for (int c = 0; c < 3; ++c) light[c] = frame.image.at(x, y, c), response[c] = std::max(0.0, (light[c] - black) / range);
                const Triple j = glm::inverse(lms_of_rgb) * (gain(receptor) * (lms_of_rgb * response)) +
                                 static_cast<double>(p_.j1) * bleached_colour(receptor);  // equation 12
                const Triple with = light + weight * range * (j - response);
                for (int c = 0; c < 3; ++c) frame.image.at(x, y, c) = std::clamp(with[c], std::min(black, light[c]), std::max(black + range, light[c]));
            }
    }

private:
    // ---- The retina ----
    Receptor& at(int x, int y) {
        return receptors_[static_cast<std::size_t>(std::clamp(y, 0, size_ - 1)) * static_cast<std::size_t>(size_) +
                          static_cast<std::size_t>(std::clamp(x, 0, size_ - 1))];
    }
    void fit(const ReferenceFrame& frame) {
        if (size_ > 0) return;
        const EyeGeometry& g = frame.geometry;
        cell_deg_ = 1 / geometry::geometry_ppd(g, {g.width * 0.5, g.height * 0.5});
        // As far as a flat picture reaches from a gaze at its rim.
        const double across_deg = static_cast<double>(std::hypot(g.tan_right - g.tan_left, g.tan_up - g.tan_down)) / degree;
        const double picture_deg = g.kind == geometry_rectilinear ? across_deg : 110;
        const double reach_deg = std::min({3.5 * static_cast<double>(p_.fovea_sigma_deg), 110.0, picture_deg});
        size_ = 2 * static_cast<int>(std::ceil(reach_deg / cell_deg_)) + 1;
        receptors_.resize(static_cast<std::size_t>(size_) * static_cast<std::size_t>(size_));
    }
    Triple direction(int x, int y) const {
        const double dx = (x - size_ / 2) * cell_deg_ * degree, dy = (y - size_ / 2) * cell_deg_ * degree, angle = std::hypot(dx, dy);
        if (angle <= 0) return {0, 0, -1};
        return {std::sin(angle) * dx / angle, std::sin(angle) * dy / angle, -std::cos(angle)};
    }
    const Receptor& nearest(const Triple& toward) {
        const double angle = std::acos(std::clamp(-toward.z, -1.0, 1.0)) / degree, side = std::hypot(toward.x, toward.y);
        const double scale = side > 0 ? angle / side / cell_deg_ : 0;
        return at(static_cast<int>(std::lround(toward.x * scale)) + size_ / 2, static_cast<int>(std::lround(toward.y * scale)) + size_ / 2);
    }
    static glm::dmat3 turn_of(const EyeInput& eye) {
        const Triple ahead(0, 0, -1), gaze = glm::normalize(Triple(eye.gaze_direction)), axis = glm::cross(ahead, gaze);
        if (glm::length(axis) < 1e-12) return glm::dmat3(1);
        return glm::dmat3(glm::rotate(glm::dmat4(1), std::acos(std::clamp(glm::dot(ahead, gaze), -1.0, 1.0)), axis));
    }
    double visibility(double eccentricity_deg) const {
        const auto gauss = [](double sigmas) { return std::exp(-0.5 * sigmas * sigmas); };
        return std::max(0.0, (gauss(eccentricity_deg / static_cast<double>(p_.fovea_sigma_deg)) - gauss(3.5)) / (1 - gauss(3.5)));
    }

    // ---- Light ----
    Stimulus stimulus(const ReferenceFrame& frame, const Triple& scene) const {
        const double white = static_cast<double>(frame.display.white_cd_m2), y = colour::luminance(scene);
        const double shown = frame.displayed ? frame.displayed(y) : y;
        const Triple displayed = y > 0 ? glm::min(scene * (shown / y), Triple(white)) : Triple(0);
        const double open = static_cast<double>(frame.eye.eyelid_open);
        const Triple closed(static_cast<double>(p_.lid_red), static_cast<double>(p_.lid_green_blue), static_cast<double>(p_.lid_green_blue));
        const Triple lid = open + (1 - open) * closed;
        if (p_.photographic > 0.5f) return {lms_of_rgb * (lid * scene), lms_of_rgb * (lid * displayed) / white};
        const Triple missing = lms_of_rgb * (lid * glm::max(frame.exposure * scene - displayed, 0.0)) / white;
        return {lms_of_rgb * (lid * glm::max(scene - displayed, 0.0)), missing / (1.0 + missing)};
    }
    Stimulus surround(const ReferenceFrame& frame) const {
        return p_.photographic > 0.5f ? stimulus(frame, Triple(frame.adaptation_cd_m2)) : Stimulus{};
    }
    Stimulus seen_from(const ReferenceFrame& frame, const Triple& direction) const {
        const auto px = glm::floor(geometry::geometry_pixel(frame.geometry, direction));
        if (!(px.x >= 0 && px.y >= 0 && px.x < frame.image.width && px.y < frame.image.height)) return surround(frame);
        const int x = static_cast<int>(px.x), y = static_cast<int>(px.y);
        return stimulus(frame, {frame.image.at(x, y, 0), frame.image.at(x, y, 1), frame.image.at(x, y, 2)});
    }

    // ---- Equations ----
    Triple b1() const { return {static_cast<double>(p_.b1_l), static_cast<double>(p_.b1_m), static_cast<double>(p_.b1_s)}; }
    Triple b2() const { return {static_cast<double>(p_.b2_l), static_cast<double>(p_.b2_m), static_cast<double>(p_.b2_s)}; }
    Triple b_infinity(const Stimulus& s) const { return b1() * s.light / (b1() * s.light + b2()); }  // equation 6
    static Triple c_infinity(const Stimulus& s) { return 1.0 - s.response; }                         // equation 10
    void settle(Receptor& r, const Stimulus& s) const { r.b = b_infinity(s), r.c = c_infinity(s); }
    void step(Receptor& r, double dt_s) const {
        if (!(dt_s > 0)) return;
        r.b = (r.b - b_infinity(r.now)) * glm::exp(-(b1() * r.now.light + b2()) * dt_s) + b_infinity(r.now);             // equation 5
        r.c = (r.c - c_infinity(r.now)) * std::exp(-static_cast<double>(p_.c2) * dt_s) + c_infinity(r.now);              // equation 9
    }
    Triple gain(const Receptor& r) const {
        const double e = static_cast<double>(p_.alpha_floor);
        return glm::pow((1.0 - c_infinity(r.now) + e) / (1.0 - r.c + e), Triple(static_cast<double>(p_.j2)));            // equation 11
    }
    Triple bleached_colour(const Receptor& r) const { return glm::max(h * (r.c * glm::max(r.b - b_infinity(r.now), 0.0)), 0.0); }

    // The discrete heat equation: after a variance t (cells²) the kernel is exp(-t) I_n(t) an axis.
    void diffuse(double dt_s) {
        const double sigma = static_cast<double>(p_.diffusion_deg) / cell_deg_, t = dt_s > 0 ? sigma * sigma * std::min(dt_s, 0.1) : 0;
        if (t <= 0) return;
        const int radius = 1 + static_cast<int>(std::ceil(5 * std::sqrt(t)));
        std::vector<double> kernel;
        for (int n = 0; n <= radius; ++n) kernel.push_back(std::exp(-t) * std::cyl_bessel_i(n, t));
        for (int axis = 0; axis < 2; ++axis) {
            std::vector<Receptor> out = receptors_;
            for (int y = 0; y < size_; ++y)
                for (int x = 0; x < size_; ++x) {
                    Receptor sum{Triple(0), Triple(0), {}};
                    for (int n = -radius; n <= radius; ++n) {
                        const Receptor& other = axis == 0 ? at(x + n, y) : at(x, y + n);
                        const double weight = kernel[static_cast<std::size_t>(std::abs(n))];
                        sum.b += weight * other.b, sum.c += weight * other.c;
                    }
                    out[static_cast<std::size_t>(y) * static_cast<std::size_t>(size_) + static_cast<std::size_t>(x)] = sum;
                }
            receptors_ = std::move(out);
        }
    }

    JacobsParams p_{};
    int size_ = 0;  // receptors across
    double cell_deg_ = 1;
    bool begun_ = false;
    std::vector<Receptor> receptors_;
};

}  // namespace

std::unique_ptr<ReferenceModel> make_jacobs_reference() { return std::make_unique<JacobsReference>(); }

}  // namespace entoptic::perception
