#include "samples/demo/bake.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <thread>

#include "samples/demo/bvh.h"
#include "samples/demo/detail.h"

namespace samples {

namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr float surface_offset = 5e-4F;  // m; start of rays above the surface
constexpr float landscape = 0.2F;        // luminance of the land over that of the sky above it

// Sampling, chosen so that the bake stays under 3 s on two slow cores and no pattern shows in the shadows.
constexpr int window_strata = 5;  // squared: rays to the window
constexpr int panel_strata = 3;
constexpr int bulb_samples = 6;
constexpr int moon_samples = 4;
constexpr int gather_rays = 192;
constexpr int gather_spacing = 4;  // texels of the lightmap between points where interreflection is gathered
constexpr int bounces = 6;         // a seventh would add less than 1 % at albedo 0.5

// A point of the lightmap.
struct Texel {
    std::uint32_t index;  // in Lightmap::texels
    std::uint32_t patch;
    float s, t;
};

// A point of light on the lamp's reflector.
struct ReflectorSample {
    glm::vec3 position, normal;
    float intensity;  // along the normal, cd per lm of the bulb
};

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work) {
    constexpr std::size_t chunk = 256;
    std::atomic<std::size_t> next = 0;
    const auto run = [&] {
        for (std::size_t begin = next.fetch_add(chunk); begin < count; begin = next.fetch_add(chunk)) {
            for (std::size_t i = begin; i < std::min(begin + chunk, count); ++i) { work(i); }
        }
    };
    std::vector<std::jthread> threads;
    for (unsigned i = 1; i < std::max(std::thread::hardware_concurrency(), 1U); ++i) { threads.emplace_back(run); }
    run();
}

// ---- layout ---------------------------------------------------------------------------------------------------------------------

std::uint32_t texels_along(float metres, float density) {
    return static_cast<std::uint32_t>(std::clamp(std::ceil(metres * density) + 1.0F, 2.0F, 400.0F));
}

LightmapBlock block_size(const Patch& patch) {
    if (!reflects(patch.emitter)) { return {}; }
    const auto at = [&](int column, int row) { return patch.positions[static_cast<std::size_t>(row * (patch.columns + 1) + column)]; };
    float along_s = 0, along_t = 0;  // the longest of the patch's rows and columns
    for (int row = 0; row <= patch.rows; ++row) {
        float length = 0;
        for (int column = 0; column < patch.columns; ++column) { length += glm::distance(at(column, row), at(column + 1, row)); }
        along_s = std::max(along_s, length);
    }
    for (int row = 0; row < patch.rows; ++row) { along_t += glm::distance(at(0, row), at(0, row + 1)); }
    return {0, 0, texels_along(along_s, patch.texels_per_m), texels_along(along_t, patch.texels_per_m)};
}

// Blocks in rows, the highest first.
Lightmap lay_out(const std::vector<Patch>& patches) {
    constexpr std::uint32_t width = 1024;
    Lightmap map;
    map.width = width;
    for (const Patch& patch : patches) { map.blocks.push_back(block_size(patch)); }
    std::vector<std::size_t> order(patches.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return map.blocks[a].height > map.blocks[b].height; });
    std::uint32_t x = 0, y = 0, row_height = 0;
    for (const std::size_t i : order) {
        LightmapBlock& block = map.blocks[i];
        if (block.width == 0) { continue; }
        if (x + block.width + 2 > width) {
            x = 0;
            y += row_height;
            row_height = 0;
        }
        block.x = x + 1;
        block.y = y + 1;
        x += block.width + 2;
        row_height = std::max(row_height, block.height + 2);
    }
    map.height = y + row_height;
    map.texels.assign(std::size_t{map.width} * map.height, glm::vec4(0));
    return map;
}

std::uint32_t texel_index(const Lightmap& map, const LightmapBlock& block, std::uint32_t i, std::uint32_t j) {
    return (block.y + j) * map.width + block.x + i;
}

// The texels of all patches. Those on an edge look from a little inside it, so as not to start within a neighbour.
std::vector<Texel> list_texels(const Lightmap& map) {
    std::vector<Texel> texels;
    for (std::size_t p = 0; p < map.blocks.size(); ++p) {
        const LightmapBlock& block = map.blocks[p];
        const auto parameter = [](std::uint32_t i, std::uint32_t n) {
            const float inset = 0.2F / static_cast<float>(n - 1);
            return std::clamp(static_cast<float>(i) / static_cast<float>(n - 1), inset, 1.0F - inset);
        };
        for (std::uint32_t j = 0; j < block.height; ++j) {
            for (std::uint32_t i = 0; i < block.width; ++i) {
                texels.push_back(
                    {texel_index(map, block, i, j), static_cast<std::uint32_t>(p), parameter(i, block.width), parameter(j, block.height)});
            }
        }
    }
    return texels;
}

void repeat_borders(Lightmap& map) {
    for (const LightmapBlock& block : map.blocks) {
        const auto at = [&](std::uint32_t x, std::uint32_t y) -> glm::vec4& { return map.texels[std::size_t{y} * map.width + x]; };
        if (block.width == 0) { continue; }
        for (std::uint32_t x = block.x; x < block.x + block.width; ++x) {
            at(x, block.y - 1) = at(x, block.y);
            at(x, block.y + block.height) = at(x, block.y + block.height - 1);
        }
        for (std::uint32_t y = block.y - 1; y <= block.y + block.height; ++y) {
            at(block.x - 1, y) = at(block.x, y);
            at(block.x + block.width, y) = at(block.x + block.width - 1, y);
        }
    }
}

// ---- direct light ---------------------------------------------------------------------------------------------------------------

// Two numbers a sample that fill the square evenly (the golden-ratio sequences of Roberts), shifted for each texel.
glm::vec2 jitter(std::uint32_t sample, std::uint32_t texel, std::uint32_t light) {
    const glm::vec2 shift(hash01(texel, light, 1), hash01(texel, light, 2));
    return glm::fract(glm::vec2(0.7548777F, 0.5698403F) * static_cast<float>(sample) + shift);
}

class DirectLight {
public:
    DirectLight(const Office& office, const Bvh& bvh) : office_(office), bvh_(bvh) {}

    void set_reflector(std::vector<ReflectorSample> samples) { reflector_ = std::move(samples); }

    // Illuminance of a point of `patch` in the channels' units. No light falls on what gives it.
    glm::vec4 at(const Patch& patch, const SurfacePoint& surface, std::uint32_t texel) const {
        const glm::vec3 from = surface.position + surface.normal * surface_offset;
        glm::vec4 lux(0);
        lux[light_sky] = from_rectangle(office_.window, window_strata, from, surface.normal, texel,
                                        [](glm::vec3 way) { return way.y > 0 ? 1.0F : landscape; });
        lux[light_ceiling] =
            from_rectangle(office_.ceiling_panel, panel_strata, from, surface.normal, texel, [](glm::vec3) { return 1.0F; });
        lux[light_lamp] = from_bulb(from, surface.normal, texel) + (patch.lamp_reflector ? 0.0F : from_reflector(from, surface.normal));
        lux[light_moon] = from_moon(from, surface.normal, texel);
        if (patch.emitter == Emitter::bulb) { lux[light_lamp] = 0; }
        return lux;
    }

private:
    // What one sample of a rectangle of `area` gives, unshadowed.
    template <typename Luminance>
    static float contribution(const RectangleLight& light, float area, glm::vec3 way, glm::vec3 normal, const Luminance& luminance) {
        const float at_surface = glm::dot(way, normal), at_light = -glm::dot(way, light.normal);
        if (at_surface <= 0 || at_light <= 0) { return 0; }
        const float square = glm::dot(way, way);
        // A sample very near its light would count for more than the whole of it.
        return luminance(way) * std::min(area * at_surface * at_light / (square * square), pi);
    }

    // The unshadowed light by a fine regular quadrature, times the share of it that rays find to arrive: where nothing blocks,
    // there is no noise, and elsewhere only that of the shadow.
    template <typename Luminance>
    float from_rectangle(const RectangleLight& light, int strata, glm::vec3 from, glm::vec3 normal, std::uint32_t texel,
                         const Luminance& luminance) const {
        const auto way_to = [&](glm::vec2 at) { return light.corner + light.edge_a * at.x + light.edge_b * at.y - from; };
        const float area = glm::length(glm::cross(light.edge_a, light.edge_b));
        constexpr int fine = 10;
        float unshadowed = 0, largest = 0;
        for (int i = 0; i < fine * fine; ++i) {
            const glm::vec2 at = (glm::vec2(i % fine, i / fine) + 0.5F) / static_cast<float>(fine);
            const float share = contribution(light, area / (fine * fine), way_to(at), normal, luminance);
            unshadowed += share;
            largest = std::max(largest, share);
        }
        if (unshadowed <= 0) { return 0; }
        if (largest > 0.05F * unshadowed) {  // beside the light, where few rays would decide
            strata *= 3;
        }
        float all = 0, arriving = 0;
        for (int i = 0; i < strata * strata; ++i) {
            const glm::vec2 cell(i % strata, i / strata);
            const glm::vec3 way = way_to((cell + jitter(static_cast<std::uint32_t>(i), texel, 1)) / static_cast<float>(strata));
            const float share = contribution(light, area / static_cast<float>(strata * strata), way, normal, luminance);
            all += share;
            // The frame lies just beyond the opening, so rays to the window go on a little; outside nothing else blocks.
            const float beyond = &light == &office_.window ? 0.12F / std::max(-glm::dot(way, light.normal), 1e-3F) : 0.0F;
            if (share > 0 && !bvh_.blocked(from, from + way * (1 + beyond))) { arriving += share; }
        }
        return all > 0 ? unshadowed * arriving / all : 0.0F;
    }

    // A sphere of uniform look: intensity flux / 4 pi; samples on the disc it shows.
    float from_bulb(glm::vec3 from, glm::vec3 normal, std::uint32_t texel) const {
        const glm::vec3 to_centre = glm::normalize(office_.bulb_centre - from);
        const glm::vec3 side =
            glm::normalize(glm::cross(to_centre, std::abs(to_centre.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
        const glm::vec3 up = glm::cross(side, to_centre);
        float lux = 0;
        std::uint32_t count = bulb_samples, arrived = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const glm::vec2 u = jitter(i, texel, 2);
            const float radius = office_.bulb_radius * 0.95F * std::sqrt(u.x), angle = 2 * pi * u.y;
            const glm::vec3 to = office_.bulb_centre + radius * (std::cos(angle) * side + std::sin(angle) * up);
            const glm::vec3 way = to - from;
            const float square = std::max(glm::dot(way, way), office_.bulb_radius * office_.bulb_radius);
            const float cosine = glm::dot(way, normal) / std::sqrt(square);
            if (cosine > 0 && !bvh_.blocked(from, to)) {
                lux += cosine / (square * 4 * pi);
                ++arrived;
            }
            if (i + 1 == bulb_samples && arrived > 0 && arrived < bulb_samples) {
                count = 6 * bulb_samples;  // in the penumbra, which the rim of the shade makes wide
            }
        }
        return lux / static_cast<float>(count);
    }

    float from_reflector(glm::vec3 from, glm::vec3 normal) const {
        float lux = 0;
        for (const ReflectorSample& sample : reflector_) {
            const glm::vec3 way = sample.position - from;
            const float square = std::max(glm::dot(way, way), 4e-4F);  // 2 cm: nearer surfaces are the lamp's own
            const float cosines = glm::dot(way, normal) * -glm::dot(way, sample.normal) / square;
            if (glm::dot(way, normal) > 0 && cosines > 0 && !bvh_.blocked(from, sample.position)) {
                lux += sample.intensity * cosines / square;
            }
        }
        return lux;
    }

    float from_moon(glm::vec3 from, glm::vec3 normal, std::uint32_t texel) const {
        const float cosine = glm::dot(office_.to_moon, normal);
        if (cosine <= 0) { return 0; }
        float lux = 0;
        for (std::uint32_t i = 0; i < moon_samples; ++i) {  // over the texel, about, and the moon's half degree
            const glm::vec2 u = jitter(i, texel, 3) - 0.5F;
            const glm::vec3 to = office_.to_moon * 20.0F + glm::vec3(0, u.x, u.y) * 0.25F;
            lux += bvh_.blocked(from, from + to) ? 0.0F : cosine / static_cast<float>(moon_samples);
        }
        return lux;
    }

    const Office& office_;
    const Bvh& bvh_;
    std::vector<ReflectorSample> reflector_;
};

// Smooths a grid of `width` x `height` with binomial weights over three by three, in the channels where `channels` is 1.
// `first` is its first value, `stride` the distance of its rows.
void smooth(glm::vec4* first, std::size_t stride, std::uint32_t width, std::uint32_t height, glm::vec4 channels) {
    const auto at = [&](std::uint32_t x, std::uint32_t y) -> glm::vec4& { return first[y * stride + x]; };
    std::vector<glm::vec4> rows(std::size_t{width} * height);
    for (std::uint32_t y = 0; y < height; ++y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t before = x > 0 ? x - 1 : 0, after = std::min(x + 1, width - 1);
            rows[std::size_t{y} * width + x] = 0.25F * (at(before, y) + 2.0F * at(x, y) + at(after, y));
        }
    }
    for (std::uint32_t y = 0; y < height; ++y) {
        const std::size_t before = y > 0 ? y - 1 : 0, after = std::min(y + 1, height - 1);
        for (std::uint32_t x = 0; x < width; ++x) {
            const glm::vec4 smooth = 0.25F * (rows[before * width + x] + 2.0F * rows[std::size_t{y} * width + x] + rows[after * width + x]);
            at(x, y) = glm::mix(at(x, y), smooth, channels);
        }
    }
}

// ---- the lamp's reflector -------------------------------------------------------------------------------------------------------------

float area_of(const Patch& patch) {
    float area = 0;
    for (int row = 0; row < patch.rows; ++row) {
        for (int column = 0; column < patch.columns; ++column) {
            const auto at = static_cast<std::size_t>(row * (patch.columns + 1) + column);
            const std::size_t above = at + static_cast<std::size_t>(patch.columns) + 1;
            const auto& p = patch.positions;
            area += 0.5F * glm::length(glm::cross(p[above + 1] - p[at], p[above] - p[at + 1]));
        }
    }
    return area;
}

// The opening is the last row of the reflector's patch.
float opening_of(const Patch& patch) {
    const std::size_t half = static_cast<std::size_t>(patch.columns) / 2,
                      first = static_cast<std::size_t>(patch.rows) * (static_cast<std::size_t>(patch.columns) + 1);
    const float diameter = glm::distance(patch.positions[first], patch.positions[first + half]);
    return 0.25F * pi * diameter * diameter;
}

struct Reflector {
    std::vector<ReflectorSample> samples;
    float gain = 1;
};

Reflector sample_reflector(const Patch& patch, float albedo, const DirectLight& direct) {
    constexpr int rings = 2, sectors = 8;
    Reflector reflector;
    reflector.gain = cavity_gain(albedo, opening_of(patch), area_of(patch));
    for (int ring = 0; ring < rings; ++ring) {
        for (int sector = 0; sector < sectors; ++sector) {
            const float t0 = static_cast<float>(ring) / rings, t1 = static_cast<float>(ring + 1) / rings;
            const float s = (static_cast<float>(sector) + 0.5F) / sectors;
            const SurfacePoint at = evaluate(patch, s, 0.5F * (t0 + t1));
            const glm::vec3 along_s = evaluate(patch, s + 0.25F / sectors, 0.5F * (t0 + t1)).position -
                                      evaluate(patch, s - 0.25F / sectors, 0.5F * (t0 + t1)).position;
            const glm::vec3 along_t = evaluate(patch, s, t1).position - evaluate(patch, s, t0).position;
            const float area = 2.0F * glm::length(glm::cross(along_s, along_t));
            const float lux = direct.at(patch, at, static_cast<std::uint32_t>(ring * sectors + sector))[light_lamp];
            const float exitance = lux * albedo * reflector.gain;
            reflector.samples.push_back({at.position + at.normal * surface_offset, at.normal, exitance * area / pi});
        }
    }
    return reflector;
}

// ---- interreflection ----------------------------------------------------------------------------------------------------------------

// Points on a coarse grid over each patch, and the texels their rays hit.
struct GatherGrid {
    std::uint32_t columns, rows;
    std::size_t first;  // among all points
    bool used;          // whether the patch has a lightmap
};

std::uint32_t gather_points(std::uint32_t texels) { return std::max(2U, (texels + gather_spacing - 2) / gather_spacing + 1); }

glm::vec3 cosine_direction(glm::vec3 normal, glm::vec2 u) {
    const float radius = std::sqrt(u.x), angle = 2 * pi * u.y;
    const glm::vec3 side = glm::normalize(glm::cross(normal, std::abs(normal.y) < 0.9F ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
    return radius * (std::cos(angle) * side + std::sin(angle) * glm::cross(normal, side)) + std::sqrt(1 - u.x) * normal;
}

class Interreflection {
public:
    Interreflection(const Office& office, const Lightmap& map, const Bvh& bvh, std::vector<float> albedos)
        : office_(office), map_(map), albedos_(std::move(albedos)) {
        for (const LightmapBlock& block : map.blocks) {
            const GatherGrid grid{gather_points(block.width), gather_points(block.height), points_.size(), block.width > 0};
            grids_.push_back(grid);
            for (std::uint32_t i = 0; grid.used && i < grid.columns * grid.rows; ++i) {
                points_.push_back({static_cast<std::uint32_t>(grids_.size() - 1), i});
            }
        }
        hits_.resize(points_.size() * gather_rays);
        parallel_for(points_.size(), [&](std::size_t i) { trace(i, bvh); });
    }

    // Adds `bounces` reflections to the direct light in `texels`.
    void add_to(std::vector<glm::vec4>& texels, const std::vector<Texel>& list) const {
        const std::vector<glm::vec4> direct = texels;
        std::vector<glm::vec4> gathered(points_.size());
        for (int bounce = 0; bounce < bounces; ++bounce) {
            parallel_for(points_.size(), [&](std::size_t i) { gathered[i] = gather(i, texels); });
            for (const GatherGrid& grid : grids_) {
                if (grid.used) { smooth(&gathered[grid.first], grid.columns, grid.columns, grid.rows, glm::vec4(1)); }
            }
            parallel_for(list.size(), [&](std::size_t i) {
                const Texel& texel = list[i];
                glm::vec4 indirect = interpolate(gathered, texel);
                if (office_.patches[texel.patch].lamp_reflector) {
                    indirect[light_lamp] = 0;  // in the cavity's gain already
                }
                texels[texel.index] = direct[texel.index] + indirect;
            });
        }
    }

private:
    struct Point {
        std::uint32_t patch, cell;
    };
    static constexpr std::uint32_t miss = UINT32_MAX;

    void trace(std::size_t index, const Bvh& bvh) {
        const Point& point = points_[index];
        const GatherGrid& grid = grids_[point.patch];
        const auto parameter = [](std::uint32_t i, std::uint32_t n) {
            return std::clamp(static_cast<float>(i) / static_cast<float>(n - 1), 0.02F, 0.98F);
        };
        const SurfacePoint at = evaluate(office_.patches[point.patch], parameter(point.cell % grid.columns, grid.columns),
                                         parameter(point.cell / grid.columns, grid.rows));
        const glm::vec3 from = at.position + at.normal * surface_offset;
        for (std::uint32_t ray = 0; ray < gather_rays; ++ray) {
            const glm::vec2 u = jitter(ray, 0, 4);  // the same for all: neighbours err alike, and no grain shows
            const Hit hit = bvh.closest(from, cosine_direction(at.normal, u), 20.0F);
            hits_[index * gather_rays + ray] = hit.patch >= 0 && hit.front ? texel_at(hit) : miss;
        }
    }

    std::uint32_t texel_at(const Hit& hit) const {
        const LightmapBlock& block = map_.blocks[static_cast<std::size_t>(hit.patch)];
        const auto nearest = [](float s, std::uint32_t n) {
            return std::min(static_cast<std::uint32_t>(std::max(s, 0.0F) * static_cast<float>(n - 1) + 0.5F), n - 1);
        };
        return texel_index(map_, block, nearest(hit.s, block.width), nearest(hit.t, block.height));
    }

    // E = integral of L cos = pi * mean of L over cosine-weighted rays, and L = albedo * E / pi at what they hit.
    glm::vec4 gather(std::size_t index, const std::vector<glm::vec4>& texels) const {
        glm::vec4 sum(0);
        for (std::size_t ray = index * gather_rays; ray < (index + 1) * gather_rays; ++ray) {
            if (hits_[ray] != miss) { sum += texels[hits_[ray]] * albedos_[hits_[ray]]; }
        }
        return sum / static_cast<float>(gather_rays);
    }

    glm::vec4 interpolate(const std::vector<glm::vec4>& gathered, const Texel& texel) const {
        const GatherGrid& grid = grids_[texel.patch];
        const float x = texel.s * static_cast<float>(grid.columns - 1), y = texel.t * static_cast<float>(grid.rows - 1);
        const auto column = std::min(static_cast<std::uint32_t>(x), grid.columns - 2),
                   row = std::min(static_cast<std::uint32_t>(y), grid.rows - 2);
        const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
        const auto at = [&](std::uint32_t i, std::uint32_t j) { return gathered[grid.first + std::size_t{j} * grid.columns + i]; };
        return glm::mix(glm::mix(at(column, row), at(column + 1, row), fx), glm::mix(at(column, row + 1), at(column + 1, row + 1), fx), fy);
    }

    const Office& office_;
    const Lightmap& map_;
    std::vector<float> albedos_;  // of each texel of the map; 0 in the lamp's reflector, which is a light of its own
    std::vector<GatherGrid> grids_;
    std::vector<Point> points_;
    std::vector<std::uint32_t> hits_;
};

// Light varies less than shape: patches of very many cells are lit, and throw shadows, as simpler ones. All but leaves stay as they are.
Office simplified_for_light(Office office) {
    constexpr int most_cells = 512;
    for (Patch& patch : office.patches) {
        DetailLevel level;
        while (patch.columns * patch.rows / (level.column_step * level.row_step) > most_cells &&
               patch.columns % (2 * level.column_step) == 0 && patch.rows % (2 * level.row_step) == 0) {
            level.column_step *= 2;
            level.row_step *= 2;
        }
        if (level.column_step > 1) { patch = reduced(patch, level); }
    }
    return office;
}

float luminance_of(glm::vec3 rgb) { return glm::dot(rgb, glm::vec3(0.2126F, 0.7152F, 0.0722F)); }

}  // namespace

float cavity_gain(float albedo, float opening_area, float wall_area) { return 1.0F / (1.0F - albedo * (1.0F - opening_area / wall_area)); }

Lightmap bake(const Office& whole, const std::vector<Canvas>& materials) {
    const Office office = simplified_for_light(whole);
    const Bvh bvh(office.patches);
    Lightmap map = lay_out(office.patches);
    const std::vector<Texel> texels = list_texels(map);
    std::vector<float> material_albedos;
    for (const Canvas& canvas : materials) { material_albedos.push_back(luminance_of(canvas.mean())); }
    const auto albedo_of = [&](const Patch& patch) {
        return material_albedos[static_cast<std::size_t>(patch.material)] * luminance_of(patch.tint);
    };

    DirectLight direct(office, bvh);
    Reflector reflector;
    for (const Patch& patch : office.patches) {
        if (patch.lamp_reflector) { reflector = sample_reflector(patch, albedo_of(patch), direct); }
    }
    direct.set_reflector(reflector.samples);
    std::vector<float> albedos(map.texels.size(), 0.0F);
    parallel_for(texels.size(), [&](std::size_t i) {
        const Texel& texel = texels[i];
        const Patch& patch = office.patches[texel.patch];
        glm::vec4 lux = direct.at(patch, evaluate(patch, texel.s, texel.t), texel.index);
        if (patch.lamp_reflector) { lux[light_lamp] *= reflector.gain; }
        map.texels[texel.index] = lux;
        albedos[texel.index] = patch.lamp_reflector ? 0.0F : albedo_of(patch);
    });
    for (const LightmapBlock& block : map.blocks) {  // what noise is left in the soft shadows of window and panel
        if (block.width > 0) { smooth(&map.texels[texel_index(map, block, 0, 0)], map.width, block.width, block.height, {1, 1, 0, 0}); }
    }
    Interreflection(office, map, bvh, std::move(albedos)).add_to(map.texels, texels);
    repeat_borders(map);
    return map;
}

}  // namespace samples
