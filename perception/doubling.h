// Choices that would count an effect twice: two models of one effect in different slots, or a model that does what the viewer's own eye does
// to the picture anyway. One model a slot cannot say that by itself.
#pragma once

#include "perception/preset.h"

namespace entoptic::perception {

// Who looks at what the stage makes. What doubles an effect for one of them does so for all before it.
enum class Viewer {
    wearer,    // of a headset: their own eye scatters, blurs and adapts to what the panel shows, and it is this eye that blinks
    onlooker,  // at a display that shows somebody else's view: as the wearer, but for the lids
    reader,    // of a picture on a page: the eye in the scene is nobody's own
};

// A usage error with one sentence for the first doubling that there is, which says what is doubled and what to choose instead.
Result<void> expect_no_doubling(const Selection& selection, Viewer viewer);

}  // namespace entoptic::perception
