#include "compositor/targets/kms/drm_card.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <drm_fourcc.h>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <libudev.h>
#include <poll.h>
#include <sys/mman.h>
#include <unistd.h>
#include <utility>
#include <xf86drm.h>

namespace entoptic::compositor::kms {
namespace {

template <auto release> struct Freed {
    template <class T> void operator()(T* pointer) const { release(pointer); }
};
using Resources = std::unique_ptr<drmModeRes, Freed<drmModeFreeResources>>;
using ConnectorInfo = std::unique_ptr<drmModeConnector, Freed<drmModeFreeConnector>>;
using Encoder = std::unique_ptr<drmModeEncoder, Freed<drmModeFreeEncoder>>;
using Properties = std::unique_ptr<drmModeObjectProperties, Freed<drmModeFreeObjectProperties>>;
using Property = std::unique_ptr<drmModePropertyRes, Freed<drmModeFreeProperty>>;
using Blob = std::unique_ptr<drmModePropertyBlobRes, Freed<drmModeFreePropertyBlob>>;
using Version = std::unique_ptr<drmVersion, Freed<drmFreeVersion>>;

int last_error() { return errno != 0 ? errno : EIO; }

// Tells when the kernel's list of displays changes. The kernel's own messages: no udev daemon is needed.
class HotplugMonitor {
public:
    HotplugMonitor() {
        udev_ = udev_new();
        if (udev_) monitor_ = udev_monitor_new_from_netlink(udev_, "kernel");
        if (!monitor_) return;
        udev_monitor_filter_add_match_subsystem_devtype(monitor_, "drm", nullptr);
        udev_monitor_enable_receiving(monitor_);
    }
    ~HotplugMonitor() {
        if (monitor_) udev_monitor_unref(monitor_);
        if (udev_) udev_unref(udev_);
    }
    HotplugMonitor(const HotplugMonitor&) = delete;
    HotplugMonitor& operator=(const HotplugMonitor&) = delete;
    bool drain() {
        bool any = false;
        while (monitor_) {
            udev_device* event = udev_monitor_receive_device(monitor_);
            if (!event) break;
            udev_device_unref(event);
            any = true;
        }
        return any;
    }

private:
    udev* udev_ = nullptr;
    udev_monitor* monitor_ = nullptr;
};

class KernelCard final : public DrmCard {
public:
    KernelCard(int fd, std::string name, std::shared_ptr<void> keep) : keep_(std::move(keep)), fd_(fd), name_(std::move(name)) {}
    ~KernelCard() override { close(fd_); }
    KernelCard(const KernelCard&) = delete;
    KernelCard& operator=(const KernelCard&) = delete;

    std::string name() const override { return name_; }
    int connectors(bool probe, std::vector<Connector>& out) override;
    bool changed() override { return hotplug_.drain(); }
    int create_framebuffer(std::uint32_t width, std::uint32_t height, Framebuffer& out) override;
    int import_framebuffer(int dma_buf, std::uint32_t width, std::uint32_t height, std::uint32_t pitch, Framebuffer& out) override;
    void destroy(Framebuffer& framebuffer) override;
    int set_mode(std::uint32_t crtc, std::uint32_t connector, const drmModeModeInfo& mode, std::uint32_t framebuffer) override;
    void turn_off(std::uint32_t crtc) override { drmModeSetCrtc(fd_, crtc, 0, 0, 0, nullptr, 0, nullptr); }
    int flip(std::uint32_t crtc, std::uint32_t framebuffer) override;
    int wait_flip(DurationNs patience, Vblank& out) override;
    int last_vblank(std::uint32_t crtc, Vblank& out) override;
    int become_master() override;

private:
    Connector describe(const drmModeRes& resources, const drmModeConnector& info) const;
    void read_properties(Connector& connector) const;
    int add_framebuffer(std::uint32_t width, std::uint32_t height, Framebuffer& framebuffer) const;
    static void on_flip(int fd, unsigned sequence, unsigned seconds, unsigned microseconds, unsigned crtc, void* data);

    std::shared_ptr<void> keep_;  // what the descriptor hangs on
    int fd_;
    std::string name_;
    HotplugMonitor hotplug_;
};

void KernelCard::read_properties(Connector& connector) const {
    const Properties list(drmModeObjectGetProperties(fd_, connector.id, DRM_MODE_OBJECT_CONNECTOR));
    for (std::uint32_t i = 0; list && i < list->count_props; ++i) {
        const Property property(drmModeGetProperty(fd_, list->props[i]));
        if (!property) continue;
        const std::string_view property_name(property->name, strnlen(property->name, DRM_PROP_NAME_LEN));
        const std::uint64_t value = list->prop_values[i];
        if (property_name == "non-desktop") connector.non_desktop = value != 0;
        if (property_name == "link-status") connector.link_bad = value == DRM_MODE_LINK_STATUS_BAD;
        if (property_name != "EDID" || value == 0) continue;
        const Blob blob(drmModeGetPropertyBlob(fd_, static_cast<std::uint32_t>(value)));
        if (!blob) continue;
        const auto* bytes = static_cast<const std::uint8_t*>(blob->data);
        connector.edid.assign(bytes, bytes + blob->length);
    }
}

Connector KernelCard::describe(const drmModeRes& resources, const drmModeConnector& info) const {
    Connector out;
    out.id = info.connector_id;
    const char* type = drmModeGetConnectorTypeName(info.connector_type);
    out.name = fmt::format("{}-{}", type ? type : "Unknown", info.connector_type_id);
    out.connected = info.connection == DRM_MODE_CONNECTED;
    out.modes.assign(info.modes, info.modes + info.count_modes);
    std::uint32_t possible = 0;
    for (int i = 0; i < info.count_encoders; ++i) {
        const Encoder encoder(drmModeGetEncoder(fd_, info.encoders[i]));
        if (!encoder) continue;
        possible |= encoder->possible_crtcs;
        if (encoder->encoder_id == info.encoder_id) out.crtc = encoder->crtc_id;
    }
    for (int i = 0; i < std::min(resources.count_crtcs, 32); ++i)
        if (possible >> i & 1u) out.crtcs.push_back(resources.crtcs[i]);
    read_properties(out);
    return out;
}

int KernelCard::connectors(bool probe, std::vector<Connector>& out) {
    out.clear();
    const Resources resources(drmModeGetResources(fd_));
    if (!resources) return last_error();
    for (int i = 0; i < resources->count_connectors; ++i) {
        const std::uint32_t id = resources->connectors[i];
        const ConnectorInfo info(probe ? drmModeGetConnector(fd_, id) : drmModeGetConnectorCurrent(fd_, id));
        if (info) out.push_back(describe(*resources, *info));  // else it went between two calls
    }
    return 0;
}

int KernelCard::add_framebuffer(std::uint32_t width, std::uint32_t height, Framebuffer& framebuffer) const {
    const std::uint32_t handles[4]{framebuffer.handle}, pitches[4]{framebuffer.pitch}, offsets[4]{};
    const std::uint64_t modifiers[4]{DRM_FORMAT_MOD_LINEAR};
    std::uint64_t takes_modifiers = 0;
    if (drmGetCap(fd_, DRM_CAP_ADDFB2_MODIFIERS, &takes_modifiers) != 0) takes_modifiers = 0;
    if (takes_modifiers && drmModeAddFB2WithModifiers(fd_, width, height, DRM_FORMAT_XRGB8888, handles, pitches, offsets, modifiers,
                                                      &framebuffer.id, DRM_MODE_FB_MODIFIERS) == 0)
        return 0;
    return drmModeAddFB2(fd_, width, height, DRM_FORMAT_XRGB8888, handles, pitches, offsets, &framebuffer.id, 0) == 0 ? 0 : last_error();
}

int KernelCard::create_framebuffer(std::uint32_t width, std::uint32_t height, Framebuffer& out) {
    out = {};
    std::uint64_t size = 0, offset = 0;
    if (drmModeCreateDumbBuffer(fd_, width, height, 32, 0, &out.handle, &out.pitch, &size) != 0) return last_error();
    int error = 0;
    if (size < std::uint64_t(out.pitch) * height || out.pitch < std::uint64_t(width) * 4 || out.pitch % 4 != 0) error = EPROTO;
    if (error == 0) error = add_framebuffer(width, height, out);
    if (error == 0 && drmModeMapDumbBuffer(fd_, out.handle, &offset) != 0) error = last_error();
    if (error == 0) {
        void* mapped = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd_, static_cast<off_t>(offset));
        if (mapped == MAP_FAILED)
            error = last_error();
        else
            out.bytes = {static_cast<std::byte*>(mapped), static_cast<std::size_t>(size)};
    }
    if (error != 0) destroy(out);
    return error;
}

int KernelCard::import_framebuffer(int dma_buf, std::uint32_t width, std::uint32_t height, std::uint32_t pitch, Framebuffer& out) {
    out = {};
    out.pitch = pitch;
    if (drmPrimeFDToHandle(fd_, dma_buf, &out.handle) != 0) return last_error();
    const int error = add_framebuffer(width, height, out);
    if (error != 0) destroy(out);
    return error;
}

void KernelCard::destroy(Framebuffer& framebuffer) {
    if (!framebuffer.bytes.empty()) munmap(framebuffer.bytes.data(), framebuffer.bytes.size());
    if (framebuffer.id) drmModeRmFB(fd_, framebuffer.id);
    if (framebuffer.handle) drmCloseBufferHandle(fd_, framebuffer.handle);
    framebuffer = {};
}

int KernelCard::set_mode(std::uint32_t crtc, std::uint32_t connector, const drmModeModeInfo& mode, std::uint32_t framebuffer) {
    drmModeModeInfo copy = mode;
    return drmModeSetCrtc(fd_, crtc, framebuffer, 0, 0, &connector, 1, &copy) == 0 ? 0 : last_error();
}

int KernelCard::flip(std::uint32_t crtc, std::uint32_t framebuffer) {
    return drmModePageFlip(fd_, crtc, framebuffer, DRM_MODE_PAGE_FLIP_EVENT, this) == 0 ? 0 : last_error();
}

namespace {
thread_local std::optional<Vblank> arrived;  // between drmHandleEvent() and its caller: a flip's own data may be older than this wait
}

void KernelCard::on_flip(int, unsigned sequence, unsigned seconds, unsigned microseconds, unsigned, void*) {
    arrived = Vblank{sequence, TimeNs(seconds) * ns_per_s + TimeNs(microseconds) * 1000};
}

int KernelCard::wait_flip(DurationNs patience, Vblank& out) {
    drmEventContext context{};
    context.version = 3;
    context.page_flip_handler2 = on_flip;
    MonotonicClock clock;
    const TimeNs end = clock.now() + patience;
    for (;;) {
        const DurationNs left = std::max<DurationNs>(end - clock.now(), 0);
        pollfd descriptor{fd_, POLLIN, 0};
        const timespec limit{left / ns_per_s, left % ns_per_s};
        const int ready = ppoll(&descriptor, 1, &limit, nullptr);
        if (ready < 0 && errno != EINTR) return last_error();
        if (ready > 0 && !(descriptor.revents & POLLIN)) return ENODEV;
        arrived.reset();
        if (ready > 0 && drmHandleEvent(fd_, &context) != 0) return EIO;
        if (arrived) {
            out = *arrived;
            return 0;
        }
        if (ready <= 0 && clock.now() >= end) return ETIMEDOUT;
    }
}

int KernelCard::last_vblank(std::uint32_t crtc, Vblank& out) {
    std::uint64_t sequence = 0, time = 0;
    if (drmCrtcGetSequence(fd_, crtc, &sequence, &time) != 0) return last_error();
    out = {static_cast<std::uint32_t>(sequence), static_cast<TimeNs>(time)};
    return 0;
}

int KernelCard::become_master() { return drmIsMaster(fd_) || drmSetMaster(fd_) == 0 ? 0 : last_error(); }

}  // namespace

Result<std::unique_ptr<DrmCard>> card_of(int fd, std::string name, std::shared_ptr<void> keep) {
    auto card = std::make_unique<KernelCard>(fd, name, std::move(keep));  // closes it from now on
    const Version version(drmGetVersion(fd));
    if (!version) return failure(fmt::format("{} is no graphics card.", name));
    std::uint64_t monotonic = 0;
    if (drmGetCap(fd, DRM_CAP_TIMESTAMP_MONOTONIC, &monotonic) != 0 || monotonic == 0)
        return failure(
            fmt::format("{}: its driver stamps refreshes by the wall clock. Start Linux without drm.timestamp_monotonic=0.", name));
    return card;
}

std::vector<std::unique_ptr<DrmCard>> open_cards(std::string& problem) {
    namespace fs = std::filesystem;
    std::error_code error;
    std::vector<std::string> paths;
    for (const auto& entry : fs::directory_iterator("/dev/dri", error))
        if (entry.path().filename().string().starts_with("card")) paths.push_back(entry.path().string());
    std::sort(paths.begin(), paths.end());
    std::vector<std::unique_ptr<DrmCard>> cards;
    for (const std::string& path : paths) {
        const int fd = open(path.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
        if (fd < 0) {
            problem = fmt::format("{} cannot be opened ({}). Add yourself to the group video and log in again.", path, strerror(errno));
            continue;
        }
        const Version version(drmGetVersion(fd));
        auto card = card_of(fd, version ? fmt::format("{} ({})", path, std::string(version->name, std::size_t(version->name_len))) : path);
        if (card)
            cards.push_back(std::move(*card));
        else
            problem = card.error().message;
    }
    if (cards.empty() && problem.empty())
        problem = "This machine has no graphics card that Linux can light displays with (no /dev/dri/card0).";
    return cards;
}

}  // namespace entoptic::compositor::kms
