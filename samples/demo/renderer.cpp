#include "samples/demo/renderer.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/packing.hpp>

#include "samples/demo/emitter.frag.h"
#include "samples/demo/office.vert.h"
#include "samples/demo/surface.frag.h"

namespace samples {

namespace {

constexpr float near_plane = OfficeRenderer::near_plane, far_plane = OfficeRenderer::far_plane;
constexpr std::uint32_t most_eyes = 4;

struct Vertex {
    glm::vec3 position;
    glm::vec2 texture_at;
    glm::vec2 lightmap_at;
    std::array<std::uint8_t, 4> tint;  // linear, UNORM
};

struct ViewUniforms {  // as in office.vert
    glm::mat4 clip_from_world;
    std::array<glm::vec4, 4> channel_radiance;
    glm::vec4 eye;
};

struct EmissionConstants {  // as in emitter.frag
    glm::vec4 radiance_and_edge;
    glm::vec4 centre_and_exponent;
};

std::array<std::uint8_t, 4> packed_tint(glm::vec3 tint) {
    const auto code = [](float x) { return static_cast<std::uint8_t>(std::clamp(x, 0.0F, 1.0F) * 255.0F + 0.5F); };
    return {code(tint.x), code(tint.y), code(tint.z), 255};
}

// What is added to light that is there already: stars and the moon to the sky's, lamps to what they reflect.
bool is_added(Emitter emitter) {
    return emitter == Emitter::stars || emitter == Emitter::moon || (emitter != Emitter::none && reflects(emitter));
}

// Order of drawing: what is near first, so that depth keeps the rest from being shaded; the sky, and last what is added to it.
int drawing_order(Emitter emitter, Material material) {
    if (is_added(emitter)) { return 4; }
    if (emitter == Emitter::outdoors) { return 3; }
    const bool walls = material == Material::plaster || material == Material::floor;
    return walls ? 2 : 1;
}

glm::vec2 texture_coordinates(const Patch& patch, float s, float t) {
    const glm::vec4& r = patch.texture;
    if (patch.texture_turned) { return {std::lerp(r.x, r.z, t), std::lerp(r.y, r.w, s)}; }
    return {std::lerp(r.x, r.z, s), std::lerp(r.y, r.w, t)};
}

glm::vec2 lightmap_coordinates(const LightmapBlock& block, const Lightmap& map, float s, float t) {
    const glm::vec2 texel(static_cast<float>(block.x) + 0.5F + s * static_cast<float>(block.width - 1),
                          static_cast<float>(block.y) + 0.5F + t * static_cast<float>(block.height - 1));
    return texel / glm::vec2(map.width, map.height);
}

// `emits`: as an emitter, else as a surface. The tint is a surface's albedo, and the colour of an emitter that is no surface.
void append_vertices(const Patch& patch, bool emits, const LightmapBlock& block, const Lightmap& map, std::vector<Vertex>& vertices) {
    const auto columns = static_cast<std::uint32_t>(patch.columns), rows = static_cast<std::uint32_t>(patch.rows);
    for (std::uint32_t row = 0; row <= rows; ++row) {
        for (std::uint32_t column = 0; column <= columns; ++column) {
            const float s = static_cast<float>(column) / static_cast<float>(columns),
                        t = static_cast<float>(row) / static_cast<float>(rows);
            vertices.push_back({patch.positions[row * (columns + 1) + column], texture_coordinates(patch, s, t),
                                emits ? glm::vec2(patch.emission, 0) : lightmap_coordinates(block, map, s, t),
                                packed_tint(emits && reflects(patch.emitter) ? glm::vec3(1) : patch.tint)});
        }
    }
}

// Lamps are drawn twice, as surfaces and as lights, which must be the same; small patches have nothing to save.
bool has_levels(const Patch& patch) { return patch.emitter == Emitter::none && patch.columns * patch.rows >= 64; }

}  // namespace

glm::mat4 clip_from_world(const EyeView& view) {
    const float width = view.tan_right - view.tan_left, height = view.tan_up - view.tan_down;
    glm::mat4 clip(0);
    clip[0][0] = 2 / width;
    clip[1][1] = -2 / height;
    clip[2][0] = (view.tan_right + view.tan_left) / width;
    clip[2][1] = -(view.tan_up + view.tan_down) / height;
    clip[2][2] = far_plane / (near_plane - far_plane);
    clip[2][3] = -1;
    clip[3][2] = near_plane * far_plane / (near_plane - far_plane);
    const glm::mat4 world_from_eye = glm::translate(glm::mat4(1), view.position) * glm::mat4_cast(view.orientation);
    return clip * glm::inverse(world_from_eye);
}

VkRect2D finely_seen(const EyeView& view, VkExtent2D extent) {
    constexpr float margin = 3.0F * std::numbers::pi_v<float> / 180;  // choice: 1 degree of error, and a small saccade that is under way
    const VkRect2D all{{0, 0}, extent};
    if (!view.seen) { return all; }
    const float width = view.tan_right - view.tan_left, height = view.tan_up - view.tan_down;
    // Pixels are finest in angle at the rim of a flat picture; ahead they are largest, and there they would be seen first.
    const float pixel = std::max(width / static_cast<float>(extent.width), height / static_cast<float>(extent.height));
    const float radius = (pixel / view.seen->resolved_angle - 1) / view.seen->eccentricity_factor;
    if (!(radius > 0)) { return {}; }
    const float cone = std::min(radius + margin, 1.0F);
    // The cone about the gaze, by points on its rim; one that leaves the half space ahead takes everything.
    const glm::vec3 gaze = glm::normalize(view.seen->gaze);
    const glm::vec3 side = glm::normalize(glm::cross(gaze, std::abs(gaze.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
    const glm::vec3 up = glm::cross(side, gaze);
    glm::vec2 low(1e9F), high(-1e9F);
    constexpr int points = 32;
    for (int i = 0; i < points; ++i) {
        const float turn = 2 * std::numbers::pi_v<float> * static_cast<float>(i) / points;
        const glm::vec3 d = gaze * std::cos(cone) + (side * std::cos(turn) + up * std::sin(turn)) * std::sin(cone);
        if (!(d.z < -0.05F)) { return all; }
        const glm::vec2 at((d.x / -d.z - view.tan_left) / width * static_cast<float>(extent.width),
                           (view.tan_up - d.y / -d.z) / height * static_cast<float>(extent.height));
        low = glm::min(low, at);
        high = glm::max(high, at);
    }
    const glm::vec2 end(extent.width, extent.height);
    low = glm::clamp(glm::floor(low) - 1.0F, glm::vec2(0), end);
    high = glm::clamp(glm::ceil(high) + 1.0F, glm::vec2(0), end);
    return {{static_cast<std::int32_t>(low.x), static_cast<std::int32_t>(low.y)},
            {static_cast<std::uint32_t>(high.x - low.x), static_cast<std::uint32_t>(high.y - low.y)}};
}

OfficeRenderer::OfficeRenderer(const Gpu& gpu, const Office& office, const std::vector<Canvas>& materials, const Lightmap& lightmap,
                               const DrawOptions& options)
    : gpu_(gpu), options_(options), bulb_centre_(office.bulb_centre) {
    for (const glm::vec4& lux : lightmap.texels) { largest_illuminance_ = glm::max(largest_illuminance_, lux); }
    for (const Patch& patch : office.patches) {
        brightest_star_ = patch.emitter == Emitter::stars ? std::max(brightest_star_, patch.emission) : brightest_star_;
    }
    upload_mesh(office, lightmap);
    upload_textures(materials, lightmap);
    create_layout();
    const bool four = options.samples == Sampling::four;
    style_ = create_style({format, four ? VK_SAMPLE_COUNT_4_BIT : VK_SAMPLE_COUNT_1_BIT, true, options.keep_depth, false});
    if (options.samples == Sampling::gaze) { fine_style_ = create_style({format, VK_SAMPLE_COUNT_4_BIT, true, options.keep_depth, true}); }
}

void OfficeRenderer::upload_mesh(const Office& office, const Lightmap& lightmap) {
    std::map<std::tuple<int, Emitter, Material>, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < office.patches.size(); ++i) {
        const Patch& patch = office.patches[i];
        if (reflects(patch.emitter)) { groups[{drawing_order(Emitter::none, patch.material), Emitter::none, patch.material}].push_back(i); }
        if (patch.emitter != Emitter::none) {
            groups[{drawing_order(patch.emitter, patch.material), patch.emitter, patch.material}].push_back(i);
        }
    }
    std::vector<Vertex> vertices;
    std::vector<std::uint32_t> indices;
    // The triangles of a level of a patch whose vertices begin at `first`.
    const auto append = [&](const Patch& patch, const DetailLevel& level, std::uint32_t first) {
        const auto start = static_cast<std::uint32_t>(indices.size());
        for (const std::uint32_t index : triangles_of(patch, level)) { indices.push_back(first + index); }
        return Range{start, static_cast<std::uint32_t>(indices.size()) - start};
    };
    for (const auto& [key, members] : groups) {
        Batch batch{std::get<1>(key),
                    std::get<2>(key),
                    {static_cast<std::uint32_t>(indices.size()), 0},
                    {static_cast<std::uint32_t>(parts_.size()), 0},
                    0};
        std::vector<std::pair<const Patch*, std::uint32_t>> in_parts;  // with their first vertices
        std::size_t most_levels = 1;
        for (const std::size_t i : members) {
            const Patch& patch = office.patches[i];
            const auto first = static_cast<std::uint32_t>(vertices.size());
            append_vertices(patch, batch.emitter != Emitter::none, lightmap.blocks[i], lightmap, vertices);
            if (has_levels(patch)) {
                parts_.push_back({detail_levels(patch), {}, cover_of(patch)});
                in_parts.emplace_back(&patch, first);
                most_levels = std::max(most_levels, parts_.back().levels.size());
            } else {
                batch.fixed.count += append(patch, {}, first).count;
            }
        }
        batch.parts.count = static_cast<std::uint32_t>(in_parts.size());
        for (std::size_t level = 0; level < most_levels; ++level) {  // level by level, so that neighbours of one level are one range
            for (std::size_t i = 0; i < in_parts.size(); ++i) {
                Part& part = parts_[batch.parts.first + i];
                if (level < part.levels.size()) {
                    part.ranges.push_back(append(*in_parts[i].first, part.levels[level], in_parts[i].second));
                }
            }
            if (level == 0) { batch.whole = static_cast<std::uint32_t>(indices.size()) - batch.fixed.first; }
        }
        whole_triangles_ += batch.whole / 3;
        batches_.push_back(batch);
    }
    vertices_ = create_buffer_from(gpu_, std::as_bytes(std::span(vertices)), VK_BUFFER_USAGE_VERTEX_BUFFER_BIT);
    indices_ = create_buffer_from(gpu_, std::as_bytes(std::span(indices)), VK_BUFFER_USAGE_INDEX_BUFFER_BIT);
}

void OfficeRenderer::upload_textures(const std::vector<Canvas>& materials, const Lightmap& lightmap) {
    std::vector<std::byte> texels(lightmap.texels.size() * 8);
    for (std::size_t i = 0; i < lightmap.texels.size(); ++i) {
        const std::uint64_t halves = glm::packHalf4x16(lightmap.texels[i]);
        std::memcpy(&texels[i * 8], &halves, 8);
    }
    const std::array levels{std::move(texels)};
    lightmap_ = create_texture(gpu_, VK_FORMAT_R16G16B16A16_SFLOAT, {lightmap.width, lightmap.height}, levels);
    repeat_ = create_sampler(gpu_, VK_FILTER_LINEAR, VK_SAMPLER_ADDRESS_MODE_REPEAT, VK_SAMPLER_ADDRESS_MODE_REPEAT);
    clamp_ = create_sampler(gpu_, VK_FILTER_LINEAR, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE);

    constexpr auto both = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;
    const std::array view_bindings{SetBinding{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, both},
                                   SetBinding{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, VK_SHADER_STAGE_FRAGMENT_BIT}};
    view_layout_ = create_set_layout(gpu_, view_bindings);
    material_layout_ = create_set_layout(gpu_, std::span(view_bindings).subspan(1));
    const auto count = static_cast<std::uint32_t>(materials.size());
    pool_ = create_descriptor_pool(gpu_, count + most_eyes, most_eyes, count + most_eyes);
    for (const Canvas& canvas : materials) {
        textures_.push_back(create_texture(gpu_, VK_FORMAT_R8G8B8A8_SRGB, {canvas.width(), canvas.height()}, canvas.srgb_levels()));
        material_sets_.push_back(allocate_set(gpu_, pool_.get(), material_layout_.get()));
        // Boards and plaster repeat; pictures must not bleed from one edge to the other.
        const auto material = static_cast<Material>(textures_.size() - 1);
        const bool repeats =
            material == Material::wood || material == Material::floor || material == Material::plaster || material == Material::fabric;
        write_image(gpu_, material_sets_.back(), 0, textures_.back().view.get(), repeats ? repeat_.get() : clamp_.get());
    }
}

void OfficeRenderer::create_layout() {
    const std::array sets{view_layout_.get(), material_layout_.get()};
    const std::array constants{VkPushConstantRange{VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(EmissionConstants)}};
    pipeline_layout_ = create_pipeline_layout(gpu_, sets, constants);
}

OfficeRenderer::Style OfficeRenderer::create_style(const PassFormat& pass) const {
    Style style;
    style.format = pass;
    style.render_pass = create_render_pass(gpu_, pass);
    const std::array<VkVertexInputAttributeDescription, 4> attributes{{
        {0, 0, VK_FORMAT_R32G32B32_SFLOAT, offsetof(Vertex, position)},
        {1, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(Vertex, texture_at)},
        {2, 0, VK_FORMAT_R32G32_SFLOAT, offsetof(Vertex, lightmap_at)},
        {3, 0, VK_FORMAT_R8G8B8A8_UNORM, offsetof(Vertex, tint)},
    }};
    PipelineDescription description;
    description.vertex_spirv = office_vert_spv;
    description.fragment_spirv = surface_frag_spv;
    description.layout = pipeline_layout_.get();
    description.render_pass = style.render_pass.get();
    description.samples = pass.samples;
    description.vertex_stride = sizeof(Vertex);
    description.attributes = attributes;
    description.depth_test = true;
    description.depth_write = true;
    description.cull_back_faces = true;
    style.surface = create_pipeline(gpu_, description);
    description.fragment_spirv = emitter_frag_spv;
    style.emitter = create_pipeline(gpu_, description);
    description.blend = Blend::add;
    description.depth_write = false;
    style.added_emitter = create_pipeline(gpu_, description);
    return style;
}

void OfficeRenderer::add_eye(VkExtent2D extent, const std::vector<VkImage>& images, const std::vector<VkImage>& depth_images) {
    Buffer uniforms = create_buffer(gpu_, sizeof(ViewUniforms), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT);
    const VkDescriptorSet set = allocate_set(gpu_, pool_.get(), view_layout_.get());
    write_uniform_buffer(gpu_, set, 0, uniforms.buffer.get(), 0, sizeof(ViewUniforms));
    write_image(gpu_, set, 1, lightmap_.view.get(), clamp_.get());
    const auto pass = [&](const Style& style) {
        return EyePass(gpu_, style.format, style.render_pass.get(), extent, images, depth_images);
    };
    eyes_.push_back({pass(style_), std::nullopt, std::move(uniforms), set, {}});
    if (fine_style_) { eyes_.back().fine.emplace(pass(*fine_style_)); }
}

void OfficeRenderer::set_light(const Light& light, float unit_cd_m2) {
    light_ = light;
    unit_ = unit_cd_m2;
}

// Radiance of an emitter as linear RGB in cd/m².
glm::vec3 OfficeRenderer::emitted(Emitter emitter, const Light& light) const {
    const auto colours = channel_colours(light, options_.lamp_peak_cd_m2);
    switch (emitter) {
        case Emitter::outdoors:
            return colours[light_sky];
        case Emitter::ceiling_panel:
            return colours[light_ceiling];
        case Emitter::bulb:
            return blackbody(2700) * static_cast<float>(options_.lamp_peak_cd_m2 * light.lamp);
        case Emitter::moon:
            return blackbody(4100) * static_cast<float>(moon_cd_m2 * light.moon);
        case Emitter::power_led:
            return glm::vec3(static_cast<float>(power_led_cd_m2));
        case Emitter::stars:
            return glm::vec3(1);  // each star has its own luminance
        case Emitter::none:
            break;
    }
    return glm::vec3(0);
}

static double largest(glm::vec3 rgb) { return std::max({rgb.x, rgb.y, rgb.z}); }

double OfficeRenderer::brightest(const Light& light) const {
    double bound = 0;
    for (const Emitter emitter : {Emitter::outdoors, Emitter::ceiling_panel, Emitter::bulb, Emitter::moon, Emitter::power_led}) {
        bound = std::max(bound, largest(emitted(emitter, light)));
    }
    bound = std::max(bound, double{brightest_star_} + largest(emitted(Emitter::outdoors, light)));
    bound = std::max(bound, largest(emitted(Emitter::moon, light) + emitted(Emitter::outdoors, light)));
    const auto colours = channel_colours(light, options_.lamp_peak_cd_m2);
    double reflected = 0;  // by a white surface where each light is strongest
    for (int i = 0; i < 4; ++i) { reflected += largest(colours[static_cast<std::size_t>(i)]) * largest_illuminance_[i] / std::numbers::pi; }
    return std::max(bound, reflected);
}

static double pixel_count(VkExtent2D extent) { return static_cast<double>(extent.width) * static_cast<double>(extent.height); }

template <class Draw> void OfficeRenderer::for_ranges(const Batch& batch, const Levels& levels, const Draw& draw) const {
    if (levels.empty()) { return draw(Range{batch.fixed.first, batch.whole}); }
    Range joined = batch.fixed;
    for (std::uint32_t i = batch.parts.first; i < batch.parts.first + batch.parts.count; ++i) {
        const Range range = parts_[i].ranges[levels[i]];
        if (range.first != joined.first + joined.count) {
            if (joined.count > 0) { draw(joined); }
            joined = {range.first, 0};
        }
        joined.count += range.count;
    }
    if (joined.count > 0) { draw(joined); }
}

void OfficeRenderer::set_view(const Eye& eye, const EyeView& view) const {
    eye.pass.wait();  // before its uniforms change
    if (eye.fine) { eye.fine->wait(); }
    ViewUniforms uniforms{};
    uniforms.clip_from_world = clip_from_world(view);
    const auto colours = channel_colours(light_, options_.lamp_peak_cd_m2);
    for (std::size_t i = 0; i < colours.size(); ++i) {
        uniforms.channel_radiance[i] = glm::vec4(colours[i] / (std::numbers::pi_v<float> * unit_), 0);
    }
    uniforms.eye = glm::vec4(view.position, 1);
    std::memcpy(eye.uniforms.mapped, &uniforms, sizeof(uniforms));
}

void OfficeRenderer::choose_levels(Eye& eye, const EyeView& view) const {
    eye.levels.resize(parts_.size(), 0);
    for (std::size_t i = 0; i < parts_.size(); ++i) {
        eye.levels[i] = choose_level(parts_[i].levels, unseen_deviation(view, parts_[i].cover), eye.levels[i]);
    }
}

std::uint64_t OfficeRenderer::triangles(const Levels& levels) const {
    std::uint64_t indices = 0;
    for (const Batch& batch : batches_) {
        for_ranges(batch, levels, [&](Range range) { indices += range.count; });
    }
    return indices / 3;
}

void OfficeRenderer::draw_pass(Eye& eye, std::uint32_t image, std::uint32_t depth, const Levels& levels, DrawCost* cost) {
    eye.pass.draw(image, depth, eye.pass.whole(), [&](VkCommandBuffer commands) { record(commands, style_, eye, levels); });
    if (cost == nullptr) { return; }
    ++cost->pictures;
    cost->triangles += static_cast<double>(triangles(levels));
    if (!options_.measure) { return; }
    eye.pass.wait();
    if (const auto ms = eye.pass.milliseconds()) { cost->milliseconds.push_back(*ms); }
}

void OfficeRenderer::draw_whole(std::uint32_t index, std::uint32_t image, std::uint32_t depth, const EyeView& view) {
    Eye& eye = eyes_.at(index);
    set_view(eye, view);
    draw_pass(eye, image, depth, {}, nullptr);
}

void OfficeRenderer::draw(std::uint32_t index, std::uint32_t image, std::uint32_t depth, const EyeView& view) {
    Eye& eye = eyes_.at(index);
    set_view(eye, view);
    if (options_.measure) { draw_pass(eye, image, depth, {}, &whole_cost_); }
    if (options_.detail == Detail::gaze) { choose_levels(eye, view); }
    draw_pass(eye, image, depth, eye.levels, &cost_);
    const VkExtent2D extent = eye.pass.extent();
    const double pixels = pixel_count(extent);
    pixels_ += pixels;
    if (style_.format.samples == VK_SAMPLE_COUNT_4_BIT) { fine_pixels_ += pixels; }
    if (!eye.fine) { return; }
    const VkRect2D area = finely_seen(view, extent);
    if (area.extent.width == 0 || area.extent.height == 0) { return; }
    fine_pixels_ += pixel_count(area.extent);
    eye.fine->draw(image, depth, area, [&](VkCommandBuffer commands) { record(commands, *fine_style_, eye, eye.levels); });
}

void OfficeRenderer::record(VkCommandBuffer commands, const Style& style, const Eye& eye, const Levels& levels) const {
    const VkBuffer vertex_buffer = vertices_.buffer.get();
    const VkDeviceSize offset = 0;
    vkCmdBindVertexBuffers(commands, 0, 1, &vertex_buffer, &offset);
    vkCmdBindIndexBuffer(commands, indices_.buffer.get(), 0, VK_INDEX_TYPE_UINT32);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_layout_.get(), 0, 1, &eye.set, 0, nullptr);
    VkPipeline bound = VK_NULL_HANDLE;
    for (const Batch& batch : batches_) {
        const VkPipeline pipeline = batch.emitter == Emitter::none ? style.surface.get()
                                    : is_added(batch.emitter)      ? style.added_emitter.get()
                                                                   : style.emitter.get();
        if (pipeline != bound) {
            vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline);
            bound = pipeline;
        }
        if (batch.emitter != Emitter::none) {
            const bool bulb = batch.emitter == Emitter::bulb;
            const EmissionConstants constants{
                glm::vec4(emitted(batch.emitter, light_) / unit_, bulb ? static_cast<float>(bulb_edge_share) : 1.0F),
                glm::vec4(bulb_centre_, static_cast<float>(bulb_profile_exponent()))};
            vkCmdPushConstants(commands, pipeline_layout_.get(), VK_SHADER_STAGE_FRAGMENT_BIT, 0, sizeof(constants), &constants);
        }
        const VkDescriptorSet set = material_sets_[static_cast<std::size_t>(batch.material)];
        vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_layout_.get(), 1, 1, &set, 0, nullptr);
        for_ranges(batch, levels, [&](Range range) { vkCmdDrawIndexed(commands, range.count, 1, range.first, 0, 0); });
    }
}

void OfficeRenderer::wait() const {
    for (const Eye& eye : eyes_) {
        eye.pass.wait();
        if (eye.fine) { eye.fine->wait(); }
    }
}

}  // namespace samples
