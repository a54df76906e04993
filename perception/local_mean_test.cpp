// labels: gpu
#include "perception/gate.h"
#include "perception/local_mean.h"
#include "perception/local_mean_math.glsl"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"
#include "shaders/geometry.glsl"

#include <cstring>

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);

// A model that does nothing but take the local means; what it found is written over the picture, interpolated by the CPU.
class MeansOnly final : public Model {
public:
    static Result<std::unique_ptr<Model>> create(const ModelContext& context) {
        auto model = std::make_unique<MeansOnly>();
        ENTOPTIC_TRY(mean, LocalMean::create(context));
        model->mean = std::move(mean);
        ENTOPTIC_TRY(back, gpu::Buffer::create(context.device, model->mean.means().size(), gpu::BufferKind::readback, "means"));
        model->back = std::move(back);
        last = model.get();
        return model;
    }
    void set_parameters(std::span<const float> v) override { diameter_deg = v[0]; }
    Result<void> record(StageIo& io) override {
        const Gate gate{.dispatch = {{mean.node_groups(), 1, io.views}}};
        std::memcpy(io.gate.bytes().data(), &gate, sizeof(gate));
        mean.record(io, diameter_deg, 0);
        io.commands.copy(mean.means(), back, back.size());
        return {};
    }
    LocalMean mean;
    gpu::Buffer back;
    float diameter_deg = 2;
    static inline MeansOnly* last = nullptr;
};

ImageD means(const ImageF& picture, const EyeGeometry& g, float diameter_deg) {
    static constexpr ParameterInfo parameters[] = {{"diameter", "°", 0, 10, 2, "choice: for tests", "window"}};
    static const ModelEntry entry{"mesopic", "means", "for tests", parameters, &MeansOnly::create, nullptr};
    StageRunner runner({g}, {"test", {{&entry, {diameter_deg}}}});
    runner.run(picture, still_input(1));
    const MeansOnly& model = *MeansOnly::last;
    const auto node = model.back.as<float>();
    const LocalMeanGrid& grid = model.mean.grid();
    ImageD out(picture.width, picture.height, 1);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x) {
            const NodePlace p = node_place(grid, {x + 0.5, y + 0.5});
            const auto at = [&](uint nx, uint ny) { return static_cast<double>(node[ny * grid.nodes_x + nx]); };
            out.at(x, y, 0) = between_nodes(p, at(p.x0, p.y0), at(p.x1, p.y0), at(p.x0, p.y1), at(p.x1, p.y1));
        }
    return out;
}

TEST(LocalMean, IsTheMeanByItsDefinition) {
    struct Case {
        const char* setting;
        EyeGeometry geometry;
        float diameter_deg;
    };
    for (const Case& c : {Case{"13.9 ppd", rectilinear(120, 90, 8.6), 2}, Case{"30 ppd", rectilinear(120, 80, 4), 2}, Case{"104 deg", rectilinear(201, 117, 104), 5},
                          Case{"headset's lens", vive_lens(180, 200), 4}}) {
        const int width = static_cast<int>(c.geometry.width), height = static_cast<int>(c.geometry.height);
        const ImageF picture = textured(width, height, 0.1, 20);
        const ImageD gpu = means(picture, c.geometry, c.diameter_deg), truth = local_mean_reference(convert<double>(picture), c.geometry, static_cast<double>(c.diameter_deg));
        std::vector<double> errors;
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                if (geometry::geometry_visible(c.geometry, {x + 0.5, y + 0.5})) errors.push_back(relative_error(gpu.at(x, y, 0), truth.at(x, y, 0)));
        const ErrorSummary error = summary(errors);
        ledger("local mean", c.setting, "float against definition p99 rel", error.p99);
        ledger("local mean", c.setting, "float against definition mean rel", error.mean);
        std::printf("max %.3g\n", error.max);
        EXPECT_LT(error.p99, 0.2) << c.setting;
        EXPECT_LT(error.mean, 0.05) << c.setting;
    }
}

TEST(LocalMean, OfAUniformPictureIsThatPicture) {
    for (const EyeGeometry& g : {rectilinear(101, 77, 30), vive_lens(180, 200), rectilinear(3, 2, 50)})
        for (float y : {1e-6f, 0.3f, 1e8f}) {
            const ImageD mean = means(uniform(static_cast<int>(g.width), static_cast<int>(g.height), y), g, 2);
            for (int j = 0; j < mean.height; ++j)
                for (int i = 0; i < mean.width; ++i)
                    if (geometry::geometry_visible(g, {i + 0.5, j + 0.5})) {
                        ASSERT_LT(relative_error(mean.at(i, j, 0), static_cast<double>(y)), 2e-6) << i << " " << j;
                    }
        }
}

TEST(LocalMean, BetweenEqualNodesIsExact) {
    const NodePlace p{0, 1, 0, 1, 0.3, 0.7};
    EXPECT_EQ(between_nodes(p, 1.0, 1.0, 1.0, 1.0), 1.0);
    EXPECT_EQ(between_nodes(p, 0.0, 0.0, 0.0, 0.0), 0.0);
}

}  // namespace
}  // namespace entoptic::perception
