#include "compositor/targets/kms/lease.h"

#include <algorithm>
#include <cstdlib>
#include <fmt/format.h>
#include <string>
#include <string_view>
#include <unistd.h>
#include <vector>
#include <xcb/randr.h>
#include <xcb/xcb.h>

namespace entoptic::compositor::kms {
namespace {

struct Free {
    void operator()(void* pointer) const { std::free(pointer); }
};
template <class T> using Reply = std::unique_ptr<T, Free>;

constexpr std::uint32_t longest_edid = 32 * 128;  // bytes; E-EDID has at most 256 blocks, displays have two to four

struct Output {
    xcb_randr_output_t id = 0;
    Connector connector;  // as far as the server tells: `crtcs` are those that nothing uses
    bool in_use = false;  // part of the desktop
};

class Connection {
public:
    Connection() : connection_(xcb_connect(nullptr, &screen_)) {}
    ~Connection() { xcb_disconnect(connection_); }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    Result<std::vector<Output>> outputs();
    // The lease's descriptor, which the caller owns.
    Result<int> lease(const Output& output);

private:
    Output output(xcb_randr_output_t id, const std::vector<xcb_randr_crtc_t>& used) const;
    std::vector<std::uint8_t> property(xcb_randr_output_t output, std::string_view name, std::uint32_t bytes) const;
    std::vector<xcb_randr_crtc_t> used_crtcs(const xcb_randr_get_screen_resources_current_reply_t& resources) const;

    int screen_ = 0;
    xcb_connection_t* connection_;
    xcb_window_t root_ = 0;
};

std::vector<std::uint8_t> Connection::property(xcb_randr_output_t output, std::string_view name, std::uint32_t bytes) const {
    const Reply<xcb_intern_atom_reply_t> atom(
        xcb_intern_atom_reply(connection_, xcb_intern_atom(connection_, 1, static_cast<std::uint16_t>(name.size()), name.data()), nullptr));
    if (!atom || atom->atom == XCB_ATOM_NONE) return {};
    const Reply<xcb_randr_get_output_property_reply_t> reply(xcb_randr_get_output_property_reply(
        connection_, xcb_randr_get_output_property(connection_, output, atom->atom, XCB_ATOM_ANY, 0, bytes / 4, 0, 0), nullptr));
    if (!reply) return {};
    const std::uint8_t* data = xcb_randr_get_output_property_data(reply.get());
    return {data, data + xcb_randr_get_output_property_data_length(reply.get())};
}

std::vector<xcb_randr_crtc_t> Connection::used_crtcs(const xcb_randr_get_screen_resources_current_reply_t& resources) const {
    std::vector<xcb_randr_crtc_t> used;
    const xcb_randr_crtc_t* crtcs = xcb_randr_get_screen_resources_current_crtcs(&resources);
    for (int i = 0; i < xcb_randr_get_screen_resources_current_crtcs_length(&resources); ++i) {
        const Reply<xcb_randr_get_crtc_info_reply_t> info(
            xcb_randr_get_crtc_info_reply(connection_, xcb_randr_get_crtc_info(connection_, crtcs[i], XCB_CURRENT_TIME), nullptr));
        if (!info || info->num_outputs > 0) used.push_back(crtcs[i]);
    }
    return used;
}

Output Connection::output(xcb_randr_output_t id, const std::vector<xcb_randr_crtc_t>& used) const {
    Output out;
    out.id = out.connector.id = id;
    const Reply<xcb_randr_get_output_info_reply_t> info(
        xcb_randr_get_output_info_reply(connection_, xcb_randr_get_output_info(connection_, id, XCB_CURRENT_TIME), nullptr));
    if (!info) return out;
    const auto* name = reinterpret_cast<const char*>(xcb_randr_get_output_info_name(info.get()));
    out.connector.name.assign(name, static_cast<std::size_t>(xcb_randr_get_output_info_name_length(info.get())));
    out.connector.connected = info->connection == XCB_RANDR_CONNECTION_CONNECTED;
    out.in_use = info->crtc != XCB_NONE;
    const xcb_randr_crtc_t* crtcs = xcb_randr_get_output_info_crtcs(info.get());
    for (int i = 0; i < xcb_randr_get_output_info_crtcs_length(info.get()); ++i)
        if (std::find(used.begin(), used.end(), crtcs[i]) == used.end()) out.connector.crtcs.push_back(crtcs[i]);
    const auto non_desktop = property(id, "non-desktop", 4);
    out.connector.non_desktop = !non_desktop.empty() && non_desktop[0] != 0;
    out.connector.edid = property(id, "EDID", longest_edid);
    return out;
}

Result<std::vector<Output>> Connection::outputs() {
    if (xcb_connection_has_error(connection_)) return missing("the X server that DISPLAY names cannot be reached");
    const xcb_query_extension_reply_t* randr = xcb_get_extension_data(connection_, &xcb_randr_id);
    if (!randr || !randr->present) return missing("the X server has no RandR extension");
    const Reply<xcb_randr_query_version_reply_t> version(
        xcb_randr_query_version_reply(connection_, xcb_randr_query_version(connection_, 1, 6), nullptr));
    if (!version || version->major_version < 1 || (version->major_version == 1 && version->minor_version < 6))
        return missing("the X server cannot lease displays (its RandR is older than 1.6)");
    xcb_screen_iterator_t screens = xcb_setup_roots_iterator(xcb_get_setup(connection_));
    for (int i = 0; i < screen_ && screens.rem > 1; ++i) xcb_screen_next(&screens);
    if (screens.rem == 0) return missing("the X server has no screen");
    root_ = screens.data->root;
    const Reply<xcb_randr_get_screen_resources_current_reply_t> resources(
        xcb_randr_get_screen_resources_current_reply(connection_, xcb_randr_get_screen_resources_current(connection_, root_), nullptr));
    if (!resources) return missing("the X server does not tell its outputs");
    const std::vector<xcb_randr_crtc_t> used = used_crtcs(*resources);
    std::vector<Output> out;
    const xcb_randr_output_t* ids = xcb_randr_get_screen_resources_current_outputs(resources.get());
    for (int i = 0; i < xcb_randr_get_screen_resources_current_outputs_length(resources.get()); ++i) out.push_back(output(ids[i], used));
    return out;
}

Result<int> Connection::lease(const Output& output) {
    if (output.in_use)
        return failure(fmt::format("The X server uses the headset's panel on {} as a monitor. Take it away: xrandr --output {} --off",
                                   output.connector.name, output.connector.name));
    if (output.connector.crtcs.empty())
        return failure(
            fmt::format("The X server has nothing left to drive the panel on {} with. Switch a monitor off.", output.connector.name));
    const xcb_randr_lease_t id = xcb_generate_id(connection_);
    xcb_generic_error_t* error = nullptr;
    const Reply<xcb_randr_create_lease_reply_t> reply(xcb_randr_create_lease_reply(
        connection_, xcb_randr_create_lease(connection_, root_, id, 1, 1, output.connector.crtcs.data(), &output.id), &error));
    const int code = error ? error->error_code : 0;
    std::free(error);
    if (!reply || reply->nfd < 1)
        return failure(
            fmt::format("The X server did not lease the panel on {} (X error {}). Another program may have it, or the server's "
                        "driver cannot lease.",
                        output.connector.name, code));
    const int* fds = xcb_randr_create_lease_reply_fds(connection_, reply.get());
    for (int i = 1; i < reply->nfd; ++i) close(fds[i]);
    return fds[0];
}

}  // namespace

Result<HeldPanel> lease_from_x11(const PanelWish& wish) {
    auto connection = std::make_shared<Connection>();
    ENTOPTIC_TRY(outputs, connection->outputs());
    const Output* best = nullptr;
    bool best_known = false;
    for (const Output& output : outputs) {
        // Outputs that are no desktop's are told as disconnected, so that desktops leave them alone. An EDID is there with a display only.
        const bool known = !output.connector.edid.empty() && !wish.headset_of_edid(output.connector.edid).empty();
        if ((known && !best_known) || (output.connector.non_desktop && !best)) {
            best = &output;
            best_known = known;
        }
    }
    if (!best) return missing("the X server knows no headset's panel");
    ENTOPTIC_TRY(fd, connection->lease(*best));
    ENTOPTIC_TRY(card, card_of(fd, "a lease of the X server", connection));
    std::vector<Connector> leased;
    if (card->connectors(true, leased) != 0) return failure("The lease of the X server was taken back at once.");
    ENTOPTIC_TRY(choice, choose_panel(leased, wish));
    return HeldPanel{std::move(card), std::move(choice)};
}

}  // namespace entoptic::compositor::kms
