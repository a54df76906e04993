// labels: gpu frame
// One set of layers through Vulkan, through OpenGL on shared memory, through EGL, and through OpenGL that the CPU copies: every code value of
// the panel is the same. The pictures lie in memory as each API has them: OpenGL's from their lowest row on.
#include "runtime/testing/opengl_application.h"

#include "runtime/testing/client.h"

#include "app/config.h"
#include "app/host/host.h"
#include "base/image_io.h"
#include "base/testing/x_server.h"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <glm/gtc/packing.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace entoptic::runtime::testing {
namespace {

namespace fs = std::filesystem;

constexpr int width = 40, height = 32, slices = 2;

struct Format {
    VkFormat vk;
    GLenum sized, format, type;
    std::size_t texel_bytes;
    bool depth = false;
};
constexpr Format srgb8{VK_FORMAT_R8G8B8A8_SRGB, GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4};
constexpr Format depth32{VK_FORMAT_D32_SFLOAT, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4, true};
constexpr Format depth16{VK_FORMAT_D16_UNORM, GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT, GL_UNSIGNED_SHORT, 2, true};
constexpr Format other_colours[] = {
    {VK_FORMAT_R8G8B8A8_UNORM, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    {VK_FORMAT_R16G16B16A16_SFLOAT, GL_RGBA16F, GL_RGBA, GL_HALF_FLOAT, 8},
    {VK_FORMAT_R32G32B32A32_SFLOAT, GL_RGBA32F, GL_RGBA, GL_FLOAT, 16},
    {VK_FORMAT_R16G16B16A16_UNORM, GL_RGBA16, GL_RGBA, GL_UNSIGNED_SHORT, 8},
    {VK_FORMAT_A2B10G10R10_UNORM_PACK32, GL_RGB10_A2, GL_RGBA, GL_UNSIGNED_INT_2_10_10_10_REV, 4},
};

// 0..1, without symmetry: a picture that is turned over, mirrored, shifted by a texel or of another layer is another picture.
float value(int x, int y, int layer, int channel) {
    if (channel == 3) return 1;
    return static_cast<float>((x * 5 + y * 3 + layer * 41 + channel * 29 + (x > y ? 60 : 0)) % 200) / 255.0f;
}

std::vector<std::byte> texel(const Format& format, int x, int y, int layer) {
    std::vector<std::byte> bytes(format.texel_bytes);
    const auto put = [&](auto number, std::size_t at) { std::memcpy(bytes.data() + at * sizeof number, &number, sizeof number); };
    if (format.depth) {
        const float z = y < height / 2 ? 0.05f + 0.01f * static_cast<float>(layer) : 0.9f;  // above a hand's breadth away, below metres
        format.type == GL_FLOAT ? put(z, 0) : put(static_cast<std::uint16_t>(z * 65535), 0);
        return bytes;
    }
    std::uint32_t packed = 3u << 30;
    for (int c = 0; c < 4; ++c) {
        const float v = value(x, y, layer, c);
        const auto at = static_cast<std::size_t>(c);
        if (format.type == GL_UNSIGNED_BYTE) put(static_cast<std::uint8_t>(v * 255 + 0.5f), at);
        if (format.type == GL_UNSIGNED_SHORT) put(static_cast<std::uint16_t>(v * 65535 + 0.5f), at);
        if (format.type == GL_HALF_FLOAT) put(glm::packHalf1x16(v), at);
        if (format.type == GL_FLOAT) put(v, at);
        if (c < 3) packed |= static_cast<std::uint32_t>(v * 1023 + 0.5f) << 10 * c;
    }
    if (format.type == GL_UNSIGNED_INT_2_10_10_10_REV) put(packed, 0);
    return bytes;
}

struct Picture {
    Format format;
    int layers = 1;     // array slices or faces
    bool cube = false;  // its faces lie in memory alike in all APIs
    int w = width, h = height;
};

std::vector<std::byte> bytes_of(const Picture& picture, bool bottom_up) {
    std::vector<std::byte> bytes;
    for (int layer = 0; layer < picture.layers; ++layer) {
        for (int row = 0; row < picture.h; ++row) {
            const int y = bottom_up && !picture.cube ? picture.h - 1 - row : row;
            for (int x = 0; x < picture.w; ++x) {
                const auto one = texel(picture.format, x, y, layer);
                bytes.insert(bytes.end(), one.begin(), one.end());
            }
        }
    }
    return bytes;
}

// An application's graphics API.
class Painter {
public:
    virtual ~Painter() = default;
    virtual std::vector<const char*> extensions() const = 0;
    virtual void ask_requirements(Client& client) = 0;
    virtual XrSession make_session(Client& client) = 0;
    virtual std::int64_t format(const Format& format) const = 0;
    virtual bool bottom_up() const = 0;
    virtual void paint(Client& client, XrSwapchain swapchain, std::uint32_t index, const Picture& picture) = 0;
    virtual std::size_t expected_errors() const { return 0; }

protected:
    static XrSession create(Client& client, const void* binding) {
        const XrSessionCreateInfo info{XR_TYPE_SESSION_CREATE_INFO, binding, 0, 1};
        XrSession session = XR_NULL_HANDLE;
        EXPECT_EQ(client.xrCreateSession(client.instance, &info, &session), XR_SUCCESS);
        return session;
    }
    template <class Image> static Image image(Client& client, XrSwapchain swapchain, XrStructureType type, std::uint32_t index) {
        std::vector<Image> images(1, Image{type});
        std::uint32_t count = 0;
        EXPECT_EQ(client.xrEnumerateSwapchainImages(swapchain, 1, &count, reinterpret_cast<XrSwapchainImageBaseHeader*>(images.data())),
                  XR_SUCCESS);
        return images.at(index);
    }
};

class VulkanPainter final : public Painter {
public:
    std::vector<const char*> extensions() const override { return {"XR_KHR_vulkan_enable2"}; }
    void ask_requirements(Client& client) override { vulkan_ = std::make_unique<VulkanApplication>(client); }
    XrSession make_session(Client& client) override {
        const auto binding = vulkan_->binding();
        return create(client, &binding);
    }
    std::int64_t format(const Format& format) const override { return format.vk; }
    bool bottom_up() const override { return false; }
    void paint(Client& client, XrSwapchain swapchain, std::uint32_t index, const Picture& picture) override {
        upload(image<XrSwapchainImageVulkan2KHR>(client, swapchain, XR_TYPE_SWAPCHAIN_IMAGE_VULKAN2_KHR, index).image, picture);
    }
    bool turn_colour = false, turn_depth = false;  // the rows of that picture are written the wrong way round

private:
    void upload(VkImage image, const Picture& picture) {
        const VkDevice device = vulkan_->device;
        const auto bytes = bytes_of(picture, picture.format.depth ? turn_depth : turn_colour);
        VkBuffer buffer = VK_NULL_HANDLE;
        VkDeviceMemory memory = VK_NULL_HANDLE;
        const VkBufferCreateInfo buffer_info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
                                             nullptr,
                                             0,
                                             bytes.size(),
                                             VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                                             VK_SHARING_MODE_EXCLUSIVE,
                                             0,
                                             nullptr};
        ASSERT_EQ(vkCreateBuffer(device, &buffer_info, nullptr, &buffer), VK_SUCCESS);
        VkMemoryRequirements needs{};
        vkGetBufferMemoryRequirements(device, buffer, &needs);
        VkPhysicalDeviceMemoryProperties types{};
        vkGetPhysicalDeviceMemoryProperties(vulkan_->physical, &types);
        std::uint32_t type = 0;
        constexpr VkMemoryPropertyFlags mappable = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
        while ((needs.memoryTypeBits & (1u << type)) == 0 || (types.memoryTypes[type].propertyFlags & mappable) != mappable) ++type;
        const VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size, type};
        ASSERT_EQ(vkAllocateMemory(device, &allocate, nullptr, &memory), VK_SUCCESS);
        ASSERT_EQ(vkBindBufferMemory(device, buffer, memory, 0), VK_SUCCESS);
        void* mapped = nullptr;
        ASSERT_EQ(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, &mapped), VK_SUCCESS);
        std::memcpy(mapped, bytes.data(), bytes.size());
        copy(buffer, image, picture);
        vkDestroyBuffer(device, buffer, nullptr);
        vkFreeMemory(device, memory, nullptr);
    }
    void copy(VkBuffer buffer, VkImage image, const Picture& picture) {
        const VkDevice device = vulkan_->device;
        VkCommandPool pool = VK_NULL_HANDLE;
        VkCommandBuffer commands = VK_NULL_HANDLE;
        VkQueue queue = VK_NULL_HANDLE;
        vkGetDeviceQueue(device, 0, 0, &queue);
        const VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr, 0, 0};
        ASSERT_EQ(vkCreateCommandPool(device, &pool_info, nullptr, &pool), VK_SUCCESS);
        const VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool,
                                                   VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
        ASSERT_EQ(vkAllocateCommandBuffers(device, &allocate, &commands), VK_SUCCESS);
        const VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO, nullptr, 0, nullptr};
        vkBeginCommandBuffer(commands, &begin);
        const VkImageAspectFlags aspect = picture.format.depth ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
        const VkImageLayout attachment =
            picture.format.depth ? VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL : VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
        const auto barrier = [&](VkImageLayout from, VkImageLayout to) {
            const VkImageMemoryBarrier change{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                              nullptr,
                                              VK_ACCESS_MEMORY_WRITE_BIT,
                                              VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                                              from,
                                              to,
                                              VK_QUEUE_FAMILY_IGNORED,
                                              VK_QUEUE_FAMILY_IGNORED,
                                              image,
                                              {aspect, 0, 1, 0, VK_REMAINING_ARRAY_LAYERS}};
            vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, nullptr, 0,
                                 nullptr, 1, &change);
        };
        barrier(attachment, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
        const VkBufferImageCopy region{0,         0,
                                       0,         {aspect, 0, 0, static_cast<std::uint32_t>(picture.layers)},
                                       {0, 0, 0}, {static_cast<std::uint32_t>(picture.w), static_cast<std::uint32_t>(picture.h), 1}};
        vkCmdCopyBufferToImage(commands, buffer, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &region);
        barrier(VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, attachment);
        ASSERT_EQ(vkEndCommandBuffer(commands), VK_SUCCESS);
        const VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO, nullptr, 0, nullptr, nullptr, 1, &commands, 0, nullptr};
        ASSERT_EQ(vkQueueSubmit(queue, 1, &submit, VK_NULL_HANDLE), VK_SUCCESS);
        vkQueueWaitIdle(queue);
        vkDestroyCommandPool(device, pool, nullptr);
    }

    std::unique_ptr<VulkanApplication> vulkan_;
};

// OpenGL of either window system; the context is current all the time.
template <class Application> class OpenGlPainter final : public Painter {
public:
    OpenGlPainter(Application& application, std::vector<const char*> more_extensions, bool copied)
        : application_(application), extensions_(std::move(more_extensions)), copied_(copied) {
        extensions_.push_back("XR_KHR_opengl_enable");
        EXPECT_TRUE(application_.bind());
    }
    std::vector<const char*> extensions() const override { return extensions_; }
    void ask_requirements(Client& client) override {
        XrGraphicsRequirementsOpenGLKHR requirements{XR_TYPE_GRAPHICS_REQUIREMENTS_OPENGL_KHR};
        EXPECT_EQ(
            client.get<PFN_xrGetOpenGLGraphicsRequirementsKHR>("xrGetOpenGLGraphicsRequirementsKHR")(client.instance, 1, &requirements),
            XR_SUCCESS);
    }
    XrSession make_session(Client& client) override {
        const auto binding = application_.binding();
        return create(client, &binding);
    }
    std::int64_t format(const Format& format) const override { return format.sized; }
    bool bottom_up() const override { return true; }
    void paint(Client& client, XrSwapchain swapchain, std::uint32_t index, const Picture& picture) override {
        const auto found = image<XrSwapchainImageOpenGLKHR>(client, swapchain, XR_TYPE_SWAPCHAIN_IMAGE_OPENGL_KHR, index);
        const GLenum target = picture.cube ? GL_TEXTURE_CUBE_MAP : picture.layers > 1 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
        const auto bytes = bytes_of(picture, true);
        const Format& format = picture.format;
        glBindTexture(target, found.image);
        glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
        for (int face = 0; picture.cube && face < 6; ++face) {
            const std::size_t size = bytes.size() / 6;
            glTexSubImage2D(GL_TEXTURE_CUBE_MAP_POSITIVE_X + static_cast<GLenum>(face), 0, 0, 0, picture.w, picture.h, format.format,
                            format.type, bytes.data() + static_cast<std::size_t>(face) * size);
        }
        if (target == GL_TEXTURE_2D) glTexSubImage2D(target, 0, 0, 0, picture.w, picture.h, format.format, format.type, bytes.data());
        if (target == GL_TEXTURE_2D_ARRAY)
            glTexSubImage3D(target, 0, 0, 0, 0, picture.w, picture.h, picture.layers, format.format, format.type, bytes.data());
        EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR)) << format.sized;
    }
    std::size_t expected_errors() const override { return copied_ ? 1 : 0; }

private:
    Application& application_;
    std::vector<const char*> extensions_;
    const bool copied_;
};

// A client of the real compositor, for a few frames of one set of layers.
class Run {
public:
    Run(Painter& painter, const fs::path& folder, const std::string& preset, const std::string& panel = "72x80")
        : painter_(painter), folder_(folder) {
        fs::create_directories(folder);
        setenv("XDG_CONFIG_HOME", folder.c_str(), 1);
        setenv("XDG_RUNTIME_DIR", folder.c_str(), 1);
        const auto text = [](const fs::path& path) { return app::toml_string(path.string()); };
        const std::string overlay = folder / "overlay.toml";
        EXPECT_TRUE(app::write_overlay(overlay, {"",
                                                 folder.string(),
                                                 {{"panel", app::toml_string(panel)},
                                                  {"clock", "\"lockstep\""},
                                                  {"preset", app::toml_string(preset)},
                                                  {"report", text(folder / "report.json")},
                                                  {"dump.dir", text(folder / "dump")},
                                                  {"dump.stages", "[\"panel\"]"},
                                                  {"dump.every", "1"}}}));
        setenv("ENTOPTIC_CONFIG", overlay.c_str(), 1);
        auto extensions = painter.extensions();
        for (const char* more : {"XR_KHR_composition_layer_depth", "XR_KHR_composition_layer_cylinder",
                                 "XR_KHR_composition_layer_equirect2", "XR_KHR_composition_layer_cube"})
            extensions.push_back(more);
        client_ = std::make_unique<Client>(extensions, nullptr, XR_MAKE_VERSION(1, 0, 0), &app::make_host);
        painter.ask_requirements(*client_);
        session_ = painter.make_session(*client_);
        const XrReferenceSpaceCreateInfo space{
            XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, XR_REFERENCE_SPACE_TYPE_VIEW, {{0, 0, 0, 1}, {0, 0, 0}}};
        EXPECT_EQ(client_->xrCreateReferenceSpace(session_, &space, &space_), XR_SUCCESS);
    }

    XrSpace space() const { return space_; }
    XrSwapchain swapchain(const Picture& picture) {
        XrSwapchainCreateInfo info{XR_TYPE_SWAPCHAIN_CREATE_INFO};
        info.createFlags = XR_SWAPCHAIN_CREATE_STATIC_IMAGE_BIT;
        info.usageFlags =
            XR_SWAPCHAIN_USAGE_TRANSFER_DST_BIT | XR_SWAPCHAIN_USAGE_SAMPLED_BIT |
            (picture.format.depth ? XR_SWAPCHAIN_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT : XR_SWAPCHAIN_USAGE_COLOR_ATTACHMENT_BIT);
        info.format = painter_.format(picture.format);
        info.sampleCount = info.mipCount = 1;
        info.faceCount = picture.cube ? 6 : 1;
        info.arraySize = picture.cube ? 1 : static_cast<std::uint32_t>(picture.layers);
        info.width = static_cast<std::uint32_t>(picture.w);
        info.height = static_cast<std::uint32_t>(picture.h);
        XrSwapchain made = XR_NULL_HANDLE;
        EXPECT_EQ(client_->xrCreateSwapchain(session_, &info, &made), XR_SUCCESS) << info.format;
        std::uint32_t index = 0;
        EXPECT_EQ(client_->xrAcquireSwapchainImage(made, nullptr, &index), XR_SUCCESS);
        const XrSwapchainImageWaitInfo wait{XR_TYPE_SWAPCHAIN_IMAGE_WAIT_INFO, nullptr, XR_INFINITE_DURATION};
        EXPECT_EQ(client_->xrWaitSwapchainImage(made, &wait), XR_SUCCESS);
        painter_.paint(*client_, made, index, picture);
        EXPECT_EQ(client_->xrReleaseSwapchainImage(made, nullptr), XR_SUCCESS);
        return made;
    }
    // A part of a picture, counted from its top left.
    XrSwapchainSubImage part(XrSwapchain swapchain, const Picture& picture, std::uint32_t slice, XrRect2Di rect) const {
        if (painter_.bottom_up()) rect.offset.y = picture.h - rect.offset.y - rect.extent.height;
        return {swapchain, rect, slice};
    }
    std::array<XrView, 2> views(XrTime time) {
        std::array<XrView, 2> views{XrView{XR_TYPE_VIEW}, XrView{XR_TYPE_VIEW}};
        const XrViewLocateInfo info{XR_TYPE_VIEW_LOCATE_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO, time, space_};
        XrViewState state{XR_TYPE_VIEW_STATE};
        std::uint32_t count = 0;
        EXPECT_EQ(client_->xrLocateViews(session_, &info, &state, 2, &count, views.data()), XR_SUCCESS);
        return views;
    }
    // Shows `layers` for `frames` frames and ends the session.
    void show(int frames, const std::function<std::vector<const XrCompositionLayerBaseHeader*>(XrTime)>& layers) {
        const XrSessionBeginInfo begin{XR_TYPE_SESSION_BEGIN_INFO, nullptr, XR_VIEW_CONFIGURATION_TYPE_PRIMARY_STEREO};
        EXPECT_EQ(client_->xrBeginSession(session_, &begin), XR_SUCCESS);
        for (int i = 0; i < frames; ++i) {
            XrFrameState state{XR_TYPE_FRAME_STATE};
            EXPECT_EQ(client_->xrWaitFrame(session_, nullptr, &state), XR_SUCCESS);
            EXPECT_EQ(client_->xrBeginFrame(session_, nullptr), XR_SUCCESS);
            const auto now = layers(state.predictedDisplayTime);
            const XrFrameEndInfo end{XR_TYPE_FRAME_END_INFO,
                                     nullptr,
                                     state.predictedDisplayTime,
                                     XR_ENVIRONMENT_BLEND_MODE_OPAQUE,
                                     static_cast<std::uint32_t>(now.size()),
                                     now.data()};
            EXPECT_EQ(client_->xrEndFrame(session_, &end), XR_SUCCESS);
        }
        EXPECT_EQ(client_->xrDestroySession(session_), XR_SUCCESS);
        client_.reset();
        std::ifstream in(folder_ / "report.json");
        report = nlohmann::json::parse(in, nullptr, false);
        EXPECT_EQ(report.at("errors").size(), painter_.expected_errors()) << report.at("errors").dump();
    }
    // The panel at the last frame, both eyes.
    std::array<Image8, 2> panel() const {
        std::array<Image8, 2> pictures;
        std::array<std::string, 2> last;
        for (const auto& file : fs::directory_iterator(folder_ / "dump")) {
            const std::string path = file.path().string();
            for (std::size_t eye = 0; eye < 2; ++eye)
                if (path.ends_with(eye == 0 ? "_left_panel.png" : "_right_panel.png")) last[eye] = std::max(last[eye], path);
        }
        for (std::size_t eye = 0; eye < 2; ++eye) {
            auto read = read_png(last[eye]);
            EXPECT_TRUE(read) << last[eye];
            if (read) pictures[eye] = std::move(*read);
        }
        return pictures;
    }
    nlohmann::json report;

private:
    Painter& painter_;
    const fs::path folder_;
    std::unique_ptr<Client> client_;
    XrSession session_ = XR_NULL_HANDLE;
    XrSpace space_ = XR_NULL_HANDLE;
};

constexpr XrPosef at_origin{{0, 0, 0, 1}, {0, 0, 0}};

// Both eyes' views from slices of one image, each from another part of it.
struct Projection {
    Projection(Run& run, const Picture& picture, const Picture* depth_picture) : run_(run), picture_(picture) {
        swapchain_ = run.swapchain(picture);
        if (!depth_picture) return;
        const XrSwapchain depth = run.swapchain(*depth_picture);
        for (std::uint32_t eye = 0; eye < 2; ++eye) {
            depths_[eye] = {XR_TYPE_COMPOSITION_LAYER_DEPTH_INFO_KHR,
                            nullptr,
                            run.part(depth, *depth_picture, eye, {{3, 2}, {32, 24}}),
                            0,
                            1,
                            0.1f,
                            100};
            has_depth_ = true;
        }
    }
    const XrCompositionLayerBaseHeader* at(XrTime time) {
        const auto views = run_.views(time);
        for (std::uint32_t eye = 0; eye < 2; ++eye) {
            const XrRect2Di rect = eye == 0 ? XrRect2Di{{2, 5}, {35, 22}} : XrRect2Di{{4, 1}, {30, 27}};
            views_[eye] = {XR_TYPE_COMPOSITION_LAYER_PROJECTION_VIEW, has_depth_ ? &depths_[eye] : nullptr, views[eye].pose, views[eye].fov,
                           run_.part(swapchain_, picture_, eye, rect)};
        }
        layer_ = {XR_TYPE_COMPOSITION_LAYER_PROJECTION, nullptr, 0, run_.space(), 2, views_.data()};
        return reinterpret_cast<const XrCompositionLayerBaseHeader*>(&layer_);
    }

private:
    Run& run_;
    const Picture picture_;
    XrSwapchain swapchain_ = XR_NULL_HANDLE;
    std::array<XrCompositionLayerDepthInfoKHR, 2> depths_{};
    bool has_depth_ = false;
    std::array<XrCompositionLayerProjectionView, 2> views_{};
    XrCompositionLayerProjection layer_{};
};

struct Shown {
    std::array<Image8, 2> panel;
    nlohmann::json report;
};

// An ordinary application: the short way, code for code.
Shown show_ordinary(Painter& painter, const fs::path& folder) {
    Run run(painter, folder, "off");
    Projection projection(run, {srgb8, slices}, nullptr);
    run.show(2, [&](XrTime time) { return std::vector{projection.at(time)}; });
    return {run.panel(), run.report};
}

// Every other colour format on a quad, and every kind of layer.
Shown show_everything(Painter& painter, const fs::path& folder) {
    Run run(painter, folder, "off");
    const Picture cube_picture{srgb8, 6, true, 32, 32}, plain{srgb8};
    const XrSwapchain cube_chain = run.swapchain(cube_picture), plain_chain = run.swapchain(plain);
    const XrRect2Di rect{{3, 4}, {33, 21}};
    const XrCompositionLayerCubeKHR cube{
        XR_TYPE_COMPOSITION_LAYER_CUBE_KHR, nullptr, 0, run.space(), XR_EYE_VISIBILITY_BOTH, cube_chain, 0, {0, 0, 0, 1}};
    const XrCompositionLayerCylinderKHR cylinder{
        XR_TYPE_COMPOSITION_LAYER_CYLINDER_KHR, nullptr, 0,    run.space(), XR_EYE_VISIBILITY_BOTH, run.part(plain_chain, plain, 0, rect),
        {{0, 0, 0, 1}, {0, 0.5f, 0}},           2,       0.8f, 1.8f};
    const XrCompositionLayerEquirect2KHR sphere{XR_TYPE_COMPOSITION_LAYER_EQUIRECT2_KHR,
                                                nullptr,
                                                0,
                                                run.space(),
                                                XR_EYE_VISIBILITY_BOTH,
                                                run.part(plain_chain, plain, 0, rect),
                                                at_origin,
                                                0,
                                                0.9f,
                                                -0.2f,
                                                -0.7f};
    std::vector<XrCompositionLayerQuad> quads;
    for (std::size_t i = 0; i < std::size(other_colours); ++i) {
        const Picture picture{other_colours[i]};
        const XrSwapchain chain = run.swapchain(picture);
        quads.push_back({XR_TYPE_COMPOSITION_LAYER_QUAD,
                         nullptr,
                         0,
                         run.space(),
                         XR_EYE_VISIBILITY_BOTH,
                         run.part(chain, picture, 0, rect),
                         {{0, 0, 0, 1}, {-0.6f + 0.3f * static_cast<float>(i), 0.05f * static_cast<float>(i), -1}},
                         {0.28f, 0.4f}});
    }
    run.show(2, [&](XrTime) {
        std::vector<const XrCompositionLayerBaseHeader*> layers;
        for (const void* layer : {static_cast<const void*>(&cube), static_cast<const void*>(&cylinder), static_cast<const void*>(&sphere)})
            layers.push_back(static_cast<const XrCompositionLayerBaseHeader*>(layer));
        for (const auto& quad : quads) layers.push_back(reinterpret_cast<const XrCompositionLayerBaseHeader*>(&quad));
        return layers;
    });
    return {run.panel(), run.report};
}

// Depth of field: blur that follows the depth; on a panel where a degree of blur is some pixels.
Shown show_depth(Painter& painter, const fs::path& folder, const Format& format) {
    Run run(painter, folder, "liu2021", "360x400");
    const Picture depth{format, slices};
    Projection projection(run, {srgb8, slices}, &depth);
    run.show(2, [&](XrTime time) { return std::vector{projection.at(time)}; });
    return {run.panel(), run.report};
}

// Where a position falls on the middle between two steps of 1/256 texel, a picture that is turned over may take the other one.
void expect_same(const Shown& found, const Shown& expected, const std::string& what, int steps = 0) {
    for (std::size_t eye = 0; eye < 2; ++eye) {
        const Image8 &a = found.panel[eye], &b = expected.panel[eye];
        ASSERT_EQ(a.data.size(), b.data.size()) << what;
        std::size_t wrong = 0, lit = 0;
        int largest = 0;
        for (std::size_t i = 0; i < a.data.size(); ++i) {
            wrong += a.data[i] != b.data[i] ? 1 : 0;
            largest = std::max(largest, std::abs(int(a.data[i]) - int(b.data[i])));
            lit += b.data[i] > 0 ? 1 : 0;
        }
        EXPECT_LE(largest, steps) << what;
        EXPECT_LE(wrong, steps == 0 ? 0 : a.data.size() / 10'000)
            << what << ": code values of eye " << eye << " that differ, of " << a.data.size();
        EXPECT_GT(lit, a.data.size() / 4) << what << ": a dark picture proves nothing";
    }
}

bool same(const Shown& a, const Shown& b) { return a.panel[0].data == b.panel[0].data && a.panel[1].data == b.panel[1].data; }

class OpenGlPictures : public ::testing::Test {
protected:
    ~OpenGlPictures() override { fs::remove_all(folder_); }
    fs::path folder(const std::string& name) const { return folder_ / name; }
    void compare_all(Painter& painter, const std::string& name, std::initializer_list<Format> depths) {
        VulkanPainter vulkan;
        expect_same(show_ordinary(painter, folder(name + "1")), show_ordinary(vulkan, folder("vulkan1")), name + ", projection");
        expect_same(show_everything(painter, folder(name + "2")), show_everything(vulkan, folder("vulkan2")), name + ", all layers");
        for (const Format& format : depths) {
            const std::string number = std::to_string(format.vk);
            const Shown deep = show_depth(vulkan, folder("vulkan" + number), format);
            expect_same(show_depth(painter, folder(name + number), format), deep, name + ", depth", 2);
        }
    }

private:
    const fs::path folder_ = fs::temp_directory_path() / ("entoptic_opengl_pictures_" + std::to_string(getpid()));
};

TEST_F(OpenGlPictures, OnSharedMemoryAreThoseOfVulkan) {
    const entoptic::testing::VirtualServer server;
    ASSERT_NE(server.display(), "") << "install the package xvfb";
    GlxApplication application(server.display());
    ASSERT_NE(application.context, nullptr) << "install the package libgl1-mesa-dri";
    OpenGlPainter painter(application, {}, false);
    compare_all(painter, "shared", {depth32, depth16});
}

// Mesa takes away what it is told to, once for a process: in one of its own.
TEST_F(OpenGlPictures, ThatTheCpuCopiesAreThoseOfVulkanAndTold) {
    if (!std::getenv("MESA_EXTENSION_OVERRIDE")) {
        const std::string self = fs::read_symlink("/proc/self/exe"), name = "OpenGlPictures.ThatTheCpuCopiesAreThoseOfVulkanAndTold";
        const std::string call = "MESA_EXTENSION_OVERRIDE=-GL_EXT_memory_object_fd '" + self + "' --gtest_filter=" + name;
        EXPECT_EQ(std::system(call.c_str()), 0);
        return;
    }
    const entoptic::testing::VirtualServer server;
    ASSERT_NE(server.display(), "") << "install the package xvfb";
    GlxApplication application(server.display());
    ASSERT_NE(application.context, nullptr);
    OpenGlPainter painter(application, {}, true);
    compare_all(painter, "copied", {depth32});
    const Shown shown = show_ordinary(painter, folder("told"));
    EXPECT_NE(shown.report["errors"].dump().find("GL_EXT_memory_object_fd"), std::string::npos) << shown.report["errors"];
    EXPECT_EQ(shown.report["timing_ms"]["copy"]["cpu"]["samples"], 1) << shown.report["timing_ms"];
}

TEST_F(OpenGlPictures, OfEglAreThoseOfVulkan) {
    EglApplication application;
    ASSERT_NE(application.context, nullptr) << "install the package libegl-mesa0";
    OpenGlPainter painter(application, {"XR_MNDX_egl_enable"}, false);
    VulkanPainter vulkan;
    expect_same(show_ordinary(painter, folder("egl")), show_ordinary(vulkan, folder("vulkan")), "EGL");
}

// The comparison sees what it is there for: rows the wrong way round, of the picture and of its depth.
TEST_F(OpenGlPictures, APictureTurnedOverIsAnother) {
    VulkanPainter vulkan, colour, depth;
    colour.turn_colour = true;
    depth.turn_depth = true;
    EXPECT_FALSE(same(show_ordinary(colour, folder("turned")), show_ordinary(vulkan, folder("vulkan"))));
    EXPECT_FALSE(same(show_depth(depth, folder("turned_depth"), depth32), show_depth(vulkan, folder("vulkan_depth"), depth32)));
}

}  // namespace
}  // namespace entoptic::runtime::testing
