#include "drivers/virtual_hmd/virtual_hmd_script.h"

namespace entoptic::drivers {

namespace {

constexpr const char* still = R"(
name = "still"
description = "Head and gaze do not move; the eyes blink now and then."
)";

constexpr const char* look_around = R"(
name = "look-around"
description = "A slow look to the right, left, up and down; the gaze leads the head."
duration_s = 24
loop = true
[head.position_m]
interpolation = "smooth"
keys = [[0, 0, 1.6, 0], [6, 0.06, 1.59, 0], [12, 0, 1.6, 0.02], [18, -0.06, 1.59, 0], [24, 0, 1.6, 0]]
[head.orientation_deg]
interpolation = "smooth"
keys = [[0, 0, 0, 0], [4, 40, 0, 2], [7, 40, 5, 2], [14, -40, 0, -2], [17, -40, -10, -2], [20, 0, 10, 0], [24, 0, 0, 0]]
[gaze.direction_deg]
interpolation = "saccade"
keys = [[0, 0, 0], [0.8, 12, 0], [4.2, 0, 2], [7.2, -14, 0], [10.5, -8, -3], [14.2, 0, 0], [17.2, 12, 6], [20.2, 0, -4], [22.5, 0, 0]]
)";

constexpr const char* saccades = R"(
name = "saccades"
description = "The head is still; the gaze jumps between nine points up to 20 degrees apart."
duration_s = 10
loop = true
[gaze.direction_deg]
interpolation = "saccade"
keys = [[0, 0, 0], [1, 10, 0], [2, -10, 0], [3, 0, 10], [4, 0, -10], [5, 7, 7], [6, -7, -7], [6.5, -7, 7], [7, 7, -7], [8, 2, 0], [9, 0, 0]]
)";

constexpr const char* light_to_dark = R"(
name = "light-to-dark"
description = "The light goes out at 5 s and comes back at 25 s: the pupil opens slowly and closes fast."
duration_s = 30
[pupil.diameter_mm]
interpolation = "smooth"
keys = [[0, 2.6], [5.3, 2.6], [6.5, 4.2], [9, 5.4], [15, 6.3], [25.25, 6.6], [26.4, 3.0], [27, 2.6]]
)";

constexpr const char* blink = R"(
name = "blink"
description = "A blink every two seconds, each fourth one long."
duration_s = 8
loop = true
[blinks]
at = [[1], [3], [5], [7, 0.4]]
spontaneous_per_minute = 0
)";

constexpr const char* tracker_lost = R"(
name = "tracker-lost"
description = "The eye tracker is gone from 2 to 5 s, the head's position from 7 to 8 s, while both move."
duration_s = 10
loop = true
[head.position_m]
interpolation = "smooth"
keys = [[0, 0, 1.6, 0], [5, 0.1, 1.6, 0], [10, 0, 1.6, 0]]
[gaze.direction_deg]
interpolation = "saccade"
keys = [[0, 0, 0], [1, 10, 5], [3, -10, 0], [6, 5, -5], [9, 0, 0]]
[pupil]
diameter_mm = 5.5
[lost]
eyes = [[2, 3]]
head = [[7, 1]]
)";

}  // namespace

const std::vector<BuiltinScript>& builtin_scripts() {
    static const std::vector<BuiltinScript> scripts{{"still", still},       {"look-around", look_around},
                                                    {"saccades", saccades}, {"light-to-dark", light_to_dark},
                                                    {"blink", blink},       {"tracker-lost", tracker_lost}};
    return scripts;
}

}  // namespace entoptic::drivers
