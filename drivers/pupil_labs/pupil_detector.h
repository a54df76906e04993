// The pupil in one picture of an eye under infrared light: a dark ellipse, found without knowledge of earlier pictures.
//
// Dark places on a coarse picture, dark regions around them at several thresholds, the edge of each by least squares along its normals
// (pupil_outline.h), then the outline with the most support. What each step is good for and what it costs: pupil_labs.md.
#pragma once

#include "drivers/pupil_labs/dark_regions.h"
#include "drivers/pupil_labs/picture_pyramid.h"
#include "drivers/pupil_labs/pupil_outline.h"

#include <vector>

namespace entoptic::drivers {

struct PupilDetectorParameters {
    // The pupil's major axis as a share of the picture's diagonal. 2 mm at 45 mm through the widest Pupil Labs lens (71 degrees over 400 px)
    // is 0.022; 8 mm at 27.6 mm between the corners of an eye that fills the picture is 0.29 (facts/devices.md 4.2).
    double min_diameter_share = 0.022, max_diameter_share = 0.33;
    double min_axis_ratio = 0.3;
};

struct PupilDetection {
    bool found = false;
    Ellipse ellipse;         // valid if found
    double confidence = 0;   // 0..1: how often such an outline is the pupil's to within 5 px (fitted, pupil_labs.md); 0 when none was found
    OutlineQuality quality;  // what the confidence comes from
};

// Keeps its memory from picture to picture. One thread at a time.
class PupilDetector {
public:
    explicit PupilDetector(const PupilDetectorParameters& parameters = {}) : parameters_(parameters) {}

    // Sides of 32 to 4096 px; other sizes find nothing.
    PupilDetection detect(GrayView image);

private:
    struct Candidate {
        Outline outline;  // px of the working picture
        double probability = 0;
    };

    void prepare(GrayView image);
    void try_place(const DarkPlace& place);
    void try_start(const Ellipse& start, float step);
    bool tried(const Ellipse& start) const;
    bool enough(std::size_t places_tried) const;
    const Candidate* best() const;
    Outline refined_in(GrayView image, const Outline& outline);

    PupilDetectorParameters parameters_;
    OutlineLimits limits_;            // px of the working picture
    int reduction_ = 1;               // px of the picture a px of the working picture, each way
    GrayView work_;                   // the picture itself or a smaller one
    Image8 reduced_, half_, coarse_;  // the working picture where it is a smaller one; its half and quarter
    ImageF smooth_;                   // the working picture after the low-pass
    ImageF fine_;                     // the picture around the pupil after the low-pass, where the working picture is a smaller one
    DarkPlaceFinder places_;
    RegionGrower regions_;
    std::vector<Ellipse> starts_;
    std::vector<Candidate> candidates_;
};

}  // namespace entoptic::drivers
