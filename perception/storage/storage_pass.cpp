#include "perception/storage/storage_pass.h"

#include "shaders/shared_types.h"

#include "perception/storage/storage_pass.comp.h"

#include <algorithm>
#include <cmath>

namespace entoptic::perception {
namespace {

constexpr std::uint32_t group = 256;
constexpr std::uint32_t groups_a_row = 1024;
enum Action : std::uint32_t { into_storage, pass, out_of_storage };

struct Push {
    std::uint32_t pixels;
    Action action;
    float scale;
};

}  // namespace

float pre_exposure(const ImageF& rgb) {
    const float top = rgb.data.empty() ? 0.0f : *std::max_element(rgb.data.begin(), rgb.data.end());
    return top > 0 ? std::exp2(std::floor(std::log2(32768 / top))) : 1.0f;
}

Result<Stored> through_storage(gpu::Device& device, const ImageF& rgb, StorageFormat format, float scale, int passes) {
    const std::size_t pixels = rgb.data.size() / 3;
    const std::vector bindings(2, gpu::BindingKind::storage_buffer);
    ENTOPTIC_TRY(kernel, gpu::Kernel::create(
                             device, {"storage", storage_pass_comp_spv, bindings, sizeof(Push), {static_cast<std::uint32_t>(format)}}));
    ENTOPTIC_TRY(upload, gpu::Buffer::create(device, pixels * sizeof(vec4), gpu::BufferKind::upload, "storage upload"));
    ENTOPTIC_TRY(picture, gpu::Buffer::create(device, pixels * sizeof(vec4), gpu::BufferKind::device, "storage picture"));
    ENTOPTIC_TRY(stored, gpu::Buffer::create(device, pixels * sizeof(vec4), gpu::BufferKind::device, "stored picture"));
    ENTOPTIC_TRY(readback, gpu::Buffer::create(device, pixels * sizeof(vec4), gpu::BufferKind::readback, "storage readback"));
    for (std::size_t i = 0; i < pixels; ++i) upload.as<vec4>()[i] = vec4(rgb.data[3 * i], rgb.data[3 * i + 1], rgb.data[3 * i + 2], 1);

    const std::uint32_t groups = gpu::groups_for(static_cast<std::uint32_t>(pixels), group);
    const gpu::Groups grid{std::min(groups, groups_a_row), gpu::groups_for(groups, groups_a_row), 1};
    ENTOPTIC_TRY(commands, gpu::Commands::create(device, "storage"));
    const auto run = [&](Action action) {
        commands.dispatch(kernel, {stored, picture}, Push{static_cast<std::uint32_t>(pixels), action, scale}, grid);
        commands.barrier();
    };
    ENTOPTIC_CHECK(commands.begin());
    commands.copy(upload, picture, picture.size());
    commands.barrier();
    run(into_storage);
    for (int i = 0; i < passes; ++i) {
        commands.begin_stage("pass");
        run(pass);
        commands.end_stage();
    }
    run(out_of_storage);
    commands.copy(picture, readback, picture.size());
    ENTOPTIC_CHECK(commands.submit());
    ENTOPTIC_CHECK(commands.wait());

    Stored result{ImageF(rgb.width, rgb.height, 3), {}};
    for (std::size_t i = 0; i < pixels; ++i)
        for (int c = 0; c < 3; ++c) result.picture.data[3 * i + static_cast<std::size_t>(c)] = readback.as<vec4>()[i][c];
    for (const gpu::StageTime& t : commands.stage_times()) result.pass_ms.push_back(t.ms);
    return result;
}

}  // namespace entoptic::perception
