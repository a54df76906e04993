// Time of the glare through lashes for both eyes of a headset: few and many lit texels, by billboards and by transforms; gated; a new aperture.
#include "perception/glare/fraunhofer_mask_tables.h"
#include "perception/testing/stage_bench.h"

#include <cstring>

namespace entoptic::perception {
namespace {

using namespace testing;

// `side` x `side` lamps of one pixel, 12 pixels apart.
ImageF lamps(int side) {
    ImageF image = uniform(1440, 1600, 1);
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
            for (int c = 0; c < 3; ++c) image.at(700 + 12 * i, 700 + 12 * j, c) = 1e6f;
    return image;
}
Selection glare(const std::vector<std::string>& settings) {
    std::vector<std::string> all{"glare.lid_open=0.6"};
    all.insert(all.end(), settings.begin(), settings.end());
    return only({"adaptation=krawczyk_exp_linear", "glare=fraunhofer_mask"}, all);
}

// 1 lamp lights 9 to 16 texels a view. `billboards` 0: by transforms.
void GlareFraunhoferMask(benchmark::State& state) {
    time_effect(state, vive_lens(), lamps(static_cast<int>(state.range(0))), glare({"glare.billboard_texels=" + std::to_string(state.range(1))}), "perceive.glare");
}
BENCHMARK(GlareFraunhoferMask)
    ->ArgNames({"lamps", "billboards"})
    ->ArgsProduct({{1, 2, 3}, {0, 256}})
    ->Iterations(5)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

void GlareFraunhoferMaskPhotographic(benchmark::State& state) {
    time_effect(state, vive_lens(), lamps(3), glare({"glare.photographic=1"}), "perceive.glare");
}
BENCHMARK(GlareFraunhoferMaskPhotographic)->Iterations(2)->UseManualTime()->Unit(benchmark::kMillisecond);

// Nothing that the panel could not show: the gate leaves it out.
void GlareFraunhoferMaskGated(benchmark::State& state) {
    time_effect(state, vive_lens(), uniform(1440, 1600, 1), glare({}), "perceive.glare");
}
BENCHMARK(GlareFraunhoferMaskGated)->Iterations(5)->UseManualTime()->Unit(benchmark::kMillisecond);

// What the thread does for a new aperture: raster, transform, table.
void GlareFraunhoferMaskTables(benchmark::State& state) {
    const ModelEntry& entry = *find_model("glare", "fraunhofer_mask");
    const std::vector<float> values = default_parameters(entry);
    FraunhoferMaskParams params{};
    std::memcpy(&params, values.data(), sizeof params);
    for (auto _ : state) benchmark::DoNotOptimize(make_mask_tables(params, nullptr, {16, 10}));
}
BENCHMARK(GlareFraunhoferMaskTables)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace entoptic::perception
