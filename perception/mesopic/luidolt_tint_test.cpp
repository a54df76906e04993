// labels: gpu
#include "perception/mesopic/luidolt_tint_math.glsl"
#include "perception/mesopic/mesopic.h"
#include "perception/testing/gate_sweep.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"

#include <limits>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "mesopic.luidolt_tint";

LuidoltTintParams printed() { return {1, 1.05f, 0.97f, 1.27f, 0, 1}; }
LuidoltTintParams defaults() { return {1, 1.05f, 0.97f, 1.27f, 0, 0}; }
Selection model(const std::vector<std::string>& settings = {}) { return only({"mesopic=luidolt_tint"}, settings); }

// Display light: every colour of a 17-step lattice of codes and a grey ramp.
ImageF lattice(DisplayRange d = {}) {
    ImageF image(17 * 17, 18, 3);
    const auto light = [&](int step) {
        return static_cast<float>(static_cast<double>(d.black_cd_m2) +
                                  static_cast<double>(d.white_cd_m2 - d.black_cd_m2) * colour::srgb_decode(step / 16.0));
    };
    for (int i = 0; i < 17 * 17; ++i) {
        for (int j = 0; j < 17; ++j) image.at(i, j, 0) = light(i % 17), image.at(i, j, 1) = light(i / 17), image.at(i, j, 2) = light(j);
        for (int c = 0; c < 3; ++c) image.at(i, 17, c) = d.black_cd_m2 + (d.white_cd_m2 - d.black_cd_m2) * static_cast<float>(i) / 288;
    }
    return image;
}

class Tint {
public:
    explicit Tint(const std::vector<std::string>& settings = {}, DisplayRange d = {})
        : runner_({rectilinear(17 * 17, 18, 60)}, model(settings), d) {}
    ImageF at(float adaptation, const ImageF& picture) {
        runner_.stage().set_adaptation(adaptation);
        return runner_.run(picture, still_input(1));
    }
    bool gated() { return runner_.stage().effects().at(0).gated; }
    float bound() { return runner_.stage().effects().at(0).bound_codes; }

private:
    StageRunner runner_;
};

ImageD reference(const ImageF& picture, double adaptation, std::vector<float> parameters, DisplayRange d = {}) {
    ReferenceFrame frame{convert<double>(picture), rectilinear(picture.width, picture.height, 60), d, {}, 0, false, adaptation, 1};
    find_model("mesopic", "luidolt_tint")->create_reference()->apply(frame, parameters);
    return frame.image;
}

ImageD twin(const ImageF& picture, double adaptation, const LuidoltTintParams& p, DisplayRange d = {}) {
    ImageD out = convert<double>(picture);
    const double black = static_cast<double>(d.black_cd_m2), range = static_cast<double>(d.white_cd_m2) - black;
    for (std::size_t i = 0; i < out.data.size(); i += 3) {
        const glm::dvec3 light = (glm::dvec3(out.data[i], out.data[i + 1], out.data[i + 2]) - black) / range;
        const glm::dvec3 seen = luidolt_tint::tinted(light, luidolt_tint::tint(p), luidolt_tint::rod_share(p, adaptation));
        for (int c = 0; c < 3; ++c) out.data[i + static_cast<std::size_t>(c)] = black + range * seen[c];
    }
    return out;
}

TEST(Mesopic, Equation14IsThatOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("scotopic_tint_eq14")) {
        const glm::dvec3 in(row.at("R_in"), row.at("G_in"), row.at("B_in"));
        const double share = luidolt_tint::rod_share(printed(), row.at("L_i_cd_m2"));
        const glm::dvec3 out = luidolt_tint::tinted(in, luidolt_tint::tint(printed()), share);
        const double expected[3] = {row.at("R_out"), row.at("G_out"), row.at("B_out")};
        worst = std::max(worst, relative_error(share, row.at("sigma")));
        // The table does not clamp, and takes L' with the paper's luminance weights, up to 3e-4 of it from BT.709's.
        for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(out[c] - std::min(expected[c], 1.0)));
    }
    ledger(name, "equation 14", "double against oracle max", worst);
    EXPECT_LT(worst, 1e-4);
}

TEST(Mesopic, BoundIsThatOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("gate_tint")) {
        const double bound = luidolt_tint::bound_codes(printed(), luidolt_tint::rod_share(printed(), row.at("L_i_cd_m2")));
        EXPECT_GE(bound, row.at("max_code_change_any_colour") * 0.9998) << row.at("L_i_cd_m2");
        if (row.at("L_i_cd_m2") >= 200) worst = std::max(worst, relative_error(bound, row.at("max_code_change_any_colour")));
    }
    EXPECT_LT(worst, 1e-3);  // and near the gate it is that change, not more
}

TEST(Mesopic, NormalisedTintKeepsLuminance) {
    EXPECT_NEAR(colour::luminance(luidolt_tint::tint(defaults())), 1, 1e-12);
    const glm::dvec3 t = luidolt_tint::tint(defaults());
    EXPECT_NEAR(t.x, 1.0410, 5e-5);
    EXPECT_NEAR(t.y, 0.9617, 5e-5);
    EXPECT_NEAR(t.z, 1.2591, 5e-5);
    for (double a : {1e-6, 0.01, 1.0}) {
        const glm::dvec3 in(0.3, 0.1, 0.5), out = luidolt_tint::tinted(in, t, luidolt_tint::rod_share(defaults(), a));
        EXPECT_NEAR(colour::luminance(out), colour::luminance(in), 1e-12);
    }
}

TEST(Mesopic, CutEndsTheTintExactly) {
    LuidoltTintParams p = defaults();
    p.cut_cd_m2 = 10;
    EXPECT_EQ(luidolt_tint::rod_share(p, 10.0), 0.0);
    EXPECT_EQ(luidolt_tint::rod_share(p, 1e8), 0.0);
    EXPECT_NEAR(luidolt_tint::rod_share(p, 0.0), 1, 1e-12);
    EXPECT_LT(luidolt_tint::rod_share(p, 1.0), luidolt_tint::rod_share(defaults(), 1.0));
    Tint tint({"mesopic.cut_cd_m2=10"});
    EXPECT_EQ(tint.at(10.5f, lattice()).data, lattice().data);
    EXPECT_TRUE(tint.gated());
    EXPECT_EQ(tint.bound(), 0.0f);
}

TEST(Mesopic, GpuAgreesWithDoubleAndWithTheReference) {
    const std::vector<float> parameters = default_parameters(*find_model("mesopic", "luidolt_tint"));
    Tint tint;
    ErrorSummary gpu_worst, twin_worst;
    for (float a : {1e-6f, 1e-3f, 0.01f, 0.1f, 1.0f, 30.0f}) {
        const ImageF picture = lattice();
        const ImageD double_out = twin(picture, static_cast<double>(a), defaults());
        const ErrorSummary gpu = summary(code_errors(tint.at(a, picture), double_out));
        const ErrorSummary exact = summary(code_errors(double_out, reference(picture, static_cast<double>(a), parameters)));
        gpu_worst.max = std::max(gpu_worst.max, gpu.max);
        twin_worst.max = std::max(twin_worst.max, exact.max);
    }
    ledger(name, "colour lattice", "float against double max code", gpu_worst.max);
    ledger(name, "colour lattice", "double against reference max code", twin_worst.max);
    EXPECT_LT(gpu_worst.max, 2e-3);  // fp32 of 130 cd/m² seen from black: 8e-6 cd/m²
    EXPECT_LT(twin_worst.max, 1e-3);
}

TEST(Mesopic, AsPrintedIsBrighter) {
    Tint tint({"mesopic.as_printed=1"});
    const ImageF picture = uniform(17 * 17, 18, 40);
    const ImageF out = tint.at(1e-6f, picture);
    const double y =
        colour::luminance({static_cast<double>(out.data[0]), static_cast<double>(out.data[1]), static_cast<double>(out.data[2])});
    EXPECT_NEAR((y - 0.04) / (40 - 0.04), 1.0087, 1e-4);
}

TEST(Mesopic, StaysWithinTheDisplay) {
    for (DisplayRange d : {DisplayRange{130, 0.04f}, DisplayRange{1000, 0}, DisplayRange{1, 0.5f}}) {
        Tint tint({}, d);
        for (float a : {1e-6f, 0.04f, 5.0f})
            for (float v : tint.at(a, lattice(d)).data) {
                ASSERT_GE(v, d.black_cd_m2 * 0.999999f);
                ASSERT_LE(v, d.white_cd_m2);
            }
    }
}

TEST(Mesopic, BlackStaysBlackAndMirroredStaysMirrored) {
    Tint tint;
    const ImageF out = tint.at(1e-3f, uniform(17 * 17, 18, 0.04f));
    for (float v : out.data) EXPECT_NEAR(v, 0.04f, 1e-7f);
    EXPECT_EQ(tint.at(1e-3f, mirrored(lattice())).data, mirrored(tint.at(1e-3f, lattice())).data);
}

TEST(Mesopic, StrengthZeroIsBitExact) {
    Tint tint({"mesopic.strength=0"});
    EXPECT_EQ(tint.at(1e-6f, lattice()).data, lattice().data);
}

TEST(Mesopic, GateHoldsItsBoundBothWays) {
    // It opens where the share of the tint could change a code by a half: 308 cd/m².
    const double bound = largest_luminance(1, 1e5, [](double a) {
        const LuidoltTintParams p = defaults();
        return luidolt_tint::bound_codes(p, luidolt_tint::rod_share(p, a)) > 0.5;
    });
    EXPECT_NEAR(bound, 308, 2);
    Tint tint;
    GateCount count;
    double worst_gated = 0;
    const std::vector<float> parameters = default_parameters(*find_model("mesopic", "luidolt_tint"));
    for (double factor : factors_around_bound()) {
        const auto a = static_cast<float>(bound * factor);
        const ImageF picture = lattice(), out = tint.at(a, picture);
        count.add(tint.gated(), factor);
        EXPECT_EQ(tint.gated(), factor > 1) << a;
        if (!tint.gated()) continue;
        EXPECT_EQ(out.data, picture.data) << a;
        const double left_out = summary(code_errors(picture, reference(picture, static_cast<double>(a), parameters))).max;
        EXPECT_LE(left_out, static_cast<double>(tint.bound()) * 1.001) << a;
        EXPECT_LE(tint.bound(), 0.5f);
        worst_gated = std::max(worst_gated, left_out);
    }
    ledger(name, "gate", "largest change left out code", worst_gated);
    count.expect_both_outcomes();
    EXPECT_LE(worst_gated, 0.5);
}

TEST(Mesopic, OneDarkEyeOpensTheGateForBoth) {
    const EyeGeometry g = rectilinear(64, 32, 60);
    StageRunner runner({g, g}, only({"adaptation=krawczyk_exp_linear", "mesopic=luidolt_tint"}));
    const auto gated = [&](float left, float right) {
        runner.run({uniform(64, 32, left), uniform(64, 32, right)}, still_input(2));
        return runner.stage().effects().at(1).gated;
    };
    EXPECT_TRUE(gated(1e4f, 1e4f));
    EXPECT_FALSE(gated(1e4f, 1.0f));
    EXPECT_FALSE(gated(1.0f, 1e4f));
}

TEST(Mesopic, HardCasesStayFinite) {
    struct Size {
        int width, height;
    };
    for (Size size : {Size{1, 1}, Size{1011, 277}}) {
        StageRunner runner({rectilinear(size.width, size.height, 100)}, model());
        for (float a : {1e-6f, 1e8f})
            for (float y : {0.0f, 130.0f, 1e8f, std::numeric_limits<float>::quiet_NaN()}) {
                runner.stage().set_adaptation(a);
                EXPECT_TRUE(all_finite(runner.run(uniform(size.width, size.height, y), still_input(1))));
            }
    }
}

}  // namespace
}  // namespace entoptic::perception
