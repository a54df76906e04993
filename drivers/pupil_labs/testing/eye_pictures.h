// For tests: what an eye camera sends, as motion JPEG pictures.
#pragma once

#include "drivers/pupil_labs/eye_processor.h"
#include "drivers/pupil_labs/testing/traced_eye.h"

#include <cstdint>
#include <turbojpeg.h>
#include <vector>

namespace entoptic::drivers::testing {

inline std::vector<std::uint8_t> jpeg_of(const Image8& image) {
    tjhandle encoder = tjInitCompress();
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    const int done = tjCompress2(encoder, image.data.data(), image.width, 0, image.height, TJPF_GRAY, &bytes, &size, TJSAMP_GRAY, 90, 0);
    const std::vector<std::uint8_t> out(bytes, bytes + (done == 0 ? size : 0));
    tjFree(bytes);
    tjDestroy(encoder);
    return out;
}

// An eye that looks around, 24 pictures a round, as a Cam3 at 192 px sees it. Its pupil is 4 mm wide, before the cornea magnifies it.
inline TracedEye eye_at(int i) {
    TracedEye eye;
    eye.camera = pupil_labs_camera("Pupil Cam3 ID0", 192, 192);
    const double right = 0.3 * std::sin(2 * M_PI * i / 24), down = 0.2 * std::cos(2 * M_PI * 3 * i / 24);
    eye.pose = {{0, 0, 30}, Eigen::Vector3d(std::sin(right) * std::cos(down), std::sin(down), -std::cos(right) * std::cos(down)), 2};
    eye.seed = static_cast<std::uint64_t>(i);
    return eye;
}

// The 24 pictures of that round; drawn once.
inline const std::vector<std::vector<std::uint8_t>>& eye_pictures() {
    static const auto all = [] {
        std::vector<std::vector<std::uint8_t>> jpegs;
        for (int i = 0; i < 24; ++i) jpegs.push_back(jpeg_of(traced(eye_at(i))));
        return jpegs;
    }();
    return all;
}

// A picture whose lines were mixed up on the way.
inline Image8 striped_picture() {
    Image8 stripes(192, 192, 1);
    for (int y = 0; y < 192; ++y)
        for (int x = 0; x < 192; ++x) stripes.at(x, y, 0) = y / 2 % 2 == 0 ? 40 : 200;
    return stripes;
}

}  // namespace entoptic::drivers::testing
