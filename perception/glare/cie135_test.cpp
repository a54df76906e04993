// labels: gpu
#include "perception/glare/cie135_math.glsl"
#include "perception/glare/cie135_params.h"
#include "perception/glare/glare_gate_law.h"
#include "perception/glare/glare_testing.h"

#include <cstring>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);
const char* const name = "glare.cie135";

Selection model(const std::vector<std::string>& settings = {}) { return only({"glare=cie135"}, settings); }

ImageD reference(const ImageF& picture, const EyeGeometry& g, const std::vector<std::string>& settings) {
    ReferenceFrame frame{convert<double>(picture), g, {}, {}, 0, false, 1, 1};
    find_model("glare", "cie135")->create_reference()->apply(frame, model(settings).choices[0].parameters);
    return frame.image;
}

TEST(Cie135, TotalPsfIsThatOfTheTable) {
    double worst = 0;
    for (const OracleRow& row : oracle("cie_glare"))
        worst = std::max(worst, relative_error(cie135::total_psf(row.at("theta_deg"), row.at("age_years"), row.at("pigment_p")), row.at("CIE135_1_total_psf_per_sr")));
    ledger(name, "total PSF", "double against oracle max", worst);
    EXPECT_LT(worst, 1e-7);
}

// Light of one pixel in the middle of a flat picture, a share of it, at whole pixels along the row: the table's normalised weights.
TEST(Cie135, WeightsAreThoseOfTheTable) {
    double worst_near = 0, worst_seam = 0, worst_far = 0;
    for (const int age : {30, 70}) {
        const std::string years = std::to_string(age);
        Glare glare(rectilinear(301, 301, 2 * std::atan(150.5 * degree / 13.85) / degree), model({"glare.photographic=1", "glare.near_from=0", "glare.age=" + years}));
        ImageF in = uniform(301, 301, 0);
        fill(in, 150, 150, 1, 1, 1e6f);
        const ImageF out = glare.at(in);
        for (const OracleRow& row : oracle("cie135_pixel_weights_age" + years)) {
            const int offset = static_cast<int>(row.at("offset_px"));
            if (row.at("ppd") != 13.85 || offset > 140) continue;
            // The table's pixels are all as far apart as the middle ones; on a flat picture those outside lie nearer.
            const double theta = std::atan(offset * degree / 13.85);
            const double psf = cie135::total_psf(theta / degree, age, 0.5) / cie135::total_psf(row.at("offset_deg"), age, 0.5);
            const double error = relative_error(static_cast<double>(out.at(150 + offset, 150, 1)) / 1e6, row.at("weight") * (offset > 10 ? psf : 1));
            double& worst = offset <= 6 ? worst_near : offset <= 24 ? worst_seam : worst_far;
            worst = std::max(worst, error);
        }
    }
    ledger(name, "lamp of a pixel, 13.85 ppd", "GPU weights against oracle max: to 6 pixels", worst_near);
    ledger(name, "lamp of a pixel, 13.85 ppd", "GPU weights against oracle max: 8 to 20 pixels", worst_seam);
    ledger(name, "lamp of a pixel, 13.85 ppd", "GPU weights against oracle max: beyond", worst_far);
    EXPECT_LT(worst_near, 0.08);
    // Where near field and grid of 4 pixels a texel meet.
    EXPECT_LT(worst_seam, 0.03);
    EXPECT_LT(worst_far, 0.005);
}

TEST(Cie135, GpuAgreesWithTheReference) {
    struct Case { const char* what; std::vector<std::string> settings; };
    for (const Case& c : {Case{"residual", {}}, Case{"residual, age 70", {"glare.age=70"}}, Case{"photographic, all light near", {"glare.photographic=1", "glare.near_from=0"}}}) {
        ImageF in = textured(64, 52, 1);
        fill(in, 30, 20, 3, 3, 1e4f, 6e3f, 1e4f);
        const EyeGeometry g = rectilinear(64, 52, 6.7);
        const ImageF gpu = Glare(g, model(c.settings)).at(in);
        const ImageD exact = reference(in, g, c.settings);
        const ErrorSummary light = summary(relative_errors(gpu, exact, 1e-3));
        ledger(name, c.what, "GPU against reference p99", light.p99);
        ledger(name, c.what, "GPU against reference mean", light.mean);
        EXPECT_LT(light.mean, 0.02) << c.what;
        EXPECT_LT(light.p99, 0.06) << c.what;
    }
}

// A panorama: wherever a lamp stands, at the middle of a cube's face, edge or corner or over a pole, its veil is a disc of 90 to 100 degrees.
TEST(Cie135, VeilOfAPanoramaIsThatOfTheReference) {
    EyeGeometry sphere{};
    sphere.kind = geometry_equirect;
    sphere.width = 64;
    sphere.height = 32;
    const struct { const char* what; int x, y; } lamps[] = {{"in front", 32, 16}, {"at 45 degrees", 40, 16}, {"at a cube's corner", 40, 22}, {"above", 13, 1}};
    for (const auto& lamp : lamps) {
        ImageF in = uniform(64, 32, 1);
        fill(in, lamp.x, lamp.y, 2, 2, 1e5f);
        const ImageF gpu = Glare(sphere, model()).at(in);
        const ErrorSummary light = summary(relative_errors(gpu, reference(in, sphere, {}), 1));
        ledger(name, std::string("panorama, lamp ") + lamp.what, "GPU against reference p99", light.p99);
        ledger(name, std::string("panorama, lamp ") + lamp.what, "GPU against reference mean", light.mean);
        EXPECT_LT(light.mean, 0.03) << lamp.what;
        // Over a pole one kernel a tile of pixels does not fit.
        EXPECT_LT(light.p99, lamp.y < 4 ? 0.5 : 0.2) << lamp.what;
    }
}

TEST(Cie135, WithinThePanelsWhiteNothingHappens) {
    const ImageF in = textured(64, 52, 1);
    ImageF bright = in;
    for (float& v : bright.data) v = std::min(v * 100, 130.0f);
    Glare glare(rectilinear(64, 52, 60), model());
    const ImageF out = glare.at(bright);
    EXPECT_TRUE(glare.outcome().gated);
    EXPECT_EQ(0, std::memcmp(out.data.data(), bright.data.data(), out.data.size() * sizeof(float)));
}

TEST(Cie135, GateIsExactOnBothSides) { expect_exact_gate(model()); }

}  // namespace
}  // namespace entoptic::perception
