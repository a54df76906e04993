// labels: gpu
#include "perception/dof/liu_range_math.glsl"
#include "perception/dof/dof.h"
#include "perception/testing/dof_scenes.h"
#include "perception/testing/gate_sweep.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "dof.liu_range";

LiuRangeParams defaults() { return {1, -1, 0, 0.3f, 3, 0, 0, 0}; }
Selection model(std::vector<std::string> settings = {}) {
    for (std::string& s : settings) s = "dof." + s;
    return only({"dof=liu_range"}, settings);
}
FrameInput looking(double pupil_mm = 4.49) {
    FrameInput input = still_input(1);
    input.eyes[0].pupil_diameter_mm = static_cast<float>(pupil_mm);
    return input;
}
ImageD twin(const ImageF& picture, const ImageF& depth, const EyeGeometry& g, const LiuRangeParams& p) {
    const double focus = static_cast<double>(p.focus_dioptre);
    const auto radii = [&](double d, double rad) { return liu_range::blur_radii_px(p, d, focus, 4.49, rad); };
    return gathered_twin(picture, depth, g, focus, p.lca > 0.5f ? dof_colours_rows : dof_colours_alike, radii);
}
ImageD reference(const ImageF& picture, const ImageF& depth, const EyeGeometry& g, const LiuRangeParams& p) {
    ReferenceFrame frame{convert<double>(picture), g, {}, looking().eyes[0], 0, true};
    frame.dioptre = dioptres(depth);
    const std::vector<float> values{p.strength,      p.focus_dioptre, p.use_vergence, p.focus_tau_s,
                                    p.max_radius_px, p.lca,           p.roulette,     p.as_printed};
    find_model("dof", "liu_range")->create_reference()->apply(frame, values);
    return frame.image;
}

TEST(LiuRange, LimitsAreThoseOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("liu_dof")) {
        const double focus = 1e3 / row.at("focus_mm"), pupil = row.at("pupil_mm");
        const double near = 1e3 / dof::near_limit_dioptre(pupil, focus), far = dof::far_limit_dioptre(pupil, focus);
        worst = std::max(worst, relative_error(near, row.at("DN_eq5_mm")));
        // A negative distance means that everything beyond is sharp (trap Li2).
        if (row.at("DF_eq4_mm_negative_means_infinite") > 0)
            worst = std::max(worst, relative_error(1e3 / far, row.at("DF_eq4_mm_negative_means_infinite")));
        else
            EXPECT_EQ(far, 0);
        EXPECT_NEAR(dof::depth_of_field_dioptre(pupil, 0), row.at("halfwidth_dioptre"), 1e-6);
    }
    ledger(name, "equations 4 and 5", "double against oracle max", worst);
    EXPECT_LT(worst, 1e-5);
}

TEST(LiuRange, Equation13IsClampedAndFiniteForEveryFocus) {
    LiuRangeParams p = defaults();
    for (double focus : {0.0, 0.001, 0.03, 0.0647, 0.5, 4.0, 20.0})
        for (double d : {0.0, 1e-4, 0.05, 0.1, 1.0, 5.0, 20.0})
            for (float printed : {0.0f, 1.0f}) {
                p.as_printed = printed;
                const double place = liu_range::range_place(p, d, focus, 4.49);
                EXPECT_TRUE(std::isfinite(place) && std::abs(place) <= 1);
                if (!printed) { EXPECT_EQ(place > 0, d < focus); }
            }
    // Near the focus it is the equation in metres: 1.02 m seen from 1 m, over 1.06762 - 0.94043 m.
    p.as_printed = 0;
    EXPECT_NEAR(liu_range::range_place(p, 1 / 1.02, 1, 4.49), 0.02 / 0.127192, 0.004);
    p.as_printed = 1;
    EXPECT_NEAR(liu_range::range_place(p, 1 / 1.02, 1, 4.49), 0.02 / 0.127192, 1e-5);
    // Focused beyond 15.46 m the printed form leaves a hand at half a metre sharp (trap Li4).
    EXPECT_LT(std::abs(liu_range::range_place(p, 2, 0.05, 4.49)), 0.03);
    p.as_printed = 0;
    EXPECT_EQ(liu_range::range_place(p, 2, 0.05, 4.49), -1);
}

TEST(LiuRange, IsSharpWithinTheDepthOfField) {
    const LiuRangeParams p = defaults();
    const double h = dof::depth_of_field_dioptre(4.49, 1.0);
    EXPECT_EQ(liu_range::blur_radii_px(p, 1 + 0.99 * h, 1, 4.49, 1.26e-3).x, 0);
    EXPECT_EQ(liu_range::blur_radii_px(p, 1 - 0.99 * h, 1, 4.49, 1.26e-3).x, 0);
    EXPECT_GT(liu_range::blur_radii_px(p, 1 + 1.01 * h, 1, 4.49, 1.26e-3).x, 1.4);
    EXPECT_NEAR(liu_range::blur_radii_px(p, 8, 1, 4.49, 1.2605e-3).x, 3, 1e-6);
    EXPECT_NEAR(liu_range::blur_radii_px(p, 8, 1, 4.49, 1.2605e-3 / 2).x, 6, 1e-5);  // an angle, not pixels
}

TEST(LiuRange, GpuAgreesWithDoubleAndWithTheReference) {
    const int width = 97, height = 61;
    const EyeGeometry g = rectilinear(width, height, 7);
    const ImageF picture = textured(width, height, 20, 900), depth = floor_with_post(width, height, 0.35f, 30, 0.8f);
    ErrorSummary float_worst, formula;
    for (float lca : {0.0f, 1.0f})
        for (float printed : {0.0f, 1.0f})
            for (float focus : {0.0f, 1.2f, 2.45f}) {
                LiuRangeParams p = defaults();
                p.lca = lca, p.as_printed = printed, p.focus_dioptre = focus;
                StageRunner runner({g}, model({"lca=" + std::to_string(lca), "as_printed=" + std::to_string(printed),
                                               "focus_dioptre=" + std::to_string(focus)}));
                const ImageD expected = twin(picture, depth, g, p);
                const ErrorSummary e = summary(relative_errors(runner.run(picture, looking(), depth), expected, 1e-3));
                float_worst.p99 = std::max(float_worst.p99, e.p99);
                const ErrorSummary r = summary(code_errors(expected, reference(picture, depth, g, p)));
                formula.p99 = std::max(formula.p99, r.p99);
                formula.mean = std::max(formula.mean, r.mean);
            }
    ledger(name, "floor and post 14 ppd", "float against double p99 relative", float_worst.p99);
    ledger(name, "floor and post 14 ppd", "double against reference p99 code", formula.p99);
    ledger(name, "floor and post 14 ppd", "double against reference mean code", formula.mean);
    EXPECT_LT(float_worst.p99, 2e-4);  // a pixel at the very limit may fall on either side
    EXPECT_LT(formula.p99, 12);
    EXPECT_LT(formula.mean, 1);
}

TEST(LiuRange, RowsColourEdgesButNotWhite) {
    const int width = 64, height = 48;
    const EyeGeometry g = rectilinear(width, height, 4.6);
    StageRunner runner({g}, model({"lca=1", "focus_dioptre=4"}));
    for (float v : runner.run(uniform(width, height, 42), looking(), distance(width, height, 5)).data) EXPECT_NEAR(v, 42, 42e-5);
    // Beyond the focus a kernel's top rows pass no blue: just below a bright field there is more red than blue.
    ImageF field = uniform(width, height, 0);
    for (int y = 0; y < 24; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) field.at(x, y, c) = 100;
    const ImageF beyond = runner.run(field, looking(), distance(width, height, 5));
    EXPECT_GT(beyond.at(32, 25, 0), beyond.at(32, 25, 2) + 5);
    StageRunner near({g}, model({"lca=1", "focus_dioptre=0"}));
    const ImageF before = near.run(field, looking(), distance(width, height, 0.5f));
    EXPECT_GT(before.at(32, 25, 2), before.at(32, 25, 0) + 5);
    // A grey mean: what one side has too much of, the other has too little of.
    double red = 0, blue = 0;
    for (int y = 10; y < 38; ++y) red += static_cast<double>(beyond.at(32, y, 0)), blue += static_cast<double>(beyond.at(32, y, 2));
    EXPECT_NEAR(red / blue, 1, 0.15);
}

TEST(LiuRange, GateIsExactAndStrengthZeroIsOff) {
    const ImageF picture = textured(64, 40, 30);
    const EyeGeometry g = rectilinear(64, 40, 4.6);
    StageRunner runner({g}, model({"focus_dioptre=1"}));
    GateCount count;
    const double h = dof::depth_of_field_dioptre(4.49, 1.0);
    for (double factor : factors_around_bound(104, 1)) {
        // In front of the focus and behind it by turns, as far as there is anything behind it.
        const double place = factor * h < 0.9 && count.ran % 2 == count.gated % 2 ? -factor : factor;
        const ImageF out = runner.run(picture, looking(), distance(64, 40, static_cast<float>(1 / (1 + place * h))));
        const EffectOutcome effect = runner.stage().effects().at(0);
        EXPECT_EQ(effect.gated, factor < 1) << place;
        count.add(effect.gated, factor);
        if (effect.gated) { EXPECT_EQ(out.data, picture.data); }
    }
    count.expect_both_outcomes();
    StageRunner off({g}, model({"strength=0"}));
    EXPECT_EQ(off.run(picture, looking(), distance(64, 40, 0.2f)).data, picture.data);
}

TEST(LiuRange, RouletteIsCloseToAllPixels) {
    const int width = 160, height = 96;
    const EyeGeometry g = rectilinear(width, height, 11.5);
    const ImageF picture = textured(width, height, 20), depth = floor_with_post(width, height, 0.25f, 30, 0.4f);
    StageRunner all({g}, model({"focus_dioptre=0.1"})), some({g}, model({"focus_dioptre=0.1", "roulette=1"}));
    const ImageF exact = all.run(picture, looking(), depth), sampled = some.run(picture, looking(), depth);
    const ErrorSummary codes = summary(code_errors(sampled, exact));
    ledger(name, "roulette", "sampled against all mean code", codes.mean);
    ledger(name, "roulette", "sampled against all p99 code", codes.p99);
    EXPECT_LT(codes.mean, 5);
}

TEST(LiuRange, PresetIsDepthOfFieldAlone) {
    const Selection selection = value(select("liu2021", {}, {}));
    ASSERT_EQ(selection.choices.size(), 1u);
    EXPECT_EQ(selection.choices[0].entry->name, "liu_range");
    EXPECT_EQ(selection.choices[0].parameters[5], 1);  // lca
}

TEST(LiuRange, HardCasesStayFinite) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const char* printed : {"as_printed=0", "as_printed=1"})
        for (int width : {1, 203}) {
            StageRunner runner({rectilinear(width, 17, 100)}, model({"lca=1", printed}));
            for (float y : {0.0f, 1e8f, nan})
                for (float metres : {nan, 1e-30f, 0.05f, 1e30f, infinitely_far})
                    EXPECT_TRUE(all_finite(runner.run(uniform(width, 17, y), looking(9), two_distances(width, 17, width / 2, metres, 2))));
        }
}

}  // namespace
}  // namespace entoptic::perception
