// labels: gpu
// The foveated stage: its geometry, what it leaves alone, what it changes by how much, and when it is not used.
#include "base/colour_difference.h"
#include "perception/foveation/foveation.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"
#include "shaders/colour_math.glsl"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace entoptic::perception {
namespace {

using namespace testing;

[[maybe_unused]] const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);

vec3 towards(double right_deg, double up_deg) {
    const double degree = std::acos(-1.0) / 180;
    return glm::normalize(vec3(std::tan(right_deg * degree), std::tan(up_deg * degree), -1));
}

Selection foveated(Selection selection, FoveationInverse inverse, float reduction = 2) {
    selection.foveation = {inverse, reduction};
    return selection;
}

FrameInput looking(const vec3& gaze, bool snap = true) {
    FrameInput input = still_input(1, 1.0 / 90, snap);
    input.eyes[0].gaze_direction = gaze;
    return input;
}

// A street at night: dark walls with fine texture, lit windows, lamps far above the panel's white.
ImageF night(const EyeGeometry& g) {
    ImageF image = through_lens(textured(int(g.width), int(g.height), 0.02), g);
    const auto block = [&](double x, double top, int size, float light) {
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i)
                for (int c = 0; c < 3; ++c) image.at(int(x * g.width) + i, int(top * g.height) + j, c) = light;
    };
    block(0.3, 0.35, 5, 3e4f);
    block(0.62, 0.5, 3, 1e5f);
    block(0.75, 0.72, 4, 2e4f);
    for (double x : {0.2, 0.35, 0.5, 0.66}) block(x, 0.62, int(g.width / 24), 4.0f);
    return image;
}

struct Differences {
    double largest_code = 0, p99_code = 0, mean_itp = 0, p99_itp = 0;
};

double degrees_between(const glm::dvec3& a, const glm::dvec3& b) {
    return 2 * std::asin(std::min(0.5 * glm::length(a - b), 1.0)) * 180 / std::acos(-1.0);
}

// Codes (8 bit, sRGB) and colour differences of displayed light, of the pixels within `from_deg`..`to_deg` of the gaze.
Differences differences(const ImageF& a, const ImageF& b, const EyeGeometry& g, const vec3& gaze, double from_deg, double to_deg) {
    std::vector<double> codes, itps;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            const glm::dvec2 px(x + 0.5, y + 0.5);
            if (!geometry::geometry_visible(g, px)) continue;
            const double deg = degrees_between(geometry::geometry_direction(g, px), gaze);
            if (deg < from_deg || deg >= to_deg) continue;
            std::array<double, 3> one{}, two{};
            double largest = 0;
            for (int c = 0; c < 3; ++c) {
                largest = std::max(largest, std::abs(code(double(a.at(x, y, c))) - code(double(b.at(x, y, c)))));
                one[std::size_t(c)] = std::clamp(double(a.at(x, y, c)), 0.04, 130.0);
                two[std::size_t(c)] = std::clamp(double(b.at(x, y, c)), 0.04, 130.0);
            }
            codes.push_back(largest);
            itps.push_back(entoptic::delta_e_itp(one, two));
        }
    if (codes.empty()) return {};
    std::sort(codes.begin(), codes.end());
    std::sort(itps.begin(), itps.end());
    double sum = 0;
    for (double itp : itps) sum += itp;
    const auto p99 = [](const std::vector<double>& v) { return v[std::size_t(0.99 * double(v.size() - 1))]; };
    return {codes.back(), p99(codes), sum / double(itps.size()), p99(itps)};
}

EyeGeometry disc(FoveationInverse inverse, float reduction = 2) {
    const EyeGeometry view = vive_lens();
    return foveated_geometry({&view, 1}, {inverse, reduction});
}

TEST(FoveatedGeometry, DirectionsAndPixelsAreInverse) {
    const EyeGeometry exact = disc(FoveationInverse::exact), fitted = disc(FoveationInverse::fitted);
    double wrong_px = 0, fitted_deg = 0;
    for (double y = 0.5; y < exact.height; y += 3.7)
        for (double x = 0.5; x < exact.width; x += 3.7) {
            const glm::dvec2 px(x, y);
            if (!geometry::geometry_visible(exact, px)) continue;
            wrong_px = std::max(wrong_px, glm::length(geometry::geometry_pixel(exact, geometry::geometry_direction(exact, px)) - px));
            // What the fitted map reads back at a pixel is not quite what it was drawn for.
            const glm::dvec3 shown =
                geometry::geometry_direction(exact, geometry::geometry_pixel(fitted, geometry::geometry_direction(fitted, px)));
            fitted_deg = std::max(fitted_deg, degrees_between(shown, geometry::geometry_direction(exact, px)));
        }
    EXPECT_LT(wrong_px, 1e-6);
    // Equation 3 was fitted to 80 degrees, where it is off by 0.030 (oracle liu_polar); this disc goes on to 96.
    EXPECT_GT(fitted_deg, 0.02);
    EXPECT_LT(fitted_deg, 0.6);
    ledger("foveation", "equation 3", "displacement in degrees max", fitted_deg);
}

TEST(FoveatedGeometry, EveryTexelHoldsAsManySamplesOfTheRetina) {
    const EyeGeometry g = disc(FoveationInverse::exact);
    const double pi = std::acos(-1.0);
    double sum = 0, wrong = 0;
    for (uint y = 0; y < g.height; ++y)
        for (uint x = 0; x < g.width; ++x) {
            const glm::dvec2 px(x + 0.5, y + 0.5);
            if (!geometry::geometry_visible(g, px)) continue;
            const double sr = geometry::geometry_solid_angle(g, px), deg = degrees_between(geometry::geometry_direction(g, px), {0, 0, -1});
            sum += sr;
            // Equation 1 is samples a degree of eccentricity: over a ring of 2 pi sin(alpha) d(alpha) steradians.
            const double samples = sr * visual_polar::polar_density(deg) / (2 * pi * std::sin(deg * pi / 180) * pi / 180);
            if (deg > 0.2 && std::abs(deg - 5.79) > 0.1)
                wrong = std::max(wrong, relative_error(samples, pi / std::pow(double(g.foveal_ppd), 2) / pi));
        }
    EXPECT_LT(wrong, 5e-3);
    EXPECT_NEAR(sum / (2 * pi * (1 - std::cos(double(g.edge_deg) * pi / 180))), 1, 5e-3);
}

TEST(FoveatedGeometry, HasNoSeamAndNoPole) {
    const EyeGeometry g = disc(FoveationInverse::exact);
    // A texel is nowhere wider than the density along the radius asks for: also where the angle wraps and in the middle.
    for (uint y = 0; y + 1 < g.height; ++y)
        for (uint x = 0; x + 1 < g.width; ++x) {
            const glm::dvec2 px(x + 0.5, y + 0.5);
            if (!geometry::geometry_visible(g, px)) continue;
            const glm::dvec3 here = geometry::geometry_direction(g, px);
            const double deg = std::max(degrees_between(here, {0, 0, -1}), 0.5);
            const double radial_ppd = visual_polar::polar_density(deg) * std::pow(double(g.foveal_ppd), 2) /
                                      (2 * std::acos(-1.0) * geometry::foveated_radius_px(g, deg));
            for (const glm::dvec2 step : {glm::dvec2(1, 0), glm::dvec2(0, 1)})
                ASSERT_LT(degrees_between(here, geometry::geometry_direction(g, px + step)), 1.06 / radial_ppd) << x << " " << y;
        }
}

TEST(FoveatedGeometry, TheGazeIsWithinATexelOfTheMiddle) {
    const EyeGeometry g = disc(FoveationInverse::exact);
    for (double right = -38; right <= 38; right += 3.3)
        for (double up = -38; up <= 38; up += 3.3) {
            const vec3 gaze = towards(right, up);
            const FoveatedGaze found = foveated_gaze(g, gaze, 40);
            EXPECT_NEAR(glm::determinant(glm::mat3(found.axes.right, found.axes.up, found.axes.back)), 1, 1e-5);
            EXPECT_NEAR(glm::dot(found.axes.right, found.axes.up), 0, 1e-6);
            if (degrees_between(gaze, {0, 0, -1}) > 40) continue;
            EXPECT_LT(degrees_between(-found.axes.back, gaze), 0.75 / double(g.foveal_ppd)) << right << " " << up;
            EXPECT_LT(degrees_between(found.residual, {0, 0, -1}), 0.75 / double(g.foveal_ppd));
        }
    // Beyond the limit, and behind: at the limit.
    for (const vec3& gaze : {towards(80, 0), vec3(0.3f, 0, 1), vec3(0, 0, 1), vec3(0, 1, 0)}) {
        const FoveatedGaze found = foveated_gaze(g, gaze, 40);
        EXPECT_LT(degrees_between(-found.axes.back, {0, 0, -1}), 40.1);
        EXPECT_EQ(found.residual, vec3(0, 0, -1));
    }
    // A drift of less than half a texel changes nothing.
    EXPECT_EQ(foveated_gaze(g, towards(0.001, 0), 40).axes.back, foveated_gaze(g, towards(-0.001, 0.001), 40).axes.back);
}

Selection pointwise() { return only({"adaptation=krawczyk_exp_log", "tone=key_reinhard"}); }

TEST(Foveation, WhatNoModelChangesComesBackToTheBit) {
    const EyeGeometry g = vive_lens(360, 400);
    ImageF picture = through_lens(textured(360, 400, 3), g);
    for (float& light : picture.data) light = std::min(light, 100.0f);
    StageRunner runner({g}, foveated(value(select("combined")), FoveationInverse::exact));
    FrameInput input = looking(towards(5, 5));
    input.within_display = true;
    const ImageF out = runner.run(picture, input);
    EXPECT_TRUE(runner.stage().foveated());
    EXPECT_EQ(out.data, picture.data);
}

TEST(Foveation, TheFoveaIsThatOfTheFullImage) {
    const EyeGeometry g = vive_lens(360, 400);
    const ImageF picture = night(g);
    StageRunner full({g}, pointwise()), small({g}, foveated(pointwise(), FoveationInverse::exact));
    for (const vec3& gaze : {towards(0, 0), towards(12, -7), towards(-31, 3)}) {
        const ImageF all = full.run(picture, looking(gaze)), part = small.run(picture, looking(gaze));
        EXPECT_TRUE(small.stage().foveated());
        EXPECT_EQ(full.stage().view(0).adaptation_cd_m2, small.stage().view(0).adaptation_cd_m2);
        // Models that look at one pixel at a time: the very values.
        EXPECT_EQ(differences(all, part, g, gaze, 0, 4.5).largest_code, 0) << gaze.x;
        EXPECT_GT(differences(all, part, g, gaze, 10, 90).largest_code, 1);
        EXPECT_TRUE(all_finite(part));
    }
}

TEST(Foveation, UniformLightStaysUniform) {
    const EyeGeometry g = vive_lens(241, 267);
    const ImageF picture = through_lens(uniform(241, 267, 3, 2, 1), g);
    StageRunner full({g}, pointwise()), small({g}, foveated(pointwise(), FoveationInverse::fitted, 4));
    const ImageF all = full.run(picture, looking(towards(9, 4))), part = small.run(picture, looking(towards(9, 4)));
    // Up to the rim of the lens: what is hidden does not count.
    EXPECT_TRUE(small.stage().foveated());
    for (int y = 0; y < 267; ++y)
        for (int x = 0; x < 241; ++x)
            for (int c = 0; c < 3; ++c) {
                const bool shown = geometry::geometry_visible(g, {x + 0.5, y + 0.5});
                ASSERT_TRUE(!shown || std::abs(part.at(x, y, c) / all.at(x, y, c) - 1) < 1e-5f)
                    << x << " " << y << " " << part.at(x, y, c) << " " << all.at(x, y, c);
            }
}

TEST(Foveation, AMovingGazeLeavesTheFoveaStill) {
    const EyeGeometry g = vive_lens(360, 400);
    const ImageF picture = night(g);
    const auto fixed = only({"tone=key_reinhard"});  // no adaptation: nothing but the sampling follows the gaze
    StageRunner runner({g}, foveated(fixed, FoveationInverse::exact));
    runner.stage().set_adaptation(0.1f);
    const ImageF first = runner.run(picture, looking(towards(0, 0)));
    double outside = 0;
    for (int frame = 1; frame <= 12; ++frame) {
        const ImageF next = runner.run(picture, looking(towards(0.07 * frame, 0.05 * frame), false));
        EXPECT_EQ(differences(first, next, g, towards(0, 0), 0, 4).largest_code, 0) << frame;
        outside = std::max(outside, differences(first, next, g, towards(0, 0), 10, 60).p99_code);
    }
    ledger("foveation", "gaze drifts by 1 degree", "flicker beyond 10 degrees p99 code", outside);
    EXPECT_LT(outside, 60);
}

TEST(Foveation, AGazeThatIsNotKnownTakesTheFullImage) {
    const EyeGeometry g = vive_lens(240, 267);
    const ImageF picture = night(g);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    StageRunner full({g}, pointwise()), small({g}, foveated(pointwise(), FoveationInverse::exact));
    const auto why = [&] { return small.stage().effects().back().why; };
    small.run(picture, looking(towards(3, 3)));
    EXPECT_TRUE(small.stage().foveated());
    EXPECT_EQ(why().substr(0, 4), "runs");
    for (const vec3& gaze : {vec3(nan, 0, -1), vec3(0, 0, 0), vec3(3e38f, 0, -1)}) {
        const ImageF all = full.run(picture, looking(gaze)), part = small.run(picture, looking(gaze));
        EXPECT_FALSE(small.stage().foveated());
        EXPECT_EQ(all.data, part.data);
        EXPECT_EQ(why(), "the full image: the gaze is not known");
    }
    FrameInput lost = looking(towards(3, 3));
    lost.eyes[0].gaze_known = false;
    EXPECT_EQ(full.run(picture, lost).data, small.run(picture, lost).data);
    EXPECT_FALSE(small.stage().foveated());
    EXPECT_EQ(small.stage().totals().at("foveation").recorded, 1u);
    EXPECT_EQ(small.stage().totals().at("foveation").gated, 4u);
}

TEST(Foveation, AGazeAtTheRimAndOutside) {
    const EyeGeometry g = vive_lens(241, 267);
    const ImageF picture = night(g);
    StageRunner small({g}, foveated(value(select("combined")), FoveationInverse::exact));
    for (const vec3& gaze : {towards(39, 0), towards(-45, 30), towards(85, 0), vec3(0, 0, 1), vec3(1, 0, 0)}) {
        const ImageF part = small.run(picture, looking(gaze));
        EXPECT_TRUE(small.stage().foveated());
        EXPECT_TRUE(all_finite(part));
        EXPECT_GT(*std::max_element(part.data.begin(), part.data.end()), 1.0f);
    }
}

TEST(Foveation, WhatCannotBeFoveatedSaysSo) {
    const EyeGeometry g = rectilinear(96, 64, 90);
    StageRunner mask({g}, foveated(only({"glare=fraunhofer_mask"}), FoveationInverse::exact));
    mask.run(uniform(96, 64, 1), looking({0, 0, -1}));
    EXPECT_FALSE(mask.stage().foveated());
    EXPECT_NE(mask.stage().effects().back().why.find("fraunhofer_mask"), std::string::npos);
    EyeGeometry sphere{};
    sphere.kind = geometry_equirect;
    sphere.width = 64, sphere.height = 32;
    StageRunner panorama({sphere}, foveated(pointwise(), FoveationInverse::exact));
    panorama.run(uniform(64, 32, 1), looking({0, 0, -1}));
    EXPECT_EQ(panorama.stage().effects().back().why, "the full image: the picture is a whole sphere");
    EXPECT_FALSE(Stage::create(device(), {{EyeGeometry{}}, {}, foveated(pointwise(), FoveationInverse::exact)}));
    for (int size : {1, 2, 3, 7}) {
        StageRunner tiny({rectilinear(size, 1, 30)}, foveated(pointwise(), FoveationInverse::exact));
        EXPECT_TRUE(all_finite(tiny.run(uniform(size, 1, 1), looking({0, 0, -1}))));
    }
}

TEST(Foveation, AfterimagesStayOnTheRetinaWhenTheImageChanges) {
    const EyeGeometry g = rectilinear(240, 180, 90);
    const Selection selection =
        only({"adaptation=krawczyk_exp_log", "tone=key_reinhard", "afterimage=jacobs"}, {"afterimage.photographic=1"});
    const ImageF dark = uniform(240, 180, 5);
    ImageF flash = dark;
    for (int y = 80; y < 100; ++y)
        for (int x = 110; x < 130; ++x)
            for (int c = 0; c < 3; ++c) flash.at(x, y, c) = 1e6f;
    StageRunner full({g}, selection), switching({g}, foveated(selection, FoveationInverse::exact));
    const auto step = [&](StageRunner& runner, const ImageF& picture, const vec3& gaze, bool known) {
        FrameInput input = looking(gaze, false);
        input.dt_s = 0.125;
        input.eyes[0].gaze_known = known;
        return runner.run(picture, input);
    };
    // A flash at the fovea of the full image; then the eye has moved and the image is foveated, and full again.
    ImageF all, part;
    const auto both = [&](const ImageF& picture, const vec3& gaze, bool known) {
        all = step(full, picture, gaze, known);
        part = step(switching, picture, gaze, known);
        EXPECT_EQ(switching.stage().foveated(), known);
        return differences(all, part, g, gaze, 0, 5);
    };
    both(dark, {0, 0, -1}, false);
    both(flash, {0, 0, -1}, false);
    const vec3 moved = towards(8, 2);
    EXPECT_LT(both(dark, moved, true).largest_code, 2);
    EXPECT_LT(both(dark, moved, true).largest_code, 2);
    EXPECT_LT(both(dark, moved, false).largest_code, 2);
    // And there is one to see, where the eye looks now.
    const glm::dvec2 at = geometry::geometry_pixel(g, moved);
    const auto green = [&](const ImageF& image, int x, int y) { return double(image.at(x, y, 1)); };
    const double seen = green(part, int(at.x), int(at.y)) - green(part, 20, 20);
    EXPECT_GT(seen, 0.3);
    EXPECT_NEAR(green(part, int(at.x), int(at.y)), green(all, int(at.x), int(at.y)), 0.1 * seen);
}

TEST(Foveation, DepthOfFieldSharpensWhereTheEyeLooks) {
    const EyeGeometry g = rectilinear(300, 240, 90);
    const ImageF picture = textured(300, 240, 20);
    ImageF depth(300, 240, 1);
    for (int y = 0; y < 240; ++y)
        for (int x = 0; x < 300; ++x) depth.at(x, y, 0) = x < 150 ? 0.4f : 5.0f;
    const Selection selection = only({"dof=dioptric_disc"});
    StageRunner full({g}, selection), small({g}, foveated(selection, FoveationInverse::exact));
    const vec3 gaze = towards(12, 0);
    const ImageF all = full.run(picture, looking(gaze), depth), part = small.run(picture, looking(gaze), depth);
    EXPECT_TRUE(small.stage().foveated());
    EXPECT_EQ(differences(picture, part, g, gaze, 0, 3).largest_code, 0);  // in focus
    EXPECT_GT(differences(picture, part, g, towards(-12, 0), 0, 3).p99_code, 10);
    // Texture blurred with texels of other shapes: alike, not the same.
    EXPECT_LT(differences(all, part, g, towards(-6, 0), 0, 3).p99_code, 60);
}

TEST(Foveation, RunsRepeatToTheBit) {
    const EyeGeometry g = vive_lens(241, 267);
    const ImageF picture = night(g);
    const auto run = [&] {
        StageRunner runner({g}, foveated(value(select("combined")), FoveationInverse::exact));
        ImageF last;
        for (int frame = 0; frame < 4; ++frame) {
            FrameInput input = looking(towards(2.5 * frame, -1.3 * frame), frame == 0);
            input.eyes[0].gaze_known = frame != 2;
            last = runner.run(picture, input);
        }
        return last.data;
    };
    EXPECT_EQ(run(), run());
}

TEST(Foveation, SettingsAreChecked) {
    const Selection set = value(select("combined", {}, {"foveation.inverse=fitted", "foveation.reduction=1.5"}));
    EXPECT_EQ(set.foveation, (FoveationSettings{FoveationInverse::fitted, 1.5f}));
    EXPECT_EQ(value(select("combined")).foveation.inverse, FoveationInverse::off);
    for (const char* wrong : {"foveation.inverse=cubic", "foveation.reduction=5", "foveation.reduction=0.5", "foveation.reduction=nan",
                              "foveation.reduction=2x", "foveation.gaze=1"}) {
        const auto result = select("combined", {}, {wrong});
        ASSERT_FALSE(result) << wrong;
        EXPECT_NE(result.error().message.find(std::string_view(wrong).substr(10, 4)), std::string::npos) << result.error().message;
    }
}

TEST(Foveation, ErrorAgainstTheFullImage) {
    const EyeGeometry g = vive_lens(480, 533);
    const ImageF picture = night(g);
    const struct {
        const char* place;
        vec3 gaze;
        double most_p99_code;
    } places[] = {{"lamp of 3 pixels", towards(4, -3), 24}, {"wall", towards(-12, 14), 1}};
    StageRunner full({g}, value(select("combined"))), small({g}, value(select("combined")));
    for (const FoveationInverse inverse : {FoveationInverse::exact, FoveationInverse::fitted}) {
        check(small.stage().select(foveated(value(select("combined")), inverse)));
        for (const auto& place : places) {
            const ImageF all = full.run(picture, looking(place.gaze)), part = small.run(picture, looking(place.gaze));
            EXPECT_TRUE(small.stage().foveated());
            const Differences fovea = differences(all, part, g, place.gaze, 0, 5), outside = differences(all, part, g, place.gaze, 5, 180);
            const std::string setting = fmt::format("night 480x533 combined {} gaze on {}", name_of(inverse), place.place);
            ledger("foveation", setting, "within 5 deg code p99", fovea.p99_code);
            ledger("foveation", setting, "within 5 deg deltaE ITP p99", fovea.p99_itp);
            ledger("foveation", setting, "within 5 deg deltaE ITP mean", fovea.mean_itp);
            ledger("foveation", setting, "beyond 5 deg code p99", outside.p99_code);
            ledger("foveation", setting, "beyond 5 deg deltaE ITP mean", outside.mean_itp);
            EXPECT_LT(fovea.p99_code, place.most_p99_code) << setting;
            EXPECT_LT(fovea.mean_itp, 2.2) << setting;
            EXPECT_LT(outside.p99_code, 50) << setting;
        }
    }
}

}  // namespace
}  // namespace entoptic::perception
