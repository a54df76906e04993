// What the panel's target asks of the kernel's display driver (DRM/KMS): one graphics card, held as its master or by a lease. The seam at
// which tests put a card that misbehaves. Calls that return int return 0 or an errno value; nothing here decides or explains.
#pragma once

#include "base/result.h"
#include "base/time.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>
#include <xf86drmMode.h>

namespace entoptic::compositor::kms {

// A socket of the card, and what is plugged into it.
struct Connector {
    std::uint32_t id = 0;
    std::string name;  // "DP-1"
    bool connected = false;
    bool non_desktop = false;            // the kernel knows it for a headset: desktops leave it alone
    bool link_bad = false;               // the cable's link failed after it was set up: the mode must be set again
    std::vector<std::uint8_t> edid;      // empty: none was read
    std::vector<drmModeModeInfo> modes;  // the driver's order, preferred ones marked
    std::vector<std::uint32_t> crtcs;    // that can drive it
    std::uint32_t crtc = 0;              // that drives it now; 0: dark
};

// Memory that the card can scan out: XRGB8888, rows `pitch` bytes apart.
struct Framebuffer {
    std::uint32_t id = 0;  // 0: none
    std::uint32_t handle = 0;
    std::uint32_t pitch = 0;
    std::span<std::byte> bytes;  // mapped for the CPU; empty where the memory is somebody else's
};

// A refresh: the moment at which its first line leaves, CLOCK_MONOTONIC. Sequences count refreshes and wrap at 2^32.
struct Vblank {
    std::uint32_t sequence = 0;
    TimeNs time = 0;
};

class DrmCard {
public:
    virtual ~DrmCard() = default;
    virtual std::string name() const = 0;  // "card0 (amdgpu)", for people

    // With `probe` the driver asks the cables anew (tens of ms); without, what the kernel knows.
    virtual int connectors(bool probe, std::vector<Connector>& out) = 0;
    // Whether the kernel told of a change of displays since the last call. Never blocks.
    virtual bool changed() = 0;

    virtual int create_framebuffer(std::uint32_t width, std::uint32_t height, Framebuffer& out) = 0;
    // Over the memory of `dma_buf`, which stays the caller's.
    virtual int import_framebuffer(int dma_buf, std::uint32_t width, std::uint32_t height, std::uint32_t pitch, Framebuffer& out) = 0;
    virtual void destroy(Framebuffer& framebuffer) = 0;

    // Lights the connector in this mode, at once.
    virtual int set_mode(std::uint32_t crtc, std::uint32_t connector, const drmModeModeInfo& mode, std::uint32_t framebuffer) = 0;
    virtual void turn_off(std::uint32_t crtc) = 0;
    // From the next refresh on `framebuffer` is shown. EBUSY: the flip before has not happened yet.
    virtual int flip(std::uint32_t crtc, std::uint32_t framebuffer) = 0;
    // Waits for the refresh of the last flip. ETIMEDOUT: it did not come in `patience`; ENODEV: the card is gone.
    virtual int wait_flip(DurationNs patience, Vblank& out) = 0;
    // The newest refresh. EOPNOTSUPP and others: the driver does not count them.
    virtual int last_vblank(std::uint32_t crtc, Vblank& out) = 0;

    // Takes the right to set modes, where the card was not opened by a lease. EACCES: another program has it.
    virtual int become_master() = 0;
};

// The card that `fd` is open on; takes the descriptor over, and lets `keep` go after it. Errors: it is no card, or stamps refreshes by
// another clock.
Result<std::unique_ptr<DrmCard>> card_of(int fd, std::string name, std::shared_ptr<void> keep = nullptr);

// /dev/dri/cardN in order. Cards that cannot be opened are left out; `problem` says why, empty when well.
std::vector<std::unique_ptr<DrmCard>> open_cards(std::string& problem);

}  // namespace entoptic::compositor::kms
