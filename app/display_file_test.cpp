// labels: unit
// Readings of a light meter to the light of a panel: published colorimetry, panels of known physics, and what people write wrongly.
#include "app/display_file.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

// A panel whose light is known: DCI-P3's primaries at D65, an exponent of 2.4 with a foot, a black.
constexpr double exponent = 2.4, foot = 0.002, true_white = 100, true_black = 0.06;
const Chromaticity primaries[3] = {{0.680, 0.320, 0.2289745641}, {0.265, 0.690, 0.6917385218}, {0.150, 0.060, 0.0792869141}};
double share(int code) { return foot * code / 255 + (1 - foot) * std::pow(code / 255.0, exponent); }
MeterReading read_meter(std::array<int, 3> codes, bool colorimeter) {
    glm::dvec3 light = light_of({0.3127, 0.3290, true_black});
    for (std::size_t c = 0; c < 3; ++c) light += light_of({primaries[c].x, primaries[c].y, primaries[c].luminance_cd_m2 * true_white * share(codes[c])});
    const Chromaticity seen = chromaticity_of(light);
    return {codes, colorimeter ? std::optional(glm::dvec2(seen.x, seen.y)) : std::nullopt, seen.luminance_cd_m2, "reading"};
}
std::vector<MeterReading> readings(bool colorimeter) {
    std::vector<MeterReading> list;
    for (const int code : {0, 16, 32, 48, 64, 96, 128, 160, 192, 224, 255}) list.push_back(read_meter({code, code, code}, colorimeter));
    for (std::size_t c = 0; c < 3; ++c) {
        std::array<int, 3> codes{};
        codes[c] = 255;
        list.push_back(read_meter(codes, colorimeter));
    }
    return list;
}

// ITU-R BT.709-6: the primaries' chromaticities and D65 of white; IEC 61966-2-1 gives the same.
TEST(Display, ColoursOfBt709AreThePublishedOnes) {
    const struct { glm::dvec3 rgb; double x, y, luminance; } rows[] = {
        {{1, 0, 0}, 0.640, 0.330, 0.2126}, {{0, 1, 0}, 0.300, 0.600, 0.7152}, {{0, 0, 1}, 0.150, 0.060, 0.0722}, {{1, 1, 1}, 0.3127, 0.3290, 1}};
    for (const auto& row : rows) {
        const Chromaticity c = chromaticity_of(row.rgb);
        EXPECT_NEAR(c.x, row.x, 5e-5);
        EXPECT_NEAR(c.y, row.y, 5e-5);
        EXPECT_NEAR(c.luminance_cd_m2, row.luminance, 5e-5);
        const glm::dvec3 back = light_of(c);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(back[i], row.rgb[i], 1e-9);
    }
    // CIE 15:2004: D65 has u' = 0.1978, v' = 0.4683.
    EXPECT_NEAR((Chromaticity{0.31272, 0.32903, 1}.uv().x), 0.1978, 1e-4);
    EXPECT_NEAR((Chromaticity{0.31272, 0.32903, 1}.uv().y), 0.4683, 1e-4);
}

TEST(Display, FitFindsAPanelOfKnownLight) {
    const auto panel = fit_panel(readings(true));
    ASSERT_TRUE(panel) << panel.error().message;
    double worst = 0;
    for (const std::array<int, 3> codes : {std::array{7, 7, 7}, {20, 200, 90}, {255, 128, 0}, {250, 250, 250}, {110, 75, 143}, {0, 0, 200}}) {
        const Chromaticity is = chromaticity_of(light_of_codes(*panel, codes));
        const MeterReading should = read_meter(codes, true);
        worst = std::max(worst, std::abs(is.luminance_cd_m2 / should.luminance_cd_m2 - 1));
        EXPECT_LT(glm::length(is.uv() - Chromaticity{should.xy->x, should.xy->y, 1}.uv()), 0.004) << codes[0] << "," << codes[1] << "," << codes[2];
    }
    EXPECT_LT(worst, 0.02);
    for (const auto& curve : panel->curve)
        for (std::size_t code = 1; code < 256; ++code) ASSERT_GT(curve[code], curve[code - 1]);
}

TEST(Display, APhotometerAloneGivesTheLuminance) {
    const auto panel = fit_panel(readings(false));
    ASSERT_TRUE(panel);
    for (const int code : {5, 40, 111, 200, 255}) {
        const double is = chromaticity_of(light_of_codes(*panel, {code, code, code})).luminance_cd_m2;
        EXPECT_NEAR(is / read_meter({code, code, code}, false).luminance_cd_m2, 1, 0.02) << code;
    }
}

TEST(Display, TheCheckHoldsReadingsOut) {
    const auto check = check_display(readings(true), Photometry{});
    ASSERT_TRUE(check);
    ASSERT_TRUE(check->additivity);
    EXPECT_NEAR(*check->additivity, 0, 1e-6) << "this panel's channels are independent";
    for (const DisplayCheck::Row& row : check->rows) {
        const int code = row.reading.codes[0];
        const bool ramp = code == row.reading.codes[1] && code > 0 && code < 255;
        EXPECT_EQ(row.held_out_cd_m2.has_value(), ramp);
        EXPECT_NEAR(row.fitted_cd_m2 / row.reading.luminance_cd_m2, 1, 1e-4);
        if (ramp && code > 16) {
            EXPECT_NEAR(*row.held_out_cd_m2 / row.reading.luminance_cd_m2, 1, 0.03) << code;
        }
    }
}

// The white is D65 and within what both panels can send.
TEST(Display, WhiteIsWhatBothEyesCanShow) {
    DisplayFile file;
    file.eyes[0] = readings(true);
    file.eyes[1] = readings(true);
    for (MeterReading& r : file.eyes[1]) r.luminance_cd_m2 *= 0.9;
    const auto photometry = measured_photometry(file);
    ASSERT_TRUE(photometry);
    EXPECT_NEAR(photometry->white_cd_m2, 0.9 * (true_white + true_black), 0.02);
    EXPECT_NEAR(photometry->black_cd_m2, true_black, 1e-6);
}

class DisplayFileTest : public ::testing::Test {
protected:
    void TearDown() override { fs::remove(path_); }
    Result<DisplayFile> read(const std::string& text) {
        std::ofstream(path_) << text;
        return read_display_file(path_);
    }
    const std::string path_ = (fs::temp_directory_path() / fmt::format("entoptic_display_{}.toml", getpid())).string();
};

TEST_F(DisplayFileTest, ReadsBothForms) {
    const auto file = read("instrument = \"meter\"\n[both]\nreadings = [[0, 0, 0, 0.05], [255, 255, 255, 0.3127, 0.3290, 120]]\n");
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->instrument, "meter");
    ASSERT_EQ(file->eyes[1].size(), 2u);
    EXPECT_FALSE(file->eyes[0][0].xy);
    EXPECT_DOUBLE_EQ(file->eyes[0][1].xy->y, 0.3290);
    EXPECT_DOUBLE_EQ(file->eyes[0][1].luminance_cd_m2, 120);
}

TEST_F(DisplayFileTest, SaysWhatIsWrongAndWhere) {
    const struct { const char *text, *said; } rows[] = {
        {"[both]\nreadings = [\n[0, 0, 0, 0.05],\n[256, 0, 0, 1]]", ":4: a reading is [RED, GREEN, BLUE, CD_PER_M2]"},
        {"[both]\nreadings = [[0, 0, 0, -1]]", ":2: a reading is"},
        {"[both]\nreadings = [[0, 0, 0, 0.9, 0.9, 1]]", ":2: a reading is"},
        {"[both]\nreadings = [[0, 0, 0, nan]]", ":2: a reading is"},
        {"[left]\nreadings = [[0, 0, 0, 1]]", "readings of both eyes are needed"},
        {"[both]\nreading = 1", ":1: write 'readings"},
        {"gamma = 2.2", ":1: there is no key 'gamma'"},
        {"[both\n", ":1:"},
    };
    for (const auto& row : rows) {
        const auto file = read(row.text);
        ASSERT_FALSE(file) << row.text;
        EXPECT_NE(file.error().message.find(row.said), std::string::npos) << file.error().message;
    }
    EXPECT_FALSE(find_display_file("no/such"));
    EXPECT_FALSE(find_display_file("no-such-display"));
}

TEST(Display, ReadingsThatCannotBeAPanelAreRefused) {
    const auto fit = [](std::vector<MeterReading> list) { return fit_panel(list); };
    const auto gray = [](int code, double light) { return MeterReading{{code, code, code}, {}, light, "file:7"}; };
    EXPECT_FALSE(fit({gray(255, 100)})) << "no black";
    EXPECT_FALSE(fit({gray(0, 1)})) << "no white";
    EXPECT_FALSE(fit({gray(0, 100), gray(255, 100)})) << "no light";
    const auto falling = fit({gray(0, 0.1), gray(100, 20), gray(120, 19), gray(255, 100)});
    ASSERT_FALSE(falling);
    EXPECT_NE(falling.error().message.find("file:7"), std::string::npos);
    const auto alone = [](std::size_t channel, glm::dvec2 xy, double light) {
        MeterReading reading{{}, xy, light, "file:9"};
        reading.codes[channel] = 255;
        return reading;
    };
    EXPECT_TRUE(fit({gray(0, 0), alone(0, {0.64, 0.33}, 20), alone(1, {0.3, 0.6}, 70), alone(2, {0.15, 0.06}, 7)}));
    const auto mixed = fit({gray(0, 0), alone(0, {0.64, 0.33}, 20), alone(1, {0.3, 0.6}, 70), alone(2, {0.302, 0.598}, 7)});
    ASSERT_FALSE(mixed) << "blue is green";
    EXPECT_NE(mixed.error().message.find("mixtures"), std::string::npos);
    EXPECT_TRUE(fit({gray(0, 0), gray(255, 100)})) << "sRGB's curve where none was read";
}

}  // namespace
}  // namespace entoptic::app
