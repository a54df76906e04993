#include "samples/viewer/viewer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <glm/gtc/packing.hpp>

#include "samples/viewer/screen.vert.h"
#include "samples/viewer/surround.frag.h"

namespace samples {

namespace {

constexpr double largest_fp16 = 65504;

struct ViewConstants {  // as in surround.frag
    glm::vec4 tangents;
    glm::vec4 orientation;
    glm::vec2 half_size;
    std::uint32_t flat_map;
};

double largest_finite(const Picture& picture) {
    float largest = 0;
    for (const glm::vec3& p : picture.pixels) {
        for (int i = 0; i < 3; ++i) { largest = std::isfinite(p[i]) ? std::max(largest, std::abs(p[i])) : largest; }
    }
    return largest;
}

// Pixels as RGBA of 16 or 32 bits.
std::vector<std::byte> packed(const Picture& picture, float scale, bool half) {
    const std::size_t stride = half ? 8 : 16;
    std::vector<std::byte> bytes(picture.pixels.size() * stride);
    for (std::size_t i = 0; i < picture.pixels.size(); ++i) {
        const glm::vec4 texel(picture.pixels[i] * scale, 1);
        if (half) {
            const std::uint64_t halves = glm::packHalf4x16(texel);
            std::memcpy(&bytes[i * stride], &halves, stride);
        } else {
            std::memcpy(&bytes[i * stride], &texel, stride);
        }
    }
    return bytes;
}

}  // namespace

Exposure choose_exposure(const Picture& picture, double cd_per_unit, bool half) {
    const double largest = largest_finite(picture);
    if (!half || largest <= largest_fp16) { return {1.0F, static_cast<float>(cd_per_unit)}; }
    const double exponent = std::ceil(std::log2(largest / largest_fp16));
    return {static_cast<float>(std::exp2(-exponent)), static_cast<float>(cd_per_unit * std::exp2(exponent))};
}

void Viewer::upload_map(const Gpu& gpu, bool half_target) {
    constexpr VkFormatFeatureFlags needed = VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
    const bool half = map_.half_precision || !gpu.supports(VK_FORMAT_R32G32B32A32_SFLOAT, needed);
    const VkExtent2D extent{map_.picture.width, map_.picture.height};
    aspect_ = static_cast<float>(extent.height) / static_cast<float>(extent.width);
    exposure_ = choose_exposure(map_.picture, options_.cd_per_unit, half || half_target);
    const std::array levels{packed(map_.picture, exposure_.scale, half)};
    texture_ = create_texture(gpu, half ? VK_FORMAT_R16G16B16A16_SFLOAT : VK_FORMAT_R32G32B32A32_SFLOAT, extent, levels);
    map_.picture = {};  // it is on the device now
    const auto around =
        options_.projection == Projection::equirect ? VK_SAMPLER_ADDRESS_MODE_REPEAT : VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    sampler_ = create_sampler(gpu, VK_FILTER_LINEAR, around, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE);
    const std::array bindings{SetBinding{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, VK_SHADER_STAGE_FRAGMENT_BIT}};
    set_layout_ = create_set_layout(gpu, bindings);
    pool_ = create_descriptor_pool(gpu, 1, 0, 1);
    set_ = allocate_set(gpu, pool_.get(), set_layout_.get());
    write_image(gpu, set_, 0, texture_.view.get(), sampler_.get());
}

void Viewer::create_pipeline(const Gpu& gpu, VkFormat format) {
    render_pass_ = create_render_pass(gpu, {.colour = format});
    const std::array sets{set_layout_.get()};
    const std::array constants{VkPushConstantRange{VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(ViewConstants)}};
    layout_ = create_pipeline_layout(gpu, sets, constants);
    PipelineDescription description;
    description.vertex_spirv = screen_vert_spv;
    description.fragment_spirv = surround_frag_spv;
    description.layout = layout_.get();
    description.render_pass = render_pass_.get();
    pipeline_ = samples::create_pipeline(gpu, description);
}

void Viewer::prepare(const Gpu& gpu, const std::vector<EyeImages>& eyes) {
    const VkFormat format = eyes.front().format;
    upload_map(gpu, format == VK_FORMAT_R16G16B16A16_SFLOAT);
    create_pipeline(gpu, format);
    for (const EyeImages& eye : eyes) { eyes_.emplace_back(gpu, PassFormat{.colour = format}, render_pass_.get(), eye.extent, eye.images); }
}

void Viewer::draw(std::uint32_t eye, std::uint32_t image, std::uint32_t depth, const EyeView& view) {
    const float half_width = std::tan(glm::radians(0.5F * options_.fov_degrees));
    const glm::quat& q = view.orientation;
    const ViewConstants constants{{view.tan_left, view.tan_right, view.tan_up, view.tan_down},
                                  {q.x, q.y, q.z, q.w},
                                  {half_width, half_width * aspect_},
                                  options_.projection == Projection::flat ? 1U : 0U};
    const EyePass& pass = eyes_.at(eye);
    pass.draw(image, depth, pass.whole(), [&](VkCommandBuffer commands) {
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_.get());
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), 0, 1, &set_, 0, nullptr);
        vkCmdPushConstants(commands, layout_.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(constants), &constants);
        vkCmdDraw(commands, 3, 1, 0, 0);
    });
}

}  // namespace samples
