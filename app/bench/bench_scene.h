// The synthetic scene on which `entoptic bench` measures: a dim room with fine detail and colour, a lamp and a small glaring point.
#pragma once

#include "base/image.h"
#include "shaders/eye_geometry.h"

namespace entoptic::app {

// RGB in cd/m². Every effect of the default preset has something to do in it.
ImageF bench_scene(int width, int height);
// What the eye looked at before it: the same from right to left, a tenth as bright.
ImageF bench_scene_before(int width, int height);
// How far away it is, metres: a floor from half a metre at the bottom to 20 m at the top.
ImageF bench_depth(int width, int height);
// Seen under 104 degrees, as in the headset, on a flat picture.
EyeGeometry bench_geometry(int width, int height);
// So many pixels from the middle of the headset's view: 13.85 a degree.
EyeGeometry headset_patch(int width, int height);

}  // namespace entoptic::app
