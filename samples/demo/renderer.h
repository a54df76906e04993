// Draws the office into fp16 images of any origin: a swapchain's or our own.
#pragma once

#include <optional>
#include <vector>

#include "samples/common/eye_pass.h"
#include "samples/common/xr_app.h"
#include "samples/demo/bake.h"
#include "samples/demo/detail.h"
#include "samples/demo/lights.h"
#include "samples/demo/office.h"

namespace samples {

enum class Sampling { one, four, gaze };  // samples a pixel; gaze: four where the eye could see one pixel from the next, else one

struct DrawOptions {
    Sampling samples = Sampling::one;
    Detail detail = Detail::full;              // gaze: patches as coarse as the eye cannot tell from the whole (detail.h)
    bool measure = false;                      // draws every picture in full detail first, below what is shown, to compare the times
    double lamp_peak_cd_m2 = bulb_peak_cd_m2;  // the bulb's luminance when it is fully on
    bool keep_depth = false;                   // into the depth images given to add_eye()
};

// What pictures cost.
struct DrawCost {
    std::uint64_t pictures = 0;
    double triangles = 0;              // in all of them
    std::vector<double> milliseconds;  // of each: GPU time, if the device tells it
};

class OfficeRenderer {
public:
    static constexpr VkFormat format = VK_FORMAT_R16G16B16A16_SFLOAT;

    // Planes of the depth buffer, m.
    static constexpr float near_plane = 0.05F, far_plane = 200.0F;

    OfficeRenderer(const Gpu& gpu, const Office& office, const std::vector<Canvas>& materials, const Lightmap& lightmap,
                   const DrawOptions& options);
    OfficeRenderer(const OfficeRenderer&) = delete;
    OfficeRenderer& operator=(const OfficeRenderer&) = delete;

    // The images of one more eye; eyes are numbered in the order of the calls.
    void add_eye(VkExtent2D extent, const std::vector<VkImage>& images, const std::vector<VkImage>& depth_images);

    // Sets the light of the next pictures. `unit_cd_m2` is the luminance of a pixel of value 1.
    void set_light(const Light& light, float unit_cd_m2);
    // Upper bound of any channel of any pixel under `light`, cd/m²: what pre_exposure() needs.
    double brightest(const Light& light) const;

    // Submits the picture of an eye; returns before it is done, unless it measures.
    void draw(std::uint32_t eye, std::uint32_t image, std::uint32_t depth, const EyeView& view);
    // In full detail whatever the options say; not counted.
    void draw_whole(std::uint32_t eye, std::uint32_t image, std::uint32_t depth, const EyeView& view);
    void wait() const;
    // Share of all pixels drawn so far that had four samples.
    double finely_sampled_share() const { return pixels_ > 0 ? fine_pixels_ / pixels_ : 0; }
    // Of all pictures drawn so far with one pass (not `Sampling::gaze`): as shown, and in full detail for comparison (DrawOptions::measure).
    const DrawCost& cost() const { return cost_; }
    const DrawCost& whole_cost() const { return whole_cost_; }
    std::uint64_t whole_triangles() const { return whole_triangles_; }  // of one picture in full detail

private:
    struct Range {
        std::uint32_t first = 0, count = 0;  // indices
    };
    // A patch that has levels of detail, in a batch.
    struct Part {
        std::vector<DetailLevel> levels;
        std::vector<Range> ranges;  // one a level
        Cover cover;
    };
    struct Batch {  // patches of one material, or of one emitter
        Emitter emitter;
        Material material;
        Range fixed;          // patches without levels
        Range parts;          // in parts_; in full detail their indices follow upon `fixed`
        std::uint32_t whole;  // indices of all patches in full detail, from fixed.first
    };
    using Levels = std::vector<std::size_t>;  // of each part; empty: full detail
    // Pipelines for a number of samples.
    struct Style {
        PassFormat format;
        OwnedRenderPass render_pass;
        OwnedPipeline surface, emitter, added_emitter;
    };
    struct Eye {
        EyePass pass;
        std::optional<EyePass> fine;  // over the part where four samples can be seen
        Buffer uniforms;
        VkDescriptorSet set;
        Levels levels;
    };
    void upload_mesh(const Office& office, const Lightmap& lightmap);
    void upload_textures(const std::vector<Canvas>& materials, const Lightmap& lightmap);
    void create_layout();
    Style create_style(const PassFormat& format) const;
    void record(VkCommandBuffer commands, const Style& style, const Eye& eye, const Levels& levels) const;
    void choose_levels(Eye& eye, const EyeView& view) const;
    std::uint64_t triangles(const Levels& levels) const;
    void set_view(const Eye& eye, const EyeView& view) const;
    void draw_pass(Eye& eye, std::uint32_t image, std::uint32_t depth, const Levels& levels, DrawCost* cost);
    // Calls `draw` with the ranges of a batch at these levels, neighbours joined.
    template <class Draw> void for_ranges(const Batch& batch, const Levels& levels, const Draw& draw) const;
    glm::vec3 emitted(Emitter emitter, const Light& light) const;

    const Gpu& gpu_;
    DrawOptions options_;
    glm::vec3 bulb_centre_;
    float brightest_star_ = 0;
    glm::vec4 largest_illuminance_{0};  // of each lightmap channel
    Light light_;
    float unit_ = 1;
    double pixels_ = 0, fine_pixels_ = 0;
    Buffer vertices_, indices_;
    std::vector<Batch> batches_;
    std::vector<Part> parts_;
    std::uint64_t whole_triangles_ = 0;
    DrawCost cost_, whole_cost_;
    Image lightmap_;
    std::vector<Image> textures_;
    OwnedSampler repeat_, clamp_;
    OwnedSetLayout view_layout_, material_layout_;
    OwnedDescriptorPool pool_;
    std::vector<VkDescriptorSet> material_sets_;
    OwnedPipelineLayout pipeline_layout_;
    Style style_;
    std::optional<Style> fine_style_;
    std::vector<Eye> eyes_;
};

// The part of a picture of `extent` in which the eye resolves the angle of a pixel, with a margin for errors of the tracker and for its latency;
// empty when it does so nowhere, all of it when nobody knows where the eye looks.
VkRect2D finely_seen(const EyeView& view, VkExtent2D extent);

// Clip space of Vulkan (y down, depth 0 … 1) from the world, for an asymmetric field of view.
glm::mat4 clip_from_world(const EyeView& view);

}  // namespace samples
