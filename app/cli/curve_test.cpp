// labels: gpu
// `entoptic curve`: documents, pictures, defaults, and errors that name what there is.
#include "app/testing/command_line.h"

#include <cmath>

namespace entoptic::app {
namespace {

using Json = nlohmann::ordered_json;

class Curve : public testing::CommandLineTest {
protected:
    Json document(std::vector<std::string> arguments) const {
        arguments.insert(arguments.begin(), "curve");
        arguments.emplace_back("--json");
        const auto outcome = entoptic(arguments);
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return outcome.json();
    }
};

TEST_F(Curve, DocumentKeepsItsForm) {
    const Json d = document({"mesopic.cone_share", "--x", "0.005,0.158113883,5", "--set", "model=jacobs_mesopic", "--set", "range=0"});
    EXPECT_EQ(d.at("name"), "mesopic.cone_share");
    EXPECT_EQ(d.at("model"), "jacobs_mesopic");
    EXPECT_EQ(d.at("x_unit"), "cd/m²");
    EXPECT_EQ(d.at("y_unit"), "1");
    EXPECT_EQ(d.at("settings").at("range"), 0);
    EXPECT_EQ(d.at("columns"), Json({"x", "gpu", "double", "reference"}));
    ASSERT_EQ(d.at("rows").size(), 3u);
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t column = 1; column < 4; ++column) EXPECT_NEAR(d.at("rows")[i][column].get<double>(), 0.5 * double(i), 1e-6);
}

TEST_F(Curve, VectorsAndPartsAndSettingsLeftOut) {
    const Json d = document({"afterimage.bleaching", "--x", "0:1:5", "--set", "b1=1e-3,2e-4,1e-6", "--set", "luminance=1e5"});
    EXPECT_EQ(d.at("columns").size(), 10u);
    EXPECT_EQ(d.at("columns")[1], "gpu_L");
    EXPECT_EQ(d.at("columns")[9], "reference_S");
    EXPECT_EQ(d.at("settings").at("b1"), Json({0.001, 0.0002, 0.000001}));
    EXPECT_EQ(d.at("rows")[0][1], 0);
    const Json disc = document({"dof.disc", "--x", "0.5", "--set", "pupil_mm=4.49"});
    EXPECT_TRUE(disc.at("settings").at("wavelength_nm").is_null());
    EXPECT_NEAR(disc.at("rows")[0][1].get<double>(), 0.25725805, 1e-6);
}

TEST_F(Curve, ScalesAreWhatWasAsked) {
    const Json linear = document({"lca.defocus", "--x", "400:700:4"}), log = document({"acuity.cutoff", "--x", "1e-4:1e2:4:log"});
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_DOUBLE_EQ(linear.at("rows")[i][0].get<double>(), 400 + 100 * double(i));
        EXPECT_NEAR(log.at("rows")[i][0].get<double>(), std::pow(10, -4 + 2 * double(i)), 1e-9 * std::pow(10, -4 + 2 * double(i)));
    }
}

TEST_F(Curve, DefaultIsTheModelOfCombined) {
    const Json effects = entoptic({"effects", "--json"}).json();
    for (const Json& preset : effects.at("presets"))
        if (preset.at("name") == "combined") {
            EXPECT_EQ(document({"adaptation.step", "--x", "1"}).at("model"), preset.at("models").at("adaptation"));
            EXPECT_EQ(document({"tone.response", "--x", "1"}).at("model"), preset.at("models").at("tone"));
        }
}

TEST_F(Curve, TableAndNotes) {
    const auto outcome = entoptic({"curve", "glare.psf", "--x", "1,10", "--set", "model=cie135", "--set", "pupil_mm=5"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("reference"), std::string::npos);
    EXPECT_NE(outcome.err.find("does not depend on pupil_mm"), std::string::npos) << outcome.err;
}

TEST_F(Curve, PlotIsAPicture) {
    const auto outcome = entoptic({"curve", "pupil.diameter", "--x", "1e-4:1e4:41:log", "--plot", path("pupil.svg")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    const std::string svg = testing::text_of(path("pupil.svg"));
    EXPECT_EQ(svg.rfind("<svg ", 0), 0u);
    for (const char* text : {"gpu", "double", "reference", "scene luminance, cd/m²", "pupil diameter, mm", "</svg>"}) EXPECT_NE(svg.find(text), std::string::npos) << text;
    for (const char* text : {"Mnan", "Lnan", " nan", "inf"}) EXPECT_EQ(svg.find(text), std::string::npos) << text;
    expect_error(1, "nowhere", {"curve", "pupil.diameter", "--x", "1,2", "--plot", path("nowhere/pupil.svg")});
}

TEST_F(Curve, ErrorsNameWhatThereIs) {
    expect_error(1, "no value at 1", {"curve", "glare.psf", "--x", "1", "--set", "model=fraunhofer_mask", "--set", "lid_open=0"});
    expect_error(1, "closed_form", {"curve", "glare.psf", "--x", "1", "--set", "model=none"});
    expect_error(1, "closed_form", {"curve", "glare.psf", "--x", "1", "--set", "model=larson_increment"});
    expect_error(2, "adaptation.step", {"curve", "adaptation", "--x", "1"});
    expect_error(2, "--x", {"curve", "adaptation.step"});
    expect_error(2, "FROM:TO:N", {"curve", "adaptation.step", "--x", "1:2"});
    expect_error(2, "N is a whole number", {"curve", "adaptation.step", "--x", "1:2:1"});
    expect_error(2, "above 0", {"curve", "adaptation.step", "--x", "0:2:5:log"});
    expect_error(2, "not a list", {"curve", "adaptation.step", "--x", "1,two"});
    expect_error(2, "from 0 to 90", {"curve", "glare.psf", "--x", "1,91"});
    expect_error(2, "krawczyk_exp_linear", {"curve", "adaptation.step", "--x", "1", "--set", "model=nobody"});
    expect_error(2, "NAME=VALUE", {"curve", "adaptation.step", "--x", "1", "--set", "from"});
    expect_error(2, "1e-06..1e+08", {"curve", "adaptation.step", "--x", "1", "--set", "from=0"});
    expect_error(2, "tau_rod_s", {"curve", "adaptation.step", "--x", "1", "--set", "form=3"});
    expect_error(2, "3 numbers", {"curve", "afterimage.bleaching", "--x", "1", "--set", "b1=1e-3,1e-4"});
    expect_error(1, "watson_yellott", {"curve", "pupil.diameter", "--x", "1", "--set", "model=luidolt_pupil"});
    const auto help = entoptic({"curve", "--help"});
    EXPECT_EQ(help.status, 0);
    for (const char* text : {"glare.psf", "closed_form", "gpu_L", "wavelength_nm", "--plot"}) EXPECT_NE(help.out.find(text), std::string::npos) << text;
}

}  // namespace
}  // namespace entoptic::app
