// The OpenXR half of a sample: instance, system, session, swapchains, event and frame loop. A sample gives a Scene, which
// draws; it never sees an OpenXR object. OpenXR 1.0, XR_KHR_vulkan_enable2, one swapchain a view.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "samples/common/gpu.h"

namespace samples {

// Which detail an eye can see (XR_ENTOPTICX_observer).
struct SeenDetail {
    glm::vec3 gaze{0, 0, -1};       // unit vector in the eye's own axes: x right, y up, -z ahead
    float resolved_angle = 0;       // finest detail that the eye resolves where it looks, rad
    float eccentricity_factor = 0;  // 1/rad: that grows to resolved_angle * (1 + this * angle from the gaze)
};

// Where an eye is and what it sees: position in metres in LOCAL space (origin at the initial head, looking along -z, y up),
// field of view as tangents of its four angles (left and down negative).
struct EyeView {
    glm::vec3 position{0};
    glm::quat orientation{1, 0, 0, 0};
    float tan_left = -1, tan_right = 1, tan_up = 1, tan_down = -1;
    std::optional<SeenDetail> seen;  // XrAppOptions::gaze, and the runtime knows where the eye looks
};

// The images of one eye that the sample draws into.
struct EyeImages {
    VkExtent2D extent{};
    VkFormat format = VK_FORMAT_UNDEFINED;
    std::vector<VkImage> images;
    std::vector<VkImage> depth_images;  // D32_SFLOAT; empty: the runtime does not ask how far away things are
};

// What the user did with the controllers since the last frame.
struct ControllerInput {
    bool toggle = false;  // select was pressed
    float dim = 0;        // -1 … 1: thumbstick or trackpad up positive; a trigger pulled is negative
};

struct FrameTime {
    double seconds = 0;         // predicted display time since the first frame of the run; virtual in lockstep
    double period_seconds = 0;  // predicted display period
};

// What a sample does. Calls come in the order prepare, then for each frame update, then draw for each eye.
class Scene {
public:
    virtual ~Scene() = default;
    // The swapchains exist; called once.
    virtual void prepare(const Gpu& gpu, const std::vector<EyeImages>& eyes) = 0;
    // Advances to the time of this frame. False asks for the end of the session.
    virtual bool update(const FrameTime& time, const ControllerInput& input) = 0;
    // Luminance in cd/m² of a pixel of linear RGB (1, 1, 1) in the frame begun by update().
    virtual float luminance_per_unit() const = 0;
    // Records and submits the picture of one eye into its image, which is and stays in COLOR_ATTACHMENT_OPTIMAL, and into depth image number
    // `depth` if there are any: they are and stay in DEPTH_STENCIL_ATTACHMENT_OPTIMAL.
    virtual void draw(std::uint32_t eye, std::uint32_t image, std::uint32_t depth, const EyeView& view) = 0;
};

struct XrAppOptions {
    std::string application;        // XrApplicationInfo::applicationName
    std::vector<VkFormat> formats;  // linear float swapchain formats that will do, the best first
    bool scene_luminance = true;    // use XR_ENTOPTICX_scene_luminance where the runtime has it
    bool gaze = false;              // ask XR_ENTOPTICX_observer, where the runtime has it, for EyeView::seen
    bool controllers = false;       // make an action set for ControllerInput
    // Planes of the depth buffer, m (0 near, 1 far): submit it with XR_KHR_composition_layer_depth where the runtime has that. 0: no depth.
    float near_m = 0, far_m = 0;
    std::uint64_t frames = 0;  // ask for the end after so many frames drawn; 0: no limit
    double seconds = 0;        // ask for the end at this predicted display time since the first frame; 0: no limit
};

class XrApp {
public:
    // Throws Failure (missing) when there is no runtime, no headset or an extension is lacking.
    explicit XrApp(XrAppOptions options);
    XrApp(const XrApp&) = delete;
    XrApp& operator=(const XrApp&) = delete;
    ~XrApp();

    // The Vulkan device the runtime wants; lives as long as the XrApp.
    const Gpu& gpu() const;
    // Whether the runtime was told, and understands, XR_ENTOPTICX_scene_luminance.
    bool tells_luminance() const;
    // Runs the session to its end. Returns when the runtime or the sample ended it; throws Failure when either was lost.
    void run(Scene& scene);

    // Asks every running XrApp of the process to end its session; safe in a signal handler.
    static void request_end();

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace samples
