#include "runtime/graphics/opengl_copies.h"

#include "base/log.h"
#include "runtime/graphics/copy_device.h"
#include "runtime/graphics/vulkan_import.h"

#include <mutex>

namespace entoptic::runtime::graphics {

namespace {

// glGetTexImage writes rows without gaps to the CPU's memory while this lives; the application's own choices come back after.
class PlainPacking {
public:
    explicit PlainPacking(const OpenGlDispatch& gl) : gl_(gl), buffer_(static_cast<GLuint>(gl.integer(GL_PIXEL_PACK_BUFFER_BINDING))) {
        for (std::size_t i = 0; i < names.size(); ++i) {
            before_[i] = gl_.integer(names[i]);
            gl_.PixelStorei(names[i], names[i] == GL_PACK_ALIGNMENT ? 1 : 0);
        }
        gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, 0);
    }
    ~PlainPacking() {
        for (std::size_t i = 0; i < names.size(); ++i) gl_.PixelStorei(names[i], before_[i]);
        gl_.BindBuffer(GL_PIXEL_PACK_BUFFER, buffer_);
    }
    PlainPacking(const PlainPacking&) = delete;
    PlainPacking& operator=(const PlainPacking&) = delete;

private:
    static constexpr std::array<GLenum, 8> names{GL_PACK_ALIGNMENT, GL_PACK_ROW_LENGTH,  GL_PACK_IMAGE_HEIGHT, GL_PACK_SKIP_PIXELS,
                                                 GL_PACK_SKIP_ROWS, GL_PACK_SKIP_IMAGES, GL_PACK_SWAP_BYTES,   GL_PACK_LSB_FIRST};
    const OpenGlDispatch& gl_;
    const GLuint buffer_;
    std::array<GLint, names.size()> before_{};
};

class OpenGlCopies final : public SwapchainImages {
public:
    OpenGlCopies(std::shared_ptr<OpenGlShared> shared, const ImageMemory& description, const OpenGlFormat& format)
        : shared_(std::move(shared)), description_(description), format_(format), kind_(texture_kind(description)) {}

    ~OpenGlCopies() override {
        if (textures_.empty()) return;
        const CurrentContext current(*shared_->context);
        if (current.outcome().failed()) {
            log::warn("textures of a swapchain stay with the OpenGL context: it cannot be made current here");
            return;
        }
        shared_->gl.DeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
        shared_->gl.clear_errors();
    }

    Outcome import(std::vector<ImageMemory>& memories) {
        if (!shared_->copier) ENTOPTIC_XR_TRY(CopyDevice::create(description_.device_uuid, shared_->copier));
        const CurrentContext current(*shared_->context);
        ENTOPTIC_XR_TRY(current.outcome());
        shared_->gl.clear_errors();
        for (ImageMemory& memory : memories) {
            auto copy = std::make_unique<Copy>(shared_->copier, memory, format_);
            ENTOPTIC_XR_TRY(copy->image.import(memory));
            copies_.push_back(std::move(copy));
            ENTOPTIC_XR_TRY(make_texture());
        }
        return XR_SUCCESS;
    }

    std::uint32_t count() const override { return static_cast<std::uint32_t>(textures_.size()); }
    Outcome enumerate(XrSwapchainImageBaseHeader* images) const override { return enumerate_textures(textures_, images); }
    Outcome acquire(std::uint32_t) override { return XR_SUCCESS; }

    Outcome release(std::uint32_t index) override {
        Copy& copy = *copies_[index];
        const std::lock_guard lock(copy.mutex);
        const TimeNs started = shared_->host->stopwatch().now();
        ENTOPTIC_XR_TRY(copy.image.wait());
        {
            const CurrentContext current(*shared_->context);
            ENTOPTIC_XR_TRY(current.outcome());
            ENTOPTIC_XR_TRY(read(textures_[index], copy.image));
        }
        ENTOPTIC_XR_TRY(copy.image.send());
        copy.spent += shared_->host->stopwatch().now() - started;
        return XR_SUCCESS;
    }

    Outcome wait_released(std::uint32_t index) override {
        Copy& copy = *copies_[index];
        const std::lock_guard lock(copy.mutex);
        if (!copy.image.pending()) return XR_SUCCESS;
        const TimeNs started = shared_->host->stopwatch().now();
        ENTOPTIC_XR_TRY(copy.image.wait());
        copy.spent += shared_->host->stopwatch().now() - started;
        shared_->host->frames().add_cpu_time("copy", seconds(copy.spent) * 1e3);
        copy.spent = 0;
        return XR_SUCCESS;
    }

private:
    struct Copy {
        Copy(std::shared_ptr<CopyDevice> device, const ImageMemory& memory, const OpenGlFormat& format)
            : image(std::move(device), memory, format.texel_bytes, format.copied) {}
        std::mutex mutex;
        CopiedImage image;
        DurationNs spent = 0;  // since it was reported last
    };

    Outcome make_texture() {
        const OpenGlDispatch& gl = shared_->gl;
        GLuint texture = 0;
        gl.GenTextures(1, &texture);
        textures_.push_back(texture);
        const BoundTexture bound(gl, kind_, texture);
        const auto width = static_cast<GLsizei>(description_.width), height = static_cast<GLsizei>(description_.height);
        const auto levels = static_cast<GLsizei>(description_.mip_levels);
        if (kind_.layered)
            gl.TexStorage3D(kind_.target, levels, format_.sized, width, height, kind_.layers);
        else
            gl.TexStorage2D(kind_.target, levels, format_.sized, width, height);
        return gl.check("glTexStorage of a swapchain's texture");
    }

    Outcome read(GLuint texture, const CopiedImage& into) const {
        const OpenGlDispatch& gl = shared_->gl;
        gl.clear_errors();
        const BoundTexture bound(gl, kind_, texture);
        ENTOPTIC_XR_TRY(check_size());
        const PlainPacking packing(gl);
        for (std::uint32_t level = 0; level < description_.mip_levels; ++level) {
            const std::span<std::byte> bytes = into.level(level);
            const std::size_t face_bytes = bytes.size() / static_cast<std::size_t>(kind_.read_faces);
            for (GLsizei face = 0; face < kind_.read_faces; ++face) {
                const GLenum from = kind_.read_faces == 1 ? kind_.target : GL_TEXTURE_CUBE_MAP_POSITIVE_X + static_cast<GLenum>(face);
                gl.GetTexImage(from, static_cast<GLint>(level), format_.read_format, format_.read_type,
                               bytes.data() + face_bytes * static_cast<std::size_t>(face));
            }
        }
        return gl.check("glGetTexImage of a released image");
    }

    // An application may delete our texture and make another of its name.
    Outcome check_size() const {
        const GLenum target = kind_.read_faces == 1 ? kind_.target : static_cast<GLenum>(GL_TEXTURE_CUBE_MAP_POSITIVE_X);
        const auto has = [&](GLenum name, std::uint32_t wanted) {
            GLint found = 0;
            shared_->gl.GetTexLevelParameteriv(target, 0, name, &found);
            return found == static_cast<GLint>(wanted);
        };
        const bool same = has(GL_TEXTURE_WIDTH, description_.width) && has(GL_TEXTURE_HEIGHT, description_.height) &&
                          has(GL_TEXTURE_INTERNAL_FORMAT, format_.sized) &&
                          (!kind_.layered || has(GL_TEXTURE_DEPTH, description_.array_layers));
        return same ? Outcome() : invalid("the released image's texture is not the swapchain's any more; applications must not delete it");
    }

    const std::shared_ptr<OpenGlShared> shared_;
    const ImageMemory description_;
    const OpenGlFormat format_;
    const TextureKind kind_;
    std::vector<GLuint> textures_;
    std::vector<std::unique_ptr<Copy>> copies_;
};

}  // namespace

Outcome make_opengl_copies(std::shared_ptr<OpenGlShared> shared, std::vector<ImageMemory> memories,
                           std::unique_ptr<SwapchainImages>& images) {
    const Descriptors descriptors{memories};
    const OpenGlFormat* format = memories.empty() ? nullptr : opengl_format_of(static_cast<VkFormat>(memories.front().vk_format));
    if (!format || format->texel_bytes == 0) return error(XR_ERROR_RUNTIME_FAILURE, "the compositor gave no image that can be copied");
    const ImageMemory description = memories.front();
    auto made = std::make_unique<OpenGlCopies>(std::move(shared), description, *format);
    ENTOPTIC_XR_TRY(made->import(memories));
    images = std::move(made);
    return XR_SUCCESS;
}

}  // namespace entoptic::runtime::graphics
