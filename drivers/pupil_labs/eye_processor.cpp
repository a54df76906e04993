#include "drivers/pupil_labs/eye_processor.h"

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace entoptic::drivers {

namespace {

struct PublishedFocal {
    char generation;
    int width;
    double focal_px;
};

// facts/devices.md 3.2: Pupil Labs' own constants.
constexpr std::array published_focals{PublishedFocal{'1', 320, 339.2}, PublishedFocal{'1', 640, 670.8}, PublishedFocal{'2', 192, 283.3},
                                      PublishedFocal{'2', 400, 562.0}, PublishedFocal{'3', 192, 140.0}, PublishedFocal{'3', 400, 278.5}};

constexpr double stripe_ratio = 5, least_stripe_step = 12;  // choice: eyes have at most 2 (pupil_labs.md); grey levels
constexpr double resting_tau_s = 20;                        // of the mean direction, once it is known
constexpr float not_known = std::numeric_limits<float>::quiet_NaN();

char generation_of(const std::string& product) {
    const auto at = product.find("Cam");
    return at == std::string::npos || at + 3 >= product.size() ? '3' : product[at + 3];
}

EyeModelParameters model_of(const PinholeCamera& camera) {
    EyeModelParameters parameters;
    parameters.camera = camera;
    return parameters;
}

// An 8 x 8 grid, its middle 4 x 4 weighing four times.
double weighted_level(const Image8& image) {
    double sum = 0, weights = 0;
    for (int row = 0; row < 8; ++row) {
        for (int column = 0; column < 8; ++column) {
            const double weight = row >= 2 && row < 6 && column >= 2 && column < 6 ? 4 : 1;
            sum += weight * image.at((2 * column + 1) * image.width / 16, (2 * row + 1) * image.height / 16, 0);
            weights += weight;
        }
    }
    return sum / weights;
}

}  // namespace

PinholeCamera pupil_labs_camera(const std::string& product, int width, int height) {
    const char generation = generation_of(product);
    const PublishedFocal* nearest = &published_focals.back();
    for (const PublishedFocal& focal : published_focals) {
        const bool better = std::abs(focal.width - width) < std::abs(nearest->width - width);
        if (focal.generation == generation && (nearest->generation != generation || better)) nearest = &focal;
    }
    return {nearest->focal_px * width / nearest->width, 0.5 * width, 0.5 * height};
}

bool is_striped(GrayView image) {
    if (image.width < 8 || image.height < 8) return false;
    double rows = 0, columns = 0;
    for (int y = 1; y < image.height; ++y) {
        const std::uint8_t *row = image.data + static_cast<std::ptrdiff_t>(y) * image.stride, *above = row - image.stride;
        int down = 0, across = 0;
        for (int x = 1; x < image.width; ++x) {
            down += std::abs(row[x] - above[x]);
            across += std::abs(row[x] - row[x - 1]);
        }
        rows += down;
        columns += across;
    }
    const double pixels = static_cast<double>(image.width - 1) * (image.height - 1);
    return rows / pixels > least_stripe_step && rows > stripe_ratio * columns;
}

Eigen::Vector3d RestingDirection::head_direction(const Eigen::Vector3d& optical_axis, double seconds) {
    const double share = weight_ > 0 ? std::max(1 / (weight_ + 1), 1 - std::exp(-std::clamp(seconds, 0.0, 1.0) / resting_tau_s)) : 1;
    mean_ += share * (optical_axis - mean_);
    weight_ += 1;
    const Eigen::Vector3d back = -mean_.normalized(), up = (up_ - up_.dot(back) * back).normalized(), right = up.cross(back);
    return {optical_axis.dot(right), optical_axis.dot(up), optical_axis.dot(back)};
}

EyeProcessor::EyeProcessor(int eye, const PinholeCamera& camera) : model_(model_of(camera)), rest_(eye == 1) {}

RawEyeSample EyeProcessor::sample_of(const PupilDetection& pupil, TimeNs time, TimeNs arrival) {
    RawEyeSample sample;
    sample.time = time;
    sample.arrival = arrival;
    sample.gaze_direction = glm::vec3(not_known);
    sample.pupil_diameter_mm = not_known;
    sample.confidence = static_cast<float>(pupil.confidence);
    if (!pupil.found) return sample;
    ++counts_.with_pupil;
    model_.observe(pupil.ellipse, pupil.confidence);
    const auto estimate = model_.estimate(pupil.ellipse);
    if (!estimate) return sample;
    const double seconds_since = newest_ == 0 ? 0 : seconds(time - newest_);
    const Eigen::Vector3d direction = rest_.head_direction(estimate->optical_axis, seconds_since);
    sample.gaze_direction = {static_cast<float>(direction.x()), static_cast<float>(direction.y()), static_cast<float>(direction.z())};
    sample.pupil_diameter_mm = static_cast<float>(estimate->pupil_diameter_mm);
    // An ellipse that this eye's pupil cannot be is a lash or a lid: 3 px off (the model's limit) leaves a tenth of the confidence.
    sample.confidence *= static_cast<float>(std::exp(-0.25 * estimate->residual_px * estimate->residual_px));
    newest_ = time;
    return sample;
}

std::optional<RawEyeSample> EyeProcessor::process(const CompressedFrame& frame, TimeNs arrival) {
    ++counts_.pictures;
    if (!decoder_.decode(frame.bytes, image_)) {
        ++counts_.corrupt;
        return std::nullopt;
    }
    if (is_striped(view_of(image_))) {
        ++counts_.striped;
        ++striped_in_a_row_;
        return std::nullopt;
    }
    striped_in_a_row_ = 0;
    mean_level_ = weighted_level(image_);
    return sample_of(detector_.detect(view_of(image_)), frame.time, arrival);
}

int next_exposure(int present, double mean_level, double rate_hz) {
    const int largest = std::max(1, static_cast<int>(10000 / std::max(rate_hz, 1.0)));
    if (mean_level >= 90 && mean_level <= 150) return std::clamp(present, 1, largest);
    const double wanted = present * 120 / std::max(mean_level, 4.0);
    const double next = present + (wanted - present) / 3;
    const int whole = static_cast<int>(std::lround(next));
    return std::clamp(whole == present ? present + (wanted > present ? 1 : -1) : whole, 1, largest);
}

}  // namespace entoptic::drivers
