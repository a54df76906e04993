// labels: gpu
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"
#include "perception/tone/key_reinhard_math.glsl"
#include "perception/tone/tone.h"

#include <limits>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "tone.key_reinhard";

KeyReinhardParams defaults() { return {1, 0}; }
Selection model(const std::vector<std::string>& settings = {}) { return only({"tone=key_reinhard"}, settings); }

class Tone {
public:
    Tone(int width, int height, const std::vector<std::string>& settings = {}, DisplayRange d = {})
        : runner_({rectilinear(width, height, 60)}, model(settings), d) {}
    ImageF at(float adaptation, const ImageF& picture) {
        runner_.stage().set_adaptation(adaptation);
        return runner_.run(picture, still_input(1));
    }

private:
    StageRunner runner_;
};

ImageD twin(const ImageF& picture, double adaptation, const KeyReinhardParams& p, DisplayRange d = {}) {
    ImageD out = convert<double>(picture);
    const double black = static_cast<double>(d.black_cd_m2), range = static_cast<double>(d.white_cd_m2) - black;
    for (std::size_t i = 0; i < out.data.size(); i += 3) {
        const glm::dvec3 c(out.data[i], out.data[i + 1], out.data[i + 2]);
        const double y = colour::luminance(c);
        const glm::dvec3 seen = key_reinhard::scaled_colour(c, y, key_reinhard::response(p, y, adaptation));
        for (int k = 0; k < 3; ++k) out.data[i + static_cast<std::size_t>(k)] = black + range * seen[k];
    }
    return out;
}
ImageD reference(const ImageF& picture, double adaptation, const std::vector<float>& parameters, DisplayRange d = {}) {
    ReferenceFrame frame{convert<double>(picture), rectilinear(picture.width, picture.height, 60), d, {}, 0, false, adaptation, 1};
    find_model("tone", "key_reinhard")->create_reference()->apply(frame, parameters);
    return frame.image;
}

// Neutral ramp over the whole range of scenes.
ImageF ramp(int width) {
    ImageF image(width, 1, 3);
    for (int x = 0; x < width; ++x)
        for (int c = 0; c < 3; ++c) image.at(x, 0, c) = static_cast<float>(std::pow(10, -6 + 14.0 * x / (width - 1)));
    return image;
}
// Saturated and mixed colours over the whole range.
ImageF colours(int width) {
    const float mixes[8][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {0, 1, 1}, {1, 0, 1}, {1, 0.9f, 0.4f}, {0.2f, 0.3f, 1}};
    ImageF image(width, 8, 3);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) image.at(x, y, c) = mixes[y][c] * static_cast<float>(std::pow(10, -6 + 14.0 * x / (width - 1)));
    return image;
}

TEST(Tone, KeyAndCurveAreThoseOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("krawczyk_key")) {
        worst = std::max(worst, relative_error(key_reinhard::auto_key(row.at("Y_adapt_cd_m2")), row.at("key_alpha")));
        worst = std::max(worst, relative_error(key_reinhard::response(defaults(), row.at("pixel_Y_cd_m2"), row.at("Y_adapt_cd_m2")),
                                               row.at("reinhard_L_over_1pL")));
    }
    ledger(name, "key and curve", "double against oracle max rel", worst);
    EXPECT_LT(worst, 1e-7);
}

TEST(Tone, UniformFieldIsThatOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("uniform_field"))
        worst = std::max(worst,
                         relative_error(key_reinhard::response(defaults(), row.at("Y_cd_m2"), row.at("Y_cd_m2")), row.at("reinhard_Ld")));
    EXPECT_LT(worst, 1e-7);
    // The whole preset's chain of tone and tint, with the tint as printed.
    StageRunner runner({rectilinear(64, 16, 60)},
                       only({"adaptation=krawczyk_exp_linear", "tone=key_reinhard", "mesopic=luidolt_tint"}, {"mesopic.as_printed=1"}));
    double worst_code = 0;
    for (const OracleRow& row : oracle("uniform_field")) {
        const ImageF out = runner.run(uniform(64, 16, static_cast<float>(row.at("Y_cd_m2"))), still_input(1));
        const char* const columns[3] = {"luidolt_code8_R", "luidolt_G8", "luidolt_B8"};
        for (int c = 0; c < 3; ++c)
            worst_code = std::max(worst_code, std::abs(code(static_cast<double>(out.at(32, 8, c))) - row.at(columns[c])));
    }
    ledger(name, "uniform field with tint", "float against oracle max code", worst_code);
    EXPECT_LT(worst_code, 2e-2);
}

TEST(Tone, GpuAgreesWithDoubleAndWithTheReference) {
    const std::vector<float> parameters = default_parameters(*find_model("tone", "key_reinhard"));
    const ImageF picture = colours(257);
    Tone tone(257, 8);
    double gpu = 0, exact = 0;
    for (float a : {1e-6f, 1e-3f, 0.1f, 1.0f, 100.0f, 1e4f, 1e8f}) {
        const ImageD expected = twin(picture, static_cast<double>(a), defaults());
        gpu = std::max(gpu, summary(code_errors(tone.at(a, picture), expected)).max);
        exact = std::max(exact, summary(code_errors(expected, reference(picture, static_cast<double>(a), parameters))).max);
    }
    ledger(name, "colours 1e-6..1e8", "float against double max code", gpu);
    ledger(name, "colours 1e-6..1e8", "double against reference max code", exact);
    EXPECT_LT(gpu, 2e-2);
    EXPECT_LT(exact, 1e-6);
}

TEST(Tone, BrighterIsNeverDarker) {  // but for the last digits of a float
    const ImageF picture = ramp(4001);
    Tone tone(4001, 1);
    for (float a : {1e-6f, 1.0f, 1e4f, 1e8f}) {
        const ImageF out = tone.at(a, picture);
        for (int x = 1; x < out.width; ++x)
            for (int c = 0; c < 3; ++c) ASSERT_GE(out.at(x, 0, c), out.at(x - 1, 0, c) * 0.9999995f) << a << " " << x;
    }
}

TEST(Tone, NeutralStaysNeutral) {
    const ImageF picture = ramp(4001);
    Tone tone(4001, 1);
    for (float a : {1e-6f, 1.0f, 1e8f}) {
        const ImageF out = tone.at(a, picture);
        for (int x = 0; x < out.width; ++x) {
            ASSERT_LT(std::abs(code(static_cast<double>(out.at(x, 0, 0))) - code(static_cast<double>(out.at(x, 0, 1)))), 1e-3);
            ASSERT_LT(std::abs(code(static_cast<double>(out.at(x, 0, 2))) - code(static_cast<double>(out.at(x, 0, 1)))), 1e-3);
        }
    }
}

TEST(Tone, StaysWithinTheDisplayAndKeepsLuminance) {
    for (DisplayRange d : {DisplayRange{130, 0.04f}, DisplayRange{1000, 0}, DisplayRange{1, 0.5f}}) {
        Tone tone(257, 8, {}, d);
        for (float a : {1e-6f, 0.1f, 100.0f, 1e8f}) {
            const ImageF picture = colours(257), out = tone.at(a, picture);
            for (int y = 0; y < 8; ++y)
                for (int x = 0; x < 257; ++x) {
                    for (int c = 0; c < 3; ++c) {
                        ASSERT_GE(out.at(x, y, c), d.black_cd_m2 * 0.999999f);
                        ASSERT_LE(out.at(x, y, c), d.white_cd_m2);
                    }
                    const auto luminance = [&](const ImageF& i) {
                        return colour::luminance(
                            {static_cast<double>(i.at(x, y, 0)), static_cast<double>(i.at(x, y, 1)), static_cast<double>(i.at(x, y, 2))});
                    };
                    const double black = static_cast<double>(d.black_cd_m2), white = static_cast<double>(d.white_cd_m2);
                    const double r = key_reinhard::response(defaults(), luminance(picture), static_cast<double>(a));
                    ASSERT_NEAR((luminance(out) - black) / (white - black), r, 1e-5) << a << " " << x << " " << y;
                }
        }
    }
}

TEST(Tone, AdaptedMeanLandsAtItsKey) {
    for (float a : {1e-6f, 1.0f, 1e4f}) {
        Tone tone(16, 8);
        const double key = key_reinhard::auto_key(static_cast<double>(a));
        const double expected = 0.04 + (130 - 0.04) * key / (1 + key);
        EXPECT_LT(relative_error(static_cast<double>(tone.at(a, uniform(16, 8, a)).data[0]), expected), 1e-5);
    }
}

TEST(Tone, AsPrintedDarkensTheDark) {
    Tone corrected(16, 8), printed(16, 8, {"tone.as_printed=1"});
    const ImageF night = uniform(16, 8, 0.01f), day = uniform(16, 8, 1e4f);
    EXPECT_LT(printed.at(0.01f, night).data[0], corrected.at(0.01f, night).data[0]);
    EXPECT_GT(printed.at(1e4f, day).data[0], corrected.at(1e4f, day).data[0]);
}

TEST(Tone, MirroredStaysMirrored) {
    Tone tone(257, 64);
    const ImageF picture = textured(257, 64, 1, 1e6);
    EXPECT_EQ(tone.at(1, mirrored(picture)).data, mirrored(tone.at(1, picture)).data);
}

TEST(Tone, HardCasesStayFiniteAndOnTheDisplay) {
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    struct Size {
        int width, height;
    };
    for (Size size : {Size{1, 1}, Size{1011, 277}})
        for (const char* setting : {"tone.as_printed=0", "tone.as_printed=1"}) {
            Tone tone(size.width, size.height, {setting});
            for (float a : {0.0f, 1e-6f, 1.0f, 1e8f})
                for (float y : {0.0f, 1e-6f, 1e8f, nan, inf, -1.0f})
                    for (float v : tone.at(a, uniform(size.width, size.height, y)).data) {
                        ASSERT_TRUE(std::isfinite(v)) << a << " " << y;
                        ASSERT_GE(v, 0.0399999f);
                        ASSERT_LE(v, 130.0f);
                    }
        }
}

}  // namespace
}  // namespace entoptic::perception
