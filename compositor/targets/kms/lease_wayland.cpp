#include "compositor/targets/kms/lease.h"

#include <algorithm>
#include <drm-lease-v1-client-protocol.h>
#include <fmt/format.h>
#include <list>
#include <poll.h>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <wayland-client.h>

namespace entoptic::compositor::kms {
namespace {

constexpr DurationNs longest_answer = 5 * ns_per_s;  // choice: a compositor may ask its user

// One graphics card that the Wayland compositor leases connectors of.
struct Device {
    struct Offer {
        wp_drm_lease_connector_v1* handle = nullptr;
        std::uint32_t id = 0;
        bool withdrawn = false;
    };
    wp_drm_lease_device_v1* handle = nullptr;
    int fd = -1;  // to read connectors with; no right to light them
    std::list<Offer> offers;
    bool done = false;
};

class Session {
public:
    Session() : display_(wl_display_connect(nullptr)) {}
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    Result<void> ask();
    std::list<Device>& devices() { return devices_; }
    // The lease's descriptor, which the caller owns. The lease lives as long as this session.
    Result<int> lease(Device& device, const Device::Offer& offer, const std::string& name);

private:
    template <class Done> bool wait(Done done);

    static void on_global(void* data, wl_registry* registry, std::uint32_t name, const char* interface, std::uint32_t version);
    static void on_fd(void* data, wp_drm_lease_device_v1*, std::int32_t fd);
    static void on_connector(void* data, wp_drm_lease_device_v1*, wp_drm_lease_connector_v1* connector);
    static void on_lease(void* data, wp_drm_lease_v1*, std::int32_t fd);

    wl_display* display_;
    wl_registry* registry_ = nullptr;
    std::list<Device> devices_;
    wp_drm_lease_v1* lease_ = nullptr;
    int lease_fd_ = -1;
    bool refused_ = false;
};

void take_fd(int& into, int fd) {
    if (into >= 0) close(into);
    into = fd;
}

void Session::on_global(void* data, wl_registry* registry, std::uint32_t name, const char* interface, std::uint32_t) {
    static const wp_drm_lease_device_v1_listener listener{
        on_fd, on_connector, [](void* device, wp_drm_lease_device_v1*) { static_cast<Device*>(device)->done = true; },
        [](void*, wp_drm_lease_device_v1*) {}};
    if (std::string_view(interface) != wp_drm_lease_device_v1_interface.name) return;
    Device& device = static_cast<Session*>(data)->devices_.emplace_back();
    device.handle = static_cast<wp_drm_lease_device_v1*>(wl_registry_bind(registry, name, &wp_drm_lease_device_v1_interface, 1));
    wp_drm_lease_device_v1_add_listener(device.handle, &listener, &device);
}

void Session::on_fd(void* data, wp_drm_lease_device_v1*, std::int32_t fd) { take_fd(static_cast<Device*>(data)->fd, fd); }

void Session::on_connector(void* data, wp_drm_lease_device_v1*, wp_drm_lease_connector_v1* connector) {
    using Offer = Device::Offer;
    static const wp_drm_lease_connector_v1_listener listener{
        [](void*, wp_drm_lease_connector_v1*, const char*) {}, [](void*, wp_drm_lease_connector_v1*, const char*) {},
        [](void* offer, wp_drm_lease_connector_v1*, std::uint32_t id) { static_cast<Offer*>(offer)->id = id; },
        [](void*, wp_drm_lease_connector_v1*) {},
        [](void* offer, wp_drm_lease_connector_v1*) { static_cast<Offer*>(offer)->withdrawn = true; }};
    Offer& offer = static_cast<Device*>(data)->offers.emplace_back();
    offer.handle = connector;
    wp_drm_lease_connector_v1_add_listener(connector, &listener, &offer);
}

void Session::on_lease(void* data, wp_drm_lease_v1*, std::int32_t fd) { take_fd(static_cast<Session*>(data)->lease_fd_, fd); }

Session::~Session() {
    if (lease_fd_ >= 0) close(lease_fd_);
    if (lease_) wp_drm_lease_v1_destroy(lease_);
    for (Device& device : devices_) {
        for (Device::Offer& offer : device.offers) wp_drm_lease_connector_v1_destroy(offer.handle);
        if (device.handle) wp_drm_lease_device_v1_destroy(device.handle);
        if (device.fd >= 0) close(device.fd);
    }
    if (registry_) wl_registry_destroy(registry_);
    if (display_) {
        wl_display_flush(display_);
        wl_display_disconnect(display_);
    }
}

// Handles messages until `done`. False: the compositor left, or did not answer in time.
template <class Done> bool Session::wait(Done done) {
    MonotonicClock clock;
    for (const TimeNs end = clock.now() + longest_answer;;) {
        if (wl_display_dispatch_pending(display_) < 0) return false;
        if (done()) return true;
        if (wl_display_flush(display_) < 0 || clock.now() >= end) return false;
        while (wl_display_prepare_read(display_) != 0)
            if (wl_display_dispatch_pending(display_) < 0) return false;
        if (done()) {
            wl_display_cancel_read(display_);
            return true;
        }
        pollfd descriptor{wl_display_get_fd(display_), POLLIN, 0};
        const int ready = poll(&descriptor, 1, static_cast<int>(std::max<DurationNs>(end - clock.now(), 0) / 1'000'000) + 1);
        if (ready <= 0)
            wl_display_cancel_read(display_);
        else if (wl_display_read_events(display_) < 0)
            return false;
    }
}

Result<void> Session::ask() {
    static const wl_registry_listener listener{on_global, [](void*, wl_registry*, std::uint32_t) {}};
    if (!display_) return missing("the Wayland compositor that WAYLAND_DISPLAY names cannot be reached");
    registry_ = wl_display_get_registry(display_);
    wl_registry_add_listener(registry_, &listener, this);
    bool told = false;
    static const wl_callback_listener synced{[](void* flag, wl_callback*, std::uint32_t) { *static_cast<bool*>(flag) = true; }};
    wl_callback* callback = wl_display_sync(display_);
    wl_callback_add_listener(callback, &synced, &told);
    const bool answered = wait([&] { return told; });
    wl_callback_destroy(callback);
    if (!answered) return missing("the Wayland compositor does not answer");
    if (devices_.empty()) return missing("the Wayland compositor leases no displays (it lacks wp_drm_lease_device_v1)");
    if (!wait([&] { return std::all_of(devices_.begin(), devices_.end(), [](const Device& d) { return d.done; }); }))
        return missing("the Wayland compositor does not tell which displays it leases");
    return {};
}

Result<int> Session::lease(Device& device, const Device::Offer& offer, const std::string& name) {
    static const wp_drm_lease_v1_listener listener{
        on_lease, [](void* session, wp_drm_lease_v1*) { static_cast<Session*>(session)->refused_ = true; }};
    wp_drm_lease_request_v1* request = wp_drm_lease_device_v1_create_lease_request(device.handle);
    wp_drm_lease_request_v1_request_connector(request, offer.handle);
    lease_ = wp_drm_lease_request_v1_submit(request);
    wp_drm_lease_v1_add_listener(lease_, &listener, this);
    const bool answered = wait([&] { return refused_ || lease_fd_ >= 0; });
    if (answered && !refused_) return std::exchange(lease_fd_, -1);
    return failure(answered ? fmt::format("The Wayland compositor refused to lease the panel on {}. Another program may have it.", name)
                            : fmt::format("The Wayland compositor did not answer when asked to lease the panel on {}.", name));
}

// What is on offer, as the card itself tells it.
std::vector<Connector> offered(const Device& device, std::vector<Connector> connectors) {
    std::erase_if(connectors, [&](const Connector& c) {
        return std::none_of(device.offers.begin(), device.offers.end(),
                            [&](const auto& offer) { return !offer.withdrawn && offer.id == c.id; });
    });
    return connectors;
}

}  // namespace

Result<HeldPanel> lease_from_wayland(const PanelWish& wish) {
    auto session = std::make_shared<Session>();
    ENTOPTIC_CHECK(session->ask());
    for (Device& device : session->devices()) {
        if (device.fd < 0) continue;
        ENTOPTIC_TRY(reader, card_of(std::exchange(device.fd, -1), "the Wayland compositor's card"));
        std::vector<Connector> connectors;
        if (reader->connectors(false, connectors) != 0) continue;
        const auto choice = choose_panel(offered(device, connectors), wish);
        if (!choice && choice.error().kind != ErrorKind::missing) return forward_error(choice.error());
        if (!choice) continue;
        const auto offer = std::find_if(device.offers.begin(), device.offers.end(),
                                        [&](const auto& o) { return !o.withdrawn && o.id == choice->connector.id; });
        ENTOPTIC_TRY(fd, session->lease(device, *offer, choice->connector.name));
        ENTOPTIC_TRY(card, card_of(fd, "a lease of the Wayland compositor", session));
        std::vector<Connector> leased;
        if (card->connectors(true, leased) != 0) return failure("The lease of the Wayland compositor was taken back at once.");
        ENTOPTIC_TRY(held, choose_panel(leased, wish));
        return HeldPanel{std::move(card), std::move(held)};
    }
    return missing("the Wayland compositor leases no headset's panel");
}

}  // namespace entoptic::compositor::kms
