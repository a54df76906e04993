// The person who looks: where each eye points, how wide its pupil is, and how that is known.
#pragma once

#include "base/time.h"

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

namespace entoptic {

enum class Provenance { absent, modelled, measured };

// One eye at one time, after filtering. Always finite: a lost tracker gives the documented fallback and says so.
struct EyeState {
    glm::vec3 gaze_direction{0, 0, -1};    // unit vector in head coordinates (x right, y up, -z forward)
    Provenance gaze_provenance = Provenance::absent;
    float pupil_diameter_mm = 4;           // entrance pupil, 1.5..9 mm
    Provenance pupil_provenance = Provenance::absent;
    float eyelid_open = 1;                 // 1 open, 0 closed
    float confidence = 0;                  // 0..1, of the sample used
    TimeNs sample_time = 0;                // when the light of that sample fell on the tracker's sensor; 0 unknown
};

struct Observer {
    TimeNs time = 0;                       // the time this is an estimate for (photon time)
    std::array<EyeState, 2> eyes;          // 0 left, 1 right
    glm::vec3 gaze_direction{0, 0, -1};    // combined gaze of both eyes, unit, head coordinates
};

// What a tracker itself reports, before any filter; may hold anything (NaN, zero pupils).
struct RawEyeSample {
    TimeNs time = 0;                       // of exposure
    TimeNs arrival = 0;                    // when the sample became available
    glm::vec3 gaze_direction{0, 0, -1};
    float pupil_diameter_mm = 0;
    float confidence = 0;
};

}  // namespace entoptic
