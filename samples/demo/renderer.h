// Draws the office into fp16 images of any origin: a swapchain's or our own.
#pragma once

#include <vector>

#include "samples/common/eye_pass.h"
#include "samples/common/xr_app.h"
#include "samples/demo/bake.h"
#include "samples/demo/lights.h"
#include "samples/demo/office.h"

namespace samples {

class OfficeRenderer {
public:
    static constexpr VkFormat format = VK_FORMAT_R16G16B16A16_SFLOAT;

    // Planes of the depth buffer, m.
    static constexpr float near_plane = 0.05F, far_plane = 200.0F;

    // `samples`: 1 or 4 a pixel. `keep_depth`: into the depth images given to add_eye(). `lamp_peak_cd_m2`: the bulb's luminance when it is fully on.
    OfficeRenderer(const Gpu& gpu, const Office& office, const std::vector<Canvas>& materials, const Lightmap& lightmap,
                   VkSampleCountFlagBits samples, double lamp_peak_cd_m2, bool keep_depth);
    OfficeRenderer(const OfficeRenderer&) = delete;
    OfficeRenderer& operator=(const OfficeRenderer&) = delete;

    // The images of one more eye; eyes are numbered in the order of the calls.
    void add_eye(VkExtent2D extent, const std::vector<VkImage>& images, const std::vector<VkImage>& depth_images);

    // Sets the light of the next pictures. `unit_cd_m2` is the luminance of a pixel of value 1.
    void set_light(const Light& light, float unit_cd_m2);
    // Upper bound of any channel of any pixel under `light`, cd/m²: what pre_exposure() needs.
    double brightest(const Light& light) const;

    // Submits the picture of an eye; returns before it is done.
    void draw(std::uint32_t eye, std::uint32_t image, std::uint32_t depth, const EyeView& view);
    void wait() const;

private:
    struct Batch {  // patches of one material, or of one emitter
        Emitter emitter;
        Material material;
        std::uint32_t first_index, index_count;
    };
    struct Eye {
        EyePass pass;
        Buffer uniforms;
        VkDescriptorSet set;
    };
    void upload_mesh(const Office& office, const Lightmap& lightmap);
    void upload_textures(const std::vector<Canvas>& materials, const Lightmap& lightmap);
    void create_pipelines();
    void record(VkCommandBuffer commands, const Eye& eye) const;
    glm::vec3 emitted(Emitter emitter, const Light& light) const;

    const Gpu& gpu_;
    PassFormat pass_format_;
    double lamp_peak_cd_m2_;
    glm::vec3 bulb_centre_;
    float brightest_star_ = 0;
    glm::vec4 largest_illuminance_{0};  // of each lightmap channel
    Light light_;
    float unit_ = 1;
    OwnedRenderPass render_pass_;
    Buffer vertices_, indices_;
    std::vector<Batch> batches_;
    Image lightmap_;
    std::vector<Image> textures_;
    OwnedSampler repeat_, clamp_;
    OwnedSetLayout view_layout_, material_layout_;
    OwnedDescriptorPool pool_;
    std::vector<VkDescriptorSet> material_sets_;
    OwnedPipelineLayout pipeline_layout_;
    OwnedPipeline surface_, emitter_, added_emitter_;
    std::vector<Eye> eyes_;
};

// Clip space of Vulkan (y down, depth 0 … 1) from the world, for an asymmetric field of view.
glm::mat4 clip_from_world(const EyeView& view);

}  // namespace samples
