// labels: unit
// The demo's light against closed forms: what it shows as cd/m² has to be that.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>

#include "samples/common/failure.h"
#include "samples/demo/bake.h"
#include "samples/demo/light_control.h"
#include "samples/demo/lights.h"

namespace samples {
namespace {

constexpr double pi = std::numbers::pi;

float luminance_of(glm::vec3 rgb) { return glm::dot(rgb, glm::vec3(0.2126F, 0.7152F, 0.0722F)); }

// A rectangle of albedo `albedo` whose normal is right x up.
Patch rectangle(glm::vec3 corner, glm::vec3 right, glm::vec3 up, float albedo) {
    Patch patch;
    patch.positions = {corner, corner + right, corner + up, corner + right + up};
    patch.normals.assign(4, glm::normalize(glm::cross(right, up)));
    patch.tint = glm::vec3(albedo);
    return patch;
}

// An office of nothing: lights far away and facing elsewhere, so that each test turns on its own.
Office empty_office() {
    Office office;
    office.window = {{0, -100, 0}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
    office.ceiling_panel = office.window;
    office.bulb_centre = {0, -100, 0};
    office.bulb_radius = 0.001F;
    office.to_moon = {0, -1, 0};
    return office;
}

std::vector<Canvas> plain_materials() {
    std::vector<Canvas> materials;
    for (std::size_t i = 0; i < static_cast<std::size_t>(Material::count); ++i) { materials.emplace_back(1, 1, glm::vec3(1)); }
    return materials;
}

glm::vec4 lux_at(const Lightmap& map, std::size_t patch, float s, float t) {
    const LightmapBlock& block = map.blocks[patch];
    const auto nearest = [](float u, std::uint32_t n) { return static_cast<std::uint32_t>(u * static_cast<float>(n - 1) + 0.5F); };
    return map.texels[std::size_t{block.y + nearest(t, block.height)} * map.width + block.x + nearest(s, block.width)];
}

TEST(Bulb, ProfileGivesTheFlux) {
    const double p = bulb_profile_exponent();
    double flux = 0;  // 2 pi A integral of L(mu) mu dmu
    constexpr int steps = 100000;
    for (int i = 0; i < steps; ++i) {
        const double mu = (i + 0.5) / steps;
        flux += bulb_peak_cd_m2 * (bulb_edge_share + (1 - bulb_edge_share) * std::pow(mu, p)) * mu / steps;
    }
    flux *= 2 * pi * 4 * pi * bulb_radius_m * bulb_radius_m;
    EXPECT_NEAR(flux, bulb_flux_lm, 1e-3 * bulb_flux_lm);
}

TEST(PreExposure, IsThePowerOfTwoThatFits) {
    for (double brightest = 0.1; brightest < 1e7; brightest *= 3.7) {
        const float unit = pre_exposure(brightest);
        EXPECT_EQ(std::exp2(std::round(std::log2(unit))), unit);
        EXPECT_LE(brightest / unit, 65504.0);
        EXPECT_GT(brightest / unit, 65504.0 / 2.001);
    }
    EXPECT_GE(pre_exposure(0), 1e-6F);  // the extension's range
    EXPECT_LE(pre_exposure(1e30), 1e6F);
}

TEST(Colours, HaveTheLuminanceOfTheirSource) {
    for (const double kelvin : {1800.0, 2700.0, 4100.0, 6500.0, 12000.0}) {
        EXPECT_NEAR(luminance_of(blackbody(kelvin)), 1.0F, 0.02F) << kelvin;
    }
    EXPECT_GT(blackbody(2700).x, blackbody(2700).z);
    EXPECT_LT(blackbody(12000).x, blackbody(12000).z);
}

TEST(Script, InterpolatesTheSkyByItsLogarithm) {
    const std::string path = ::testing::TempDir() + "office_light_test.csv";
    std::ofstream(path) << "time_s,sky_cd_m2,moon,ceiling,lamp\n# dusk to night\n0,100,0,1,0\n\n10,0.01,1,0,1\n";
    const LightScript script = LightScript::load(path);
    EXPECT_EQ(script.at(-1).sky_cd_m2, 100);
    EXPECT_NEAR(script.at(5).sky_cd_m2, 1.0, 1e-9);
    EXPECT_NEAR(script.at(2.5).lamp, 0.25, 1e-12);
    EXPECT_EQ(script.at(99).sky_cd_m2, 0.01);
    for (const char* bad : {"0,1,2\n", "0,1,x,0,0\n", "0,1,0.5a,0,0\n", "1,1,0,0,0\n1,1,0,0,0\n", "", "0,-1,0,0,0\n"}) {
        std::ofstream(path) << bad;
        EXPECT_THROW(LightScript::load(path), Failure) << bad;
    }
    std::remove(path.c_str());
    EXPECT_THROW(LightScript::load(path), Failure);
}

TEST(Control, KeysDimAndEndAScript) {
    LightControl control(preset_light("day"), LightScript::day_cycle());
    control.update({31, 0.01}, {});
    EXPECT_GT(control.light().lamp, 0.99);
    EXPECT_TRUE(control.press('l'));
    control.update({32, 0.01}, {});
    EXPECT_EQ(control.light().lamp, 0);
    EXPECT_TRUE(control.press('s'));
    EXPECT_EQ(control.light().sky_cd_m2, preset_light("starlight").sky_cd_m2);
    EXPECT_FALSE(control.press('q'));
}

TEST(CavityGain, IsThatOfAnIntegratingSphere) {
    EXPECT_FLOAT_EQ(cavity_gain(0.8F, 1.0F, 1.0F), 1.0F);  // a flat plate sees nothing of itself
    EXPECT_NEAR(cavity_gain(0.9F, 1e-6F, 1.0F), 10.0F, 1e-3F);
}

TEST(Bake, BulbFollowsTheInverseSquareLaw) {
    Office office = empty_office();
    office.bulb_centre = {0, 1, 0};
    office.patches.push_back(rectangle({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0.5F));
    const Lightmap map = bake(office, plain_materials());
    EXPECT_NEAR(lux_at(map, 0, 0.5F, 0.5F)[light_lamp], 1 / (4 * pi), 1e-3);
    // At 45°: cos 45° / (4 pi 2 m²).
    EXPECT_NEAR(lux_at(map, 0, 1.0F, 0.5F)[light_lamp], std::sqrt(0.5) / (8 * pi), 1e-3);
}

TEST(Bake, PanelGivesTheIlluminanceOfASquareOverhead) {
    Office office = empty_office();
    office.ceiling_panel = {{-0.5F, 2, -0.5F}, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
    office.patches.push_back(rectangle({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0.5F));
    const Lightmap map = bake(office, plain_materials());
    // Below the corner of an a x b rectangle at height h, with A = a / h, B = b / h, Lambert's closed form; here four of them.
    const double a = 0.25, root = std::sqrt(1 + a * a);
    const double expected = 4 * (a / root) * std::atan(a / root);
    EXPECT_NEAR(lux_at(map, 0, 0.5F, 0.5F)[light_ceiling], expected, 0.01 * expected);
}

TEST(Bake, ShadowsAreDark) {
    Office office = empty_office();
    office.bulb_centre = {0, 2, 0};
    office.to_moon = {0, 1, 0};
    office.patches.push_back(rectangle({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0.0F));
    office.patches.push_back(rectangle({-0.3F, 1, 0.3F}, {0.6F, 0, 0}, {0, 0, -0.6F}, 0.0F));
    const Lightmap map = bake(office, plain_materials());
    EXPECT_EQ(lux_at(map, 0, 0.5F, 0.5F)[light_lamp], 0);
    EXPECT_EQ(lux_at(map, 0, 0.5F, 0.5F)[light_moon], 0);
    EXPECT_NEAR(lux_at(map, 0, 0.0F, 0.5F)[light_moon], 1, 1e-5);
}

TEST(Bake, ClosedBoxKeepsTheEnergy) {
    // All light of a bulb in a closed box of albedo 1/2 is absorbed by its walls: mean illuminance = flux / (A (1 - 1/2)), of
    // which six bounces are 1 - 2^-7. Rays of one pattern for all points and smoothing at the edges may take up to 3 %.
    Office office = empty_office();
    office.bulb_centre = {0.5F, 0.5F, 0.5F};
    const glm::vec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
    office.patches = {rectangle(z, x, -z, 0.5F),     rectangle(y, x, z, 0.5F), rectangle({0, 0, 0}, x, y, 0.5F),
                      rectangle(x + z, -x, y, 0.5F), rectangle(x, z, y, 0.5F), rectangle(z, -z, y, 0.5F)};
    const Lightmap map = bake(office, plain_materials());
    double sum = 0, weights = 0;
    for (const LightmapBlock& block : map.blocks) {
        for (std::uint32_t j = 0; j < block.height; ++j) {
            for (std::uint32_t i = 0; i < block.width; ++i) {  // trapezoids: texels on an edge stand for half an interval
                const bool edge_i = i == 0 || i + 1 == block.width, edge_j = j == 0 || j + 1 == block.height;
                const double weight = (edge_i ? 0.5 : 1.0) * (edge_j ? 0.5 : 1.0);
                sum += weight * map.texels[std::size_t{block.y + j} * map.width + block.x + i][light_lamp];
                weights += weight;
            }
        }
    }
    const double expected = 1.0 / (6 * 0.5) * (1 - std::exp2(-7.0));
    EXPECT_NEAR(sum / weights, expected, 0.03 * expected);
}

TEST(Bake, PaperOnTheDeskHasPlausibleLuminance) {
    const Office office = build_office();
    const std::vector<Canvas> materials = paint_materials();
    const Lightmap map = bake(office, materials);
    std::size_t paper = 0;  // the first of the two, under the lamp
    while (office.patches.at(paper).material != Material::paper) { ++paper; }
    const glm::vec4 lux = lux_at(map, paper, 0.5F, 0.5F);
    const auto luminance = [&](const char* preset) {
        const auto colours = channel_colours(preset_light(preset), bulb_peak_cd_m2);
        float result = 0;
        for (int i = 0; i < 4; ++i) {
            result += 0.8F * lux[i] * luminance_of(colours[static_cast<std::size_t>(i)]) / static_cast<float>(pi);
        }
        std::printf("white paper, %s: %.3g cd/m2\n", preset, static_cast<double>(result));
        return result;
    };
    const auto expect_within = [](float value, float low, float high) {
        EXPECT_GE(value, low);
        EXPECT_LE(value, high);
    };
    expect_within(luminance("day"), 80, 300);   // 300 … 1000 lx, as in an office by day
    expect_within(luminance("dusk"), 20, 120);  // the lamp: 100 … 500 lx
    expect_within(luminance("night"), 20, 120);
    expect_within(luminance("starlight"), 2e-5F, 1e-3F);
}

}  // namespace
}  // namespace samples
