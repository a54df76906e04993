// The Vive Pro's panel that the tests' kernel emulates (vkms with vive_panel_edid.py's EDID), seen from beside: what it scans out, and a
// display server that leases it.
#pragma once

#include "compositor/targets/kms/panel.h"
#include "drivers/display/edid.h"

#include <cstddef>
#include <cstdint>
#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>
#include <vector>
#include <xf86drm.h>
#include <xf86drmMode.h>

namespace entoptic::devices {

constexpr const char* card_node = "/dev/dri/card0";

inline compositor::kms::PanelWish panel_wish() {
    compositor::kms::PanelWish w;
    w.refresh_hz = 90.04;
    w.headset_of_edid = [](std::span<const std::uint8_t> bytes) -> std::string {
        const auto edid = drivers::parse_edid(bytes);
        const char* headset = edid ? drivers::headset_of_edid(*edid) : nullptr;
        return headset ? headset : "";
    };
    return w;
}

inline bool is_lit(int fd) {
    bool any = false;
    drmModeRes* resources = drmModeGetResources(fd);
    for (int i = 0; resources && i < resources->count_crtcs; ++i) {
        drmModeCrtc* crtc = drmModeGetCrtc(fd, resources->crtcs[i]);
        any = any || (crtc && crtc->buffer_id);
        drmModeFreeCrtc(crtc);
    }
    drmModeFreeResources(resources);
    return any;
}

// What the card scans out now, by the kernel's own account: the framebuffer of the lit CRTC, mapped through another descriptor.
inline std::vector<std::uint32_t> scanned_out(int fd) {
    std::vector<std::uint32_t> pixels;
    drmModeRes* resources = drmModeGetResources(fd);
    for (int i = 0; resources && i < resources->count_crtcs; ++i) {
        drmModeCrtc* crtc = drmModeGetCrtc(fd, resources->crtcs[i]);
        drmModeFB* buffer = crtc && crtc->buffer_id ? drmModeGetFB(fd, crtc->buffer_id) : nullptr;
        std::uint64_t offset = 0;
        if (buffer && drmModeMapDumbBuffer(fd, buffer->handle, &offset) == 0) {
            const std::size_t size = std::size_t(buffer->pitch) * buffer->height;
            void* mapped = mmap(nullptr, size, PROT_READ, MAP_SHARED, fd, static_cast<off_t>(offset));
            for (std::uint32_t y = 0; mapped != MAP_FAILED && y < buffer->height; ++y) {
                const auto* row =
                    reinterpret_cast<const std::uint32_t*>(static_cast<const std::byte*>(mapped) + std::size_t(y) * buffer->pitch);
                pixels.insert(pixels.end(), row, row + buffer->width);
            }
            if (mapped != MAP_FAILED) munmap(mapped, size);
        }
        if (buffer) drmCloseBufferHandle(fd, buffer->handle);
        drmModeFreeFB(buffer);
        drmModeFreeCrtc(crtc);
    }
    drmModeFreeResources(resources);
    return pixels;
}

// A display server's part: it is the card's master, and leases connector, CRTC and plane.
class Lessor {
public:
    Lessor() : fd_(open(card_node, O_RDWR | O_CLOEXEC)) {
        drmSetClientCap(fd_, DRM_CLIENT_CAP_UNIVERSAL_PLANES, 1);
        drmModeRes* resources = drmModeGetResources(fd_);
        drmModePlaneRes* planes = drmModeGetPlaneResources(fd_);
        if (resources && planes && resources->count_connectors && resources->count_crtcs && planes->count_planes)
            objects_ = {resources->connectors[0], resources->crtcs[0], planes->planes[0]};
        if (!objects_.empty()) drmModeFreeConnector(drmModeGetConnector(fd_, objects_[0]));  // only the master's question reaches the cable
        drmModeFreePlaneResources(planes);
        drmModeFreeResources(resources);
    }
    ~Lessor() { close(fd_); }
    // The lease's descriptor, which the caller owns; negative: none.
    int lease() { return drmModeCreateLease(fd_, objects_.data(), static_cast<int>(objects_.size()), O_CLOEXEC, &id_); }
    std::uint32_t connector() const { return objects_.empty() ? 0 : objects_[0]; }
    void revoke() { drmModeRevokeLease(fd_, id_); }

private:
    int fd_;
    std::uint32_t id_ = 0;
    std::vector<std::uint32_t> objects_;
};

}  // namespace entoptic::devices
