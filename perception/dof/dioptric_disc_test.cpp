// labels: gpu
#include "perception/dof/dioptric_disc_math.glsl"
#include "perception/dof/dof.h"
#include "perception/testing/dof_scenes.h"
#include "perception/testing/gate_sweep.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "dof.dioptric_disc";
constexpr double degree = std::numbers::pi / 180;

DioptricDiscParams defaults() { return {1, -1, 0, 0.3f, 0.15f, 32, 0, 0}; }
Selection model(std::vector<std::string> settings = {}) {
    for (std::string& s : settings) s = "dof." + s;
    return only({"dof=dioptric_disc"}, settings);
}
std::vector<float> values(const DioptricDiscParams& p) {
    return {p.strength, p.focus_dioptre, p.use_vergence, p.focus_tau_s, p.deadband_dioptre, p.max_radius_px, p.lca, p.roulette};
}
FrameInput looking(double pupil_mm = 4.49, vec3 gaze = {0, 0, -1}) {
    FrameInput input = still_input(1);
    input.eyes[0].pupil_diameter_mm = static_cast<float>(pupil_mm);
    input.eyes[0].gaze_direction = gaze;
    return input;
}

ImageD twin(const ImageF& picture, const ImageF& depth, const EyeGeometry& g, double focus, const DioptricDiscParams& p,
            double pupil = 4.49) {
    const auto radii = [&](double d, double rad) { return dioptric_disc::blur_radii_px(p, d, focus, pupil, rad); };
    return gathered_twin(picture, depth, g, focus, p.lca > 0.5f ? dof_colours_lca : dof_colours_alike, radii);
}
ImageD reference(const ImageF& picture, const ImageF& depth, const EyeGeometry& g, const DioptricDiscParams& p, double pupil = 4.49) {
    ReferenceFrame frame{convert<double>(picture), g, {}, looking(pupil).eyes[0], 0, true};
    frame.dioptre = dioptres(depth);
    find_model("dof", "dioptric_disc")->create_reference()->apply(frame, values(p));
    return through_lens(frame.image, g);
}
double sum(const ImageF& image, int channel) {
    double total = 0;
    for (std::size_t i = static_cast<std::size_t>(channel); i < image.data.size(); i += 3) total += static_cast<double>(image.data[i]);
    return total;
}
ImageF point(int width, int height, float light, float around = 0) {
    ImageF picture = uniform(width, height, around);
    for (int c = 0; c < 3; ++c) picture.at(width / 2, height / 2, c) = light;
    return picture;
}

TEST(DioptricDisc, AngleIsThatOfEquation12) {
    double worst = 0;
    for (const OracleRow& row : oracle("liu_coc")) {
        const double defocus = 1e3 / row.at("depth_mm") - 1e3 / row.at("focus_mm");
        const double disc_deg = dof::disc_angle_rad(row.at("pupil_mm"), defocus) / degree;
        worst = std::max({worst, relative_error(disc_deg, row.at("blur_disc_deg"), 1e-3),
                          relative_error(disc_deg * 13.85, row.at("blur_disc_px_13.85ppd"), 1e-3)});
        // On the retina: times the focal length.
        worst = std::max(worst, relative_error(disc_deg * degree * 22.3, row.at("eq12_corrected_mm"), 1e-3));
    }
    ledger(name, "equation 12", "double against oracle max", worst);
    EXPECT_LT(worst, 1e-6);
}

TEST(DioptricDisc, DefocusThatFillsSomePixelsIsThatOfTheTable) {
    DioptricDiscParams p = defaults();
    p.deadband_dioptre = 0;
    double worst = 0;
    for (const OracleRow& row : oracle("gate_dof")) {
        const double radius = dioptric_disc::blur_radii_px(p, row.at("defocus_dioptre"), 0, row.at("pupil_mm"), degree / row.at("ppd")).x;
        worst = std::max(worst, relative_error(2 * radius, row.at("blur_disc_px")));
    }
    EXPECT_LT(worst, 1e-6);
}

TEST(DioptricDisc, ColoursFocusAsThibosMeasured) {
    double worst = 0;
    for (const OracleRow& row : oracle("lca"))
        worst = std::max(worst, std::abs(dof::chromatic_dioptre(row.at("wavelength_nm") * 1e-3) - row.at("defocus_re_580nm_dioptre")));
    EXPECT_LT(worst, 1e-8);
    // The eye is short-sighted for blue: beyond the focus blue blurs most, in front of it red.
    DioptricDiscParams p = defaults();
    p.lca = 1;
    const auto beyond = dioptric_disc::blur_radii_px(p, 1, 2, 4, 1e-3), before = dioptric_disc::blur_radii_px(p, 3, 2, 4, 1e-3);
    EXPECT_GT(beyond.z, beyond.x);
    EXPECT_GT(before.x, before.z);
}

TEST(DioptricDisc, DeadbandEndsWithoutAStep) {
    EXPECT_EQ(dioptric_disc::seen_defocus(0.15, 0.15), 0);
    EXPECT_EQ(dioptric_disc::seen_defocus(-0.1, 0.15), 0);
    EXPECT_NEAR(dioptric_disc::seen_defocus(-2, 0.15), 2, 0.006);
    for (double d = 0; d < 1; d += 0.01) EXPECT_LE(dioptric_disc::seen_defocus(d, 0.15), dioptric_disc::seen_defocus(d + 0.01, 0.15));
}

TEST(DioptricDisc, GpuAgreesWithDoubleAndWithTheReference) {
    const int width = 97, height = 61;
    const ImageF picture = textured(width, height, 20, 900), depth = floor_with_post(width, height, 0.35f, 30, 0.8f);
    ErrorSummary float_worst, formula;
    for (bool lens : {false, true})
        for (float lca : {0.0f, 1.0f})
            for (float focus : {0.0f, 1.25f, 2.5f}) {
                const EyeGeometry g = lens ? vive_lens(width, height) : rectilinear(width, height, 7);
                DioptricDiscParams p = defaults();
                p.lca = lca;
                p.focus_dioptre = focus;
                const double pupil = lens ? 8 : 4.49;
                StageRunner runner({g}, model({"lca=" + std::to_string(lca), "focus_dioptre=" + std::to_string(focus)}));
                const ImageD expected = twin(picture, depth, g, static_cast<double>(focus), p, pupil);
                const ErrorSummary e = summary(relative_errors(runner.run(picture, looking(pupil), depth), expected, 1e-3));
                float_worst.max = std::max(float_worst.max, e.max);
                const ErrorSummary r = summary(code_errors(expected, reference(picture, depth, g, p, pupil)));
                formula.p99 = std::max(formula.p99, r.p99);
                formula.mean = std::max(formula.mean, r.mean);
            }
    ledger(name, "floor and post 14 ppd", "float against double max relative", float_worst.max);
    ledger(name, "floor and post 14 ppd", "double against reference p99 code", formula.p99);
    ledger(name, "floor and post 14 ppd", "double against reference mean code", formula.mean);
    EXPECT_LT(float_worst.max, 2e-4);
    // A soft rim of one pixel against counted overlap: it matters for discs of one to two pixels beside noise of 1:40.
    EXPECT_LT(formula.p99, 14);
    EXPECT_LT(formula.mean, 1);
}

TEST(DioptricDisc, PointBecomesAnEvenDiscOfItsLight) {
    const int size = 101;
    const EyeGeometry g = rectilinear(size, size, 7.3);  // 13.9 ppd, the same everywhere within 0.5 %
    StageRunner runner({g}, model({"focus_dioptre=0", "deadband_dioptre=0"}));
    for (float metres : {0.5f, 0.25f, 0.1f}) {
        const ImageF out = runner.run(point(size, size, 1000), looking(), distance(size, size, metres));
        const double ppd = geometry::geometry_ppd(g, {size / 2.0, size / 2.0});
        const double radius = 0.5 * 4.49e-3 / static_cast<double>(metres) / degree * ppd, area = std::numbers::pi * radius * radius;
        EXPECT_NEAR(sum(out, 1) / 1000, 1, 0.01) << metres;
        for (int x = 0; x < size; ++x) {
            const double far = std::abs(x - size / 2), v = static_cast<double>(out.at(x, size / 2, 1));
            if (far < radius - 0.6) { EXPECT_NEAR(v * area / 1000, 1, 0.03) << metres << " m, " << far << " px"; }
            if (far > radius + 0.6) { EXPECT_EQ(v, 0) << metres << " m, " << far << " px"; }
        }
    }
}

TEST(DioptricDisc, ConstantPictureStaysAndAPlaneKeepsItsLight) {
    const int width = 90, height = 50;
    const EyeGeometry g = rectilinear(width, height, 6.5);
    StageRunner runner({g}, model({"focus_dioptre=3"}));
    const ImageF depth = floor_with_post(width, height, 0.3f, 100, 0.5f);
    for (float v : runner.run(uniform(width, height, 42), looking(), depth).data) EXPECT_NEAR(v, 42, 42e-6);
    // Light in the middle of a plane is only moved.
    ImageF picture = textured(width, height, 5);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            if (x < 20 || y < 15 || x >= width - 20 || y >= height - 15)
                for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 0;
    const ImageF out = runner.run(picture, looking(), distance(width, height, 2));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum(out, c) / sum(picture, c), 1, 2e-3);
}

TEST(DioptricDisc, NothingLeaksOverTheEdgeOfWhatIsSharp) {
    const int width = 120, height = 40, edge = 60;
    const EyeGeometry g = rectilinear(width, height, 8.6);
    ImageF picture = uniform(width, height, 1);  // near, dark
    for (int y = 0; y < height; ++y)
        for (int x = edge; x < width; ++x)
            for (int c = 0; c < 3; ++c) picture.at(x, y, c) = 1000;  // far, bright
    const ImageF depth = two_distances(width, height, edge, 0.4f, 50);
    // Focused on the near half: it stays to the bit, and the bright half keeps its brightness up to the edge.
    StageRunner near({g}, model({"focus_dioptre=2.5"}));
    ImageF out = near.run(picture, looking(), depth);
    for (int x = 0; x < width; ++x) EXPECT_NEAR(out.at(x, 20, 1), x < edge ? 1 : 1000, x < edge ? 0 : 1e-3) << x;
    // Focused on the far half: the near one's blurred edge covers it, and far light does not come in over the near half.
    StageRunner far({g}, model({"focus_dioptre=0.02"}));
    out = far.run(picture, looking(), depth);
    for (int x = 0; x < edge; ++x) EXPECT_NEAR(out.at(x, 20, 1), 1, 1e-5) << x;
    EXPECT_NEAR(out.at(edge, 20, 1), 520, 60);
    EXPECT_LT(out.at(edge + 1, 20, 1), out.at(edge + 3, 20, 1));
    EXPECT_EQ(out.at(width - 1, 20, 1), 1000);
}

TEST(DioptricDisc, UnknownDepthIsLeftAlone) {
    const ImageF picture = textured(70, 33, 30);
    const EyeGeometry g = rectilinear(70, 33, 5);
    StageRunner runner({g}, model());
    EXPECT_EQ(runner.run(picture, looking()).data, picture.data);  // no depth came
    EXPECT_TRUE(runner.stage().effects().at(0).gated);
    for (float unknown : {0.0f, -3.0f, std::numeric_limits<float>::quiet_NaN()}) {
        EXPECT_EQ(runner.run(picture, looking(), distance(70, 33, unknown)).data, picture.data);
        EXPECT_TRUE(runner.stage().effects().at(0).gated);
    }
    // A known foreground still blurs over what is unknown.
    StageRunner fixed({g}, model({"focus_dioptre=0"}));
    EXPECT_NE(fixed.run(picture, looking(), two_distances(70, 33, 35, 0.3f, 0)).at(35, 16, 1), picture.at(35, 16, 1));
}

TEST(DioptricDisc, IsOffToTheBitAtStrengthZeroAndAsksForNoDepth) {
    const ImageF picture = textured(70, 33, 30);
    StageRunner runner({rectilinear(70, 33, 5)}, model({"strength=0"}));
    EXPECT_EQ(runner.run(picture, looking(), distance(70, 33, 0.2f)).data, picture.data);
    EXPECT_FALSE(runner.stage().wants_depth());
    EXPECT_FALSE(static_cast<bool>(runner.stage().depth()));
    check(runner.stage().select(model()));
    EXPECT_TRUE(runner.stage().wants_depth());
    EXPECT_FALSE(StageRunner({rectilinear(70, 33, 5)}, only({})).stage().wants_depth());
}

TEST(DioptricDisc, GateIsExact) {
    const int width = 64, height = 40;
    const EyeGeometry g = rectilinear(width, height, 4.6);
    const ImageF picture = textured(width, height, 30, 500);
    StageRunner runner({g}, model({"focus_dioptre=1", "deadband_dioptre=0"}));
    const double ppd = geometry::geometry_ppd(g, {width / 2.0, height / 2.0});
    GateCount count;
    for (double factor : factors_around_bound(104, 1.2)) {
        const double disc_px = 0.5 * factor;
        const double defocus = disc_px / ppd * degree / 4.49e-3;
        const ImageF depth = two_distances(width, height, 20, 1, static_cast<float>(1 / (1 + defocus)));
        const ImageF out = runner.run(picture, looking(), depth);
        const EffectOutcome effect = runner.stage().effects().at(0);
        count.add(effect.gated, factor);
        EXPECT_EQ(effect.gated, disc_px < 0.5) << disc_px;
        if (!effect.gated) continue;
        EXPECT_EQ(out.data, picture.data);
        EXPECT_EQ(effect.bound_codes, 0);
        DioptricDiscParams p = defaults();
        p.deadband_dioptre = 0;
        p.focus_dioptre = 1;
        EXPECT_LT(summary(code_errors(reference(picture, depth, g, p), picture)).max, 1e-9);
    }
    count.expect_both_outcomes();
}

TEST(DioptricDisc, EyesFocusOnWhatTheyLookAt) {
    const int width = 200, height = 60, edge = 100;
    const EyeGeometry g = rectilinear(width, height, 14.4);
    const ImageF picture = textured(width, height, 30), depth = two_distances(width, height, edge, 0.4f, 20);
    StageRunner runner({g}, model());
    const auto changed = [&](const ImageF& out, int x) { return out.at(x, 30, 1) != picture.at(x, 30, 1); };
    const vec3 left = glm::normalize(vec3(-0.06f, 0, -1)), right = glm::normalize(vec3(0.06f, 0, -1));
    ImageF out = runner.run(picture, looking(4.49, left), depth);
    EXPECT_FALSE(changed(out, 50));
    EXPECT_TRUE(changed(out, 150));
    out = runner.run(picture, looking(4.49, right), depth);
    EXPECT_TRUE(changed(out, 50));
    EXPECT_FALSE(changed(out, 150));
    // Single pixels of another depth at the gaze do not matter: a median.
    ImageF speckled = depth;
    for (int x = 0; x < width; x += 3)
        for (int y = 0; y < height; y += 2) speckled.at(x, y, 0) = 0.1f;
    StageRunner fixed({g}, model({"focus_dioptre=0.05"}));
    EXPECT_EQ(runner.run(picture, looking(4.49, right), speckled).data, fixed.run(picture, looking(4.49, right), speckled).data);
    // Looking where nothing is known holds the focus; so does a gaze that is no direction, which means straight ahead.
    const float nan = std::numeric_limits<float>::quiet_NaN();
    FrameInput held = looking(4.49, left);
    held.snap = false;
    held.dt_s = 10;
    out = runner.run(picture, held, two_distances(width, height, edge, 0, 20));
    EXPECT_FALSE(changed(out, 150));
    EXPECT_TRUE(all_finite(runner.run(picture, looking(4.49, vec3(nan)), depth)));
}

TEST(DioptricDisc, VergenceWinsWhenAskedFor) {
    const EyeGeometry g = rectilinear(64, 40, 4.6);
    const ImageF picture = textured(64, 40, 30), depth = distance(64, 40, 0.4f);
    StageRunner runner({g}, model({"use_vergence=1"}));
    FrameInput input = looking();
    EXPECT_EQ(runner.run(picture, input, depth).data, picture.data);  // not measured: depth at the gaze
    input.vergence_dioptre = 0;
    EXPECT_NE(runner.run(picture, input, depth).data, picture.data);
    input.vergence_dioptre = 2.5f;
    EXPECT_EQ(runner.run(picture, input, depth).data, picture.data);
}

TEST(DioptricDisc, FocusFollowsTheSameAtAnyFrameRate) {
    const EyeGeometry g = rectilinear(64, 40, 4.6);
    const ImageF picture = textured(64, 40, 30);
    const auto after = [&](int frames, double seconds) {
        StageRunner runner({g}, model());
        runner.run(picture, looking(), distance(64, 40, 20));
        FrameInput input = looking();
        input.snap = false;
        input.dt_s = seconds / frames;
        ImageF out;
        for (int i = 0; i < frames; ++i) out = runner.run(picture, input, distance(64, 40, 0.3f));
        return out;
    };
    const ImageF slow = after(9, 0.2), fast = after(200, 0.2);
    EXPECT_LT(summary(relative_errors(slow, fast, 1)).max, 2e-3);
    EXPECT_NE(slow.data, picture.data);         // still on its way
    EXPECT_EQ(after(1, 3).data, picture.data);  // arrived but for e^-10, within the deadband
    // Against the law itself.
    DioptricDiscParams p = defaults();
    const double focus = dof::followed(0.05, 1 / 0.3, 0.2, 0.3);
    p.focus_dioptre = static_cast<float>(focus);
    EXPECT_LT(summary(relative_errors(fast, twin(picture, distance(64, 40, 0.3f), g, focus, p), 1)).max, 3e-3);
    EXPECT_EQ(dof::followed(1.0, 2.0, 0.0, 0.3), 1);
    EXPECT_EQ(dof::followed(1.0, 2.0, std::nan(""), 0.3), 1);
    EXPECT_NEAR(dof::followed(dof::followed(1.0, 2.0, 0.1, 0.3), 2.0, 0.1, 0.3), dof::followed(1.0, 2.0, 0.2, 0.3), 1e-15);
}

TEST(DioptricDisc, EyesFocusTogether) {
    const EyeGeometry g = rectilinear(64, 40, 4.6);
    const ImageF picture = textured(64, 40, 30);
    StageRunner runner({g, g}, model());
    FrameInput input = still_input(2);
    // One eye sees 1 dioptre, the other 3: both blur as if 2 were in focus.
    const auto out = runner.run({picture, picture}, input, {distance(64, 40, 1), distance(64, 40, 1 / 3.0f)});
    EXPECT_LT(summary(relative_errors(out[0], out[1], 1)).max, 1e-4);
    EXPECT_NE(out[0].data, picture.data);
}

TEST(DioptricDisc, LiveAndWiderPupilBlursMore) {
    const int size = 61;
    StageRunner runner({rectilinear(size, size, 4.4)}, model({"focus_dioptre=0"}));
    float last = 1000;
    for (double pupil : {2.0, 4.0, 6.0, 8.0}) {
        const float peak = runner.run(point(size, size, 1000), looking(pupil), distance(size, size, 0.4f)).at(size / 2, size / 2, 1);
        EXPECT_LT(peak, last);
        last = peak;
    }
}

TEST(DioptricDisc, RouletteIsCloseToAllPixels) {
    const int width = 160, height = 96;
    const EyeGeometry g = rectilinear(width, height, 11.5);
    const ImageF picture = textured(width, height, 20), depth = floor_with_post(width, height, 0.25f, 30, 0.4f);
    StageRunner all({g}, model({"focus_dioptre=0.1"})), some({g}, model({"focus_dioptre=0.1", "roulette=1"}));
    const ImageF exact = all.run(picture, looking(6), depth), sampled = some.run(picture, looking(6), depth);
    const ErrorSummary codes = summary(code_errors(sampled, exact)), itp = summary(delta_e_itp(sampled, exact));
    ledger(name, "roulette 4 dioptre 6 mm", "sampled against all mean code", codes.mean);
    ledger(name, "roulette 4 dioptre 6 mm", "sampled against all p99 code", codes.p99);
    ledger(name, "roulette 4 dioptre 6 mm", "sampled against all mean dEITP", itp.mean);
    EXPECT_LT(codes.mean, 4);
    EXPECT_EQ(sampled.data, some.run(picture, looking(6), depth).data);  // stands still
    for (float v : some.run(uniform(width, height, 42), looking(6), depth).data) EXPECT_NEAR(v, 42, 42e-5);
}

TEST(DioptricDisc, SphereClosesBehindTheBack) {
    EyeGeometry g{};
    g.kind = geometry_equirect;
    g.width = 128;
    g.height = 64;
    ImageF picture = uniform(128, 64, 0);
    for (int c = 0; c < 3; ++c) picture.at(0, 32, c) = 1000;
    StageRunner runner({g}, model({"focus_dioptre=0", "deadband_dioptre=0"}));
    const ImageF out = runner.run(picture, looking(8), distance(128, 64, 0.05f));
    EXPECT_GT(out.at(127, 32, 1), 0);
    EXPECT_NEAR(out.at(127, 32, 1), out.at(1, 32, 1), 1e-3);
}

TEST(DioptricDisc, HardCasesStayFinite) {
    struct Size {
        int width, height;
    };
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (Size size : {Size{1, 1}, Size{3, 1}, Size{203, 57}})
        for (const char* roulette : {"roulette=0", "roulette=1"}) {
            StageRunner runner({rectilinear(size.width, size.height, 100)}, model({"lca=1", roulette, "focus_dioptre=0"}));
            for (float y : {0.0f, 1e8f, nan})
                for (float metres : {nan, 1e-30f, 0.05f, 1e30f, infinitely_far})
                    EXPECT_TRUE(
                        all_finite(runner.run(uniform(size.width, size.height, y), looking(9), distance(size.width, size.height, metres))));
        }
    // A fine lens with everything nearest: discs end at 32 pixels.
    StageRunner runner({rectilinear(100, 40, 0.5)}, model({"focus_dioptre=0"}));
    const ImageF out = runner.run(point(100, 40, 1000), looking(9), distance(100, 40, 0.001f));
    EXPECT_TRUE(all_finite(out));
    EXPECT_GT(out.at(50 + 31, 20, 1), 0);
    EXPECT_EQ(out.at(50 + 34, 20, 1), 0);
}

}  // namespace
}  // namespace entoptic::perception
