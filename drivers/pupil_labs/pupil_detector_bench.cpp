// Time a frame of the pupil detector on drawn eyes of the cameras' two sizes; real pictures: pupil_images_test.
#include "drivers/pupil_labs/pupil_detector.h"
#include "drivers/pupil_labs/testing/drawn_eye.h"

#include <benchmark/benchmark.h>

namespace entoptic::drivers {
namespace {

void BM_PupilDetector(benchmark::State& state) {
    testing::DrawnEye eye;
    eye.width = eye.height = static_cast<int>(state.range(0));
    eye.pupil = {0.45 * eye.width, 0.52 * eye.width, 0.16 * eye.width, 0.13 * eye.width, 0.5};
    eye.iris_radius = 0.2 * eye.width;
    const Image8 image = testing::draw(eye);
    PupilDetector detector;
    for (auto _ : state) benchmark::DoNotOptimize(detector.detect(view_of(image)));
}
BENCHMARK(BM_PupilDetector)->Arg(192)->Arg(400);

}  // namespace
}  // namespace entoptic::drivers
