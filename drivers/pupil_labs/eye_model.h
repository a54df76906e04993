// From pupil ellipses over time to the eye behind them: where its centre of rotation is, and from that, picture by picture, where it looks and
// how wide its pupil is in millimetres. The cornea's refraction is traced, not approximated (eye_optics.h).
//
// One picture alone does not tell distance from size. Many do: the pupil moves on a sphere of known radius around the centre of rotation,
// so the amount of movement tells the distance (Swirski and Dodgson 2013). Until enough directions have been seen there is no model and no answer.
#pragma once

#include "drivers/pupil_labs/eye_optics.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace entoptic::drivers {

struct EyeModelParameters {
    PinholeCamera camera;
    EyeDimensions eye;
    double min_confidence = 0.8;         // ellipses less sure than this do not shape the model
    double bin_deg = 4;                  // directions closer than this share one place in the memory: the newest is kept
    std::size_t min_directions = 8;      // as many different directions are needed ...
    double min_spread_deg = 10;          // ... over this much, before the model is used
    std::uint64_t forget_after = 20000;  // pictures; a headset slips on a face
    double expected_depth_mm = 38;       // of the centre of rotation; a headset's cameras are 30 to 50 mm away
    double depth_sigma_mm = 12;          // and how sure that is
};

struct EyeEstimate {
    Eigen::Vector3d optical_axis{0, 0, -1};  // unit, out of the eye, camera coordinates
    Eigen::Vector3d pupil_centre{0, 0, 0};   // mm
    double pupil_diameter_mm = 0;            // entrance pupil: as wide as it looks from in front; what a glare model needs
    double residual_px = 0;                  // root mean square distance of the modelled outline to the ellipse
};

class EyeModel {
public:
    explicit EyeModel(const EyeModelParameters& parameters);

    // Takes an ellipse into the memory and every 20 pictures (200, once the model has settled)
    // improves the model by one step, which takes some milliseconds.
    void observe(const Ellipse& ellipse, double confidence);

    // None while there is no model, or when the ellipse cannot be this eye's pupil.
    std::optional<EyeEstimate> estimate(const Ellipse& ellipse) const;

    bool fitted() const { return fitted_; }
    const Eigen::Vector3d& rotation_centre() const { return centre_; }
    double fit_residual_px() const { return residual_px_; }
    const EyeModelParameters& parameters() const { return parameters_; }

private:
    struct Observation {
        Ellipse ellipse;
        Eigen::Vector2d angles{0, 0};  // of the optical axis: right and down of the camera's own axis, rad
        double radius = 2;             // mm
        double weight = 1;
        std::uint64_t picture = 0;
        std::array<int, 2> bin{};
    };

    void remember(const Ellipse& ellipse, double confidence);
    void forget();
    bool start();
    bool improve();
    bool spread_enough() const;

    EyeModelParameters parameters_;
    std::vector<Observation> memory_;
    Eigen::Vector3d centre_;
    std::uint64_t pictures_ = 0;
    double residual_px_ = 0;
    int steps_ = 0;
    bool fitted_ = false;
};

}  // namespace entoptic::drivers
