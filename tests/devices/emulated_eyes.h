// Pupil Labs' two eye cameras on the kernel's USB, before an eye that looks around.
#pragma once

#include "drivers/pupil_labs/testing/eye_pictures.h"
#include "tests/devices/emulated_camera.h"

namespace entoptic::devices {

// The wearer looks on every eight pictures: once round in a second.
inline Bytes eye_picture(const CameraOffer&, std::int64_t n) {
    return drivers::testing::eye_pictures()[static_cast<std::size_t>(n / 8 % 24)];
}

// On ports of their own beside an EmulatedVive's.
struct EmulatedEyes {
    explicit EmulatedEyes(const EmulatedCamera::Picture& picture = eye_picture)
        : right("Pupil Cam3 ID0", "E0", {{192, 192, 200}, {400, 400, 120}}, picture),
          left("Pupil Cam3 ID1", "E1", {{192, 192, 200}, {400, 400, 120}}, picture) {
        (void)drivers::testing::eye_pictures();  // drawn before the clock counts
    }
    static constexpr int right_port = 4, left_port = 5;
    Result<void> plug() {
        ENTOPTIC_CHECK(right.plug(right_port));
        return left.plug(left_port);
    }
    void freeze(bool frozen) { right.frozen = left.frozen = frozen; }
    EmulatedCamera right, left;
};

}  // namespace entoptic::devices
