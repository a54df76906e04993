#include "compositor/targets/kms/scanout.h"

#include "base/log.h"
#include "compositor/targets/kms/scanout.comp.h"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <unistd.h>
#include <utility>

namespace entoptic::compositor::kms {
namespace {

constexpr std::uint32_t pitch_alignment = 256;  // bytes: what cards of AMD want of linear rows; Intel's and others' want less
constexpr std::uint32_t group_width = 64;       // scanout.comp

struct Push {
    std::uint32_t width, height, pitch;
};

}  // namespace

Result<ScanoutBuffer> ScanoutBuffer::create(gpu::Device& device, DrmCard& card, PictureSize eye, ScanoutPath first) {
    ScanoutBuffer buffer;
    buffer.card_ = &card;
    if (first == ScanoutPath::shared && buffer.share(device, eye)) return buffer;
    if (const int error = card.create_framebuffer(eye_count * eye.width, eye.height, buffer.framebuffer_); error != 0)
        return failure(fmt::format("{} gives no memory for pictures of {}x{} pixels: {}.", card.name(), eye_count * eye.width, eye.height,
                                   strerror(error)));
    if (first != ScanoutPath::copied && buffer.import(device)) return buffer;
    ENTOPTIC_CHECK(buffer.make_copy(device));
    return buffer;
}

bool ScanoutBuffer::share(gpu::Device& device, PictureSize eye) {
    const std::uint32_t row = eye_count * eye.width * 4, row_pitch = (row + pitch_alignment - 1) / pitch_alignment * pitch_alignment;
    int dma_buf = -1;
    auto made = gpu::ExternalBuffer::create_shared(device, std::size_t(row_pitch) * eye.height, "panel", dma_buf);
    if (!made) {
        log::debug("{}", made.error().message);
        return false;
    }
    const int error = card_->import_framebuffer(dma_buf, eye_count * eye.width, eye.height, row_pitch, framebuffer_);
    close(dma_buf);
    if (error != 0) {
        log::debug("{} does not scan out memory of {}: {}", card_->name(), device.name(), strerror(error));
        return false;
    }
    pixels_ = std::move(*made);
    path_ = ScanoutPath::shared;
    return true;
}

bool ScanoutBuffer::import(gpu::Device& device) {
    auto made = gpu::ExternalBuffer::over_host_memory(device, framebuffer_.bytes, "panel");
    if (!made) {
        log::debug("{}", made.error().message);
        return false;
    }
    pixels_ = std::move(*made);
    path_ = ScanoutPath::imported;
    return true;
}

Result<void> ScanoutBuffer::make_copy(gpu::Device& device) {
    ENTOPTIC_TRY(made, gpu::Buffer::create(device, framebuffer_.bytes.size(), gpu::BufferKind::readback, "panel"));
    copy_ = std::move(made);
    path_ = ScanoutPath::copied;
    return {};
}

ScanoutBuffer::~ScanoutBuffer() {
    pixels_ = {};  // before the memory under it
    if (card_) card_->destroy(framebuffer_);
}

ScanoutBuffer& ScanoutBuffer::operator=(ScanoutBuffer&& other) noexcept {
    std::swap(card_, other.card_);
    std::swap(framebuffer_, other.framebuffer_);
    std::swap(pixels_, other.pixels_);
    std::swap(copy_, other.copy_);
    std::swap(path_, other.path_);
    return *this;
}

gpu::Binding ScanoutBuffer::pixels() const { return copy_ ? gpu::Binding(copy_) : pixels_.binding(); }

void ScanoutBuffer::finish() {
    if (path_ == ScanoutPath::copied) std::memcpy(framebuffer_.bytes.data(), copy_.bytes().data(), framebuffer_.bytes.size());
}

Result<ScanoutPass> ScanoutPass::create(const gpu::Device& device) {
    ScanoutPass pass;
    gpu::KernelInfo info;
    info.name = "scanout";
    info.spirv = scanout_comp_spv;
    info.bindings.assign(2, gpu::BindingKind::storage_buffer);
    info.push_constant_bytes = sizeof(Push);
    ENTOPTIC_TRY(kernel, gpu::Kernel::create(device, info));
    pass.kernel_ = std::move(kernel);
    return pass;
}

void ScanoutPass::record(gpu::Commands& commands, const gpu::Buffer& codes, PictureSize eye, const ScanoutBuffer& into) const {
    commands.dispatch(kernel_, {codes, into.pixels()}, Push{eye.width, eye.height, into.pitch() / 4},
                      {gpu::groups_for(eye.width, group_width), eye.height, eye_count});
    VkMemoryBarrier read{VK_STRUCTURE_TYPE_MEMORY_BARRIER};  // by the CPU, or by a card that reads the CPU's memory
    read.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT;
    read.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    vkCmdPipelineBarrier(commands.handle(), VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &read, 0, nullptr, 0,
                         nullptr);
}

}  // namespace entoptic::compositor::kms
