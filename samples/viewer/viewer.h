// Shows one radiance map around the viewer.
#pragma once

#include <memory>
#include <vector>

#include "samples/common/eye_pass.h"
#include "samples/common/picture.h"
#include "samples/common/xr_app.h"

namespace samples {

enum class Projection { equirect, flat };

// How map values become light: values are multiplied by `scale` on the way to the device; a unit is then `unit_cd_m2`.
struct Exposure {
    float scale = 1;       // a power of two: changes no digit of a value
    float unit_cd_m2 = 1;  // luminance_per_unit of the layer
};

// The exposure at which the largest finite value of a picture fits fp16 (65504), if `half` precision is used anywhere on the
// way; the scale is 1 where it can be. `cd_per_unit` is the luminance of the file's (1, 1, 1).
Exposure choose_exposure(const Picture& picture, double cd_per_unit, bool half);

class Viewer : public Scene {
public:
    struct Options {
        Projection projection = Projection::equirect;
        float fov_degrees = 60;  // flat: horizontal
        double cd_per_unit = 1;
    };

    Viewer(RadianceMap map, const Options& options) : map_(std::move(map)), options_(options) {}
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;

    void prepare(const Gpu& gpu, const std::vector<EyeImages>& eyes) override;
    bool update(const FrameTime&, const ControllerInput&) override { return true; }
    float luminance_per_unit() const override { return exposure_.unit_cd_m2; }
    void draw(std::uint32_t eye, std::uint32_t image, std::uint32_t depth, const EyeView& view) override;

private:
    void upload_map(const Gpu& gpu, bool half_target);
    void create_pipeline(const Gpu& gpu, VkFormat format);

    RadianceMap map_;
    Options options_;
    Exposure exposure_;
    float aspect_ = 1;  // height over width of the map
    OwnedRenderPass render_pass_;
    Image texture_;
    OwnedSampler sampler_;
    OwnedSetLayout set_layout_;
    OwnedDescriptorPool pool_;
    VkDescriptorSet set_ = VK_NULL_HANDLE;
    OwnedPipelineLayout layout_;
    OwnedPipeline pipeline_;
    std::vector<EyePass> eyes_;
};

}  // namespace samples
