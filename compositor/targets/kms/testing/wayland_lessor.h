// A Wayland compositor that does nothing but lease displays (wp_drm_lease_device_v1), for tests of the client's side. On a thread of its own.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <drm-lease-v1-server-protocol.h>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <unistd.h>
#include <wayland-server.h>

namespace entoptic::compositor::kms::testing {

class WaylandLessor {
public:
    struct Behaviour {
        bool has_protocol = true;
        bool answers = true;  // to a request for a lease
        std::function<int()> reader = [] {
            return -1;
        };  // the descriptor to read connectors with, which the compositor gives away; -1: none
        std::function<int()> lease = [] { return -1; };  // of the lease; -1: refused
        std::uint32_t connector = 0;                     // on offer; 0: none
    };

    // Sets XDG_RUNTIME_DIR and WAYLAND_DISPLAY.
    explicit WaylandLessor(Behaviour behaviour) : behaviour_(std::move(behaviour)) {
        folder_ = std::filesystem::temp_directory_path() / ("entoptic-wayland-" + std::to_string(getpid()));
        std::filesystem::create_directories(folder_);
        std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
        setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
        display_ = wl_display_create();
        const char* socket = wl_display_add_socket_auto(display_);
        if (!socket) std::abort();
        setenv("WAYLAND_DISPLAY", socket, 1);
        if (behaviour_.has_protocol) wl_global_create(display_, &wp_drm_lease_device_v1_interface, 1, this, bind);
        thread_ = std::thread([this] {
            wl_event_loop* loop = wl_display_get_event_loop(display_);
            while (!stop_) {
                wl_event_loop_dispatch(loop, 5);
                wl_display_flush_clients(display_);
            }
        });
    }
    ~WaylandLessor() {
        stop_ = true;
        thread_.join();
        wl_display_destroy_clients(display_);
        wl_display_destroy(display_);
        unsetenv("WAYLAND_DISPLAY");
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }
    WaylandLessor(const WaylandLessor&) = delete;
    WaylandLessor& operator=(const WaylandLessor&) = delete;

    // Leases that a client holds now.
    int leases() const { return leases_; }

private:
    static WaylandLessor* self(wl_resource* resource) { return static_cast<WaylandLessor*>(wl_resource_get_user_data(resource)); }
    static void destroy(wl_client*, wl_resource* resource) { wl_resource_destroy(resource); }
    static void send(wl_resource* resource, int fd, void (*event)(wl_resource*, std::int32_t)) {
        if (fd < 0) return;
        event(resource, fd);  // the library sends a copy
        close(fd);
    }

    static void bind(wl_client* client, void* data, std::uint32_t version, std::uint32_t id) {
        static const struct wp_drm_lease_device_v1_interface device {
            create_request, [](wl_client*, wl_resource* resource) {
                wp_drm_lease_device_v1_send_released(resource);
                wl_resource_destroy(resource);
            }
        };
        static const struct wp_drm_lease_connector_v1_interface connector { destroy };
        auto* lessor = static_cast<WaylandLessor*>(data);
        wl_resource* resource = wl_resource_create(client, &wp_drm_lease_device_v1_interface, static_cast<int>(version), id);
        wl_resource_set_implementation(resource, &device, lessor, nullptr);
        send(resource, lessor->behaviour_.reader(), wp_drm_lease_device_v1_send_drm_fd);
        if (lessor->behaviour_.connector) {
            wl_resource* offer = wl_resource_create(client, &wp_drm_lease_connector_v1_interface, 1, 0);
            wl_resource_set_implementation(offer, &connector, lessor, nullptr);
            wp_drm_lease_device_v1_send_connector(resource, offer);
            wp_drm_lease_connector_v1_send_name(offer, "DP-1");
            wp_drm_lease_connector_v1_send_description(offer, "a headset");
            wp_drm_lease_connector_v1_send_connector_id(offer, lessor->behaviour_.connector);
            wp_drm_lease_connector_v1_send_done(offer);
        }
        wp_drm_lease_device_v1_send_done(resource);
    }
    static void create_request(wl_client* client, wl_resource* device, std::uint32_t id) {
        static const struct wp_drm_lease_request_v1_interface request {
            [](wl_client*, wl_resource*, wl_resource*) {}, submit
        };
        wl_resource* resource = wl_resource_create(client, &wp_drm_lease_request_v1_interface, 1, id);
        wl_resource_set_implementation(resource, &request, self(device), nullptr);
    }
    static void submit(wl_client* client, wl_resource* request, std::uint32_t id) {
        static const struct wp_drm_lease_v1_interface lease { destroy };
        WaylandLessor* lessor = self(request);
        wl_resource* resource = wl_resource_create(client, &wp_drm_lease_v1_interface, 1, id);
        ++lessor->leases_;
        wl_resource_set_implementation(resource, &lease, lessor, [](wl_resource* gone) { --self(gone)->leases_; });
        wl_resource_destroy(request);
        if (!lessor->behaviour_.answers) return;
        const int fd = lessor->behaviour_.lease();
        if (fd < 0)
            wp_drm_lease_v1_send_finished(resource);
        else
            send(resource, fd, wp_drm_lease_v1_send_lease_fd);
    }

    Behaviour behaviour_;
    std::filesystem::path folder_;
    wl_display* display_ = nullptr;
    std::atomic<bool> stop_{false};
    std::atomic<int> leases_{0};
    std::thread thread_;
};

}  // namespace entoptic::compositor::kms::testing
