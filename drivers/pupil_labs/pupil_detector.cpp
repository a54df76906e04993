#include "drivers/pupil_labs/pupil_detector.h"

#include <algorithm>
#include <cmath>

namespace entoptic::drivers {

namespace {

constexpr int largest_working_side = 240;               // px; more costs time and finds no more (pupil_labs.md)
constexpr int smallest_side = 32, largest_side = 4096;  // px
constexpr std::size_t most_places = 12;
constexpr double sure = 0.9;    // a probability that ends the search
constexpr double likely = 0.6;  // ... after a few places
constexpr std::size_t places_if_likely = 4;
constexpr double least_inside = 0.3;        // of a disc within a likelier one
constexpr double least_probability = 0.05;  // below, nothing was found

SmoothImage view_of(const ImageF& image) { return {image.data.data(), image.width, image.height, image.width}; }

// The probability that an outline is the pupil's: logistic regression over the candidates of 241 pictures with a pupil and 53 without
// (pupil_labs.md says which, and how it does on the others). It both chooses among candidates and is the confidence.
double probability_of(const Outline& outline) {
    const OutlineQuality& q = outline.quality;
    const double logit = -31.67 + 4.60 * q.support + 3.06 * q.spread + 1.73 * q.darkness + 7.14 * q.plateau +
                         3.09 * std::log(std::max(1.0, q.contrast)) + 8.44 * outline.ellipse.axis_ratio();
    return 1 / (1 + std::exp(-logit));
}

}  // namespace

void PupilDetector::prepare(GrayView image) {
    const int side = std::max(image.width, image.height);
    reduction_ = (side + largest_working_side - 1) / largest_working_side;
    if (reduction_ > 1) reduce(image, reduction_, reduced_);
    work_ = reduction_ > 1 ? view_of(reduced_) : image;
    reduce(work_, 2, half_);
    reduce(view_of(half_), 2, coarse_);
    low_pass(work_, smooth_);
    const double diagonal = std::hypot(work_.width, work_.height);
    limits_ = {parameters_.min_diameter_share * diagonal, parameters_.max_diameter_share * diagonal, parameters_.min_axis_ratio};
    starts_.clear();
    candidates_.clear();
}

bool PupilDetector::tried(const Ellipse& start) const {
    return std::any_of(starts_.begin(), starts_.end(), [&](const Ellipse& other) {
        return std::hypot(start.x - other.x, start.y - other.y) < 0.12 * other.major &&
               std::abs(start.major - other.major) < 0.2 * other.major && std::abs(start.minor - other.minor) < 0.2 * other.minor;
    });
}

void PupilDetector::try_start(const Ellipse& start, float step) {
    if (start.major < 0.6 * limits_.min_diameter || start.major > 1.4 * limits_.max_diameter || tried(start)) return;
    starts_.push_back(start);
    const SmoothImage image = view_of(smooth_);
    if (quick_support(image, start, 0.3f * step) < 0.4) return;
    if (const auto outline = refine_outline(image, start, limits_)) candidates_.push_back({*outline, probability_of(*outline)});
}

void PupilDetector::try_place(const DarkPlace& place) {
    // A pixel of the coarse picture is 2 px of the half picture, 4 of the working picture, each way.
    const Pixel seed = darkest_near(half_, 2 * place.x + 1, 2 * place.y + 1, std::max(1, 2 * place.half_size));
    const float darkest = half_.at(seed.x, seed.y, 0), surround = coarse_.at(place.x, place.y, 0) + place.response;
    const int largest = static_cast<int>(0.25 * M_PI * limits_.max_diameter * limits_.max_diameter / 4);
    for (const float share : {0.15f, 0.3f, 0.5f, 0.75f}) {
        const float step = share * (surround - darkest);
        const DarkRegion region = regions_.grow(half_, seed, static_cast<int>(darkest + step), largest);
        if (region.area > largest) break;
        if (region.area < 4) continue;
        Ellipse start = scaled(region.ellipse, 2);
        start.minor = std::max(start.minor, 0.45 * start.major);
        try_start(start, std::max(4.0f, step));
    }
}

const PupilDetector::Candidate* PupilDetector::best() const {
    const Candidate* found = nullptr;
    for (const Candidate& candidate : candidates_)
        if (!found || candidate.probability > found->probability) found = &candidate;
    if (!found) return nullptr;
    // An iris has an outline too, and a better one than a small pupil: a likely disc in its middle is the pupil.
    for (const Candidate& candidate : candidates_) {
        const Ellipse &inner = candidate.outline.ellipse, &outer = found->outline.ellipse;
        if (inner.major < 0.75 * outer.major && candidate.probability > std::min(least_inside, 0.8 * found->probability) &&
            std::hypot(inner.x - outer.x, inner.y - outer.y) < 0.25 * outer.major)
            found = &candidate;
    }
    return found;
}

bool PupilDetector::enough(std::size_t places_tried) const {
    double best = 0;
    for (const Candidate& candidate : candidates_) best = std::max(best, candidate.probability);
    return best > sure || (best > likely && places_tried >= places_if_likely);
}

// The outline in the picture's own pixels, from the edges there: only the pupil's surroundings are low-passed.
Outline PupilDetector::refined_in(GrayView image, const Outline& outline) {
    const Ellipse rough = scaled(outline.ellipse, reduction_);
    const int reach = static_cast<int>(rough.major) + 16;
    const int left = std::clamp(static_cast<int>(rough.x) - reach, 0, image.width - 1),
              top = std::clamp(static_cast<int>(rough.y) - reach, 0, image.height - 1);
    const int right = std::min(image.width, left + 2 * reach), bottom = std::min(image.height, top + 2 * reach);
    low_pass({image.data + static_cast<std::ptrdiff_t>(top) * image.stride + left, right - left, bottom - top, image.stride}, fine_);
    Ellipse start = rough;
    start.x -= left;
    start.y -= top;
    const OutlineLimits limits{limits_.min_diameter * reduction_, limits_.max_diameter * reduction_, limits_.min_axis_ratio};
    auto fine = right - left < 8 || bottom - top < 8 ? std::nullopt : refine_outline(view_of(fine_), start, limits);
    if (!fine || std::hypot(fine->ellipse.x - start.x, fine->ellipse.y - start.y) > 2 * reduction_) return {rough, outline.quality};
    fine->ellipse.x += left;
    fine->ellipse.y += top;
    return *fine;
}

PupilDetection PupilDetector::detect(GrayView image) {
    PupilDetection detection;
    if (!image.data || std::min(image.width, image.height) < smallest_side || std::max(image.width, image.height) > largest_side)
        return detection;
    prepare(image);
    if (std::min(coarse_.width, coarse_.height) < 4) return detection;  // a strip
    const int largest_half_size = std::max(1, static_cast<int>(limits_.max_diameter / 8 / 1.5));
    std::size_t tried_places = 0;
    for (const DarkPlace& place : places_.find(coarse_, largest_half_size, most_places)) {
        try_place(place);
        if (enough(++tried_places)) break;
    }
    const Candidate* chosen = best();
    if (!chosen) return detection;
    const Outline outline = reduction_ > 1 ? refined_in(image, chosen->outline) : chosen->outline;
    detection.found = chosen->probability >= least_probability;
    detection.ellipse = outline.ellipse;
    detection.quality = outline.quality;
    detection.confidence = chosen->probability;
    return detection;
}

}  // namespace entoptic::drivers
