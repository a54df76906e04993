#include "compositor/targets/kms/lease.h"

#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <string>
#include <vector>

namespace entoptic::compositor::kms {
namespace {

bool set(const char* variable) {
    const char* value = std::getenv(variable);
    return value && *value;
}

std::string held_by_another(const DrmCard& card, const PanelChoice& choice) {
    return fmt::format(
        "{} is on {}, but another program, most likely a display server, holds the graphics card {}. Start Entoptic from within that "
        "desktop, whose display server may lease the panel, or stop the display server and start it from a text console.",
        choice.headset, choice.connector.name, card.name());
}

}  // namespace

Result<HeldPanel> hold_card(const PanelWish& wish) {
    std::string problem;
    std::vector<std::string> found;
    for (auto& card : open_cards(problem)) {
        std::vector<Connector> connectors;
        if (const int error = card->connectors(true, connectors); error != 0) {
            found.push_back(fmt::format("{}: {}", card->name(), strerror(error)));  // a card that only computes
            continue;
        }
        auto choice = choose_panel(connectors, wish);
        if (!choice && choice.error().kind != ErrorKind::missing) return forward_error(choice.error());
        if (!choice) {
            found.push_back(fmt::format("{}: {}", card->name(), choice.error().message));
            continue;
        }
        if (card->become_master() != 0) return failure(held_by_another(*card, *choice));
        return HeldPanel{std::move(card), std::move(*choice)};
    }
    if (found.empty()) return missing(problem);
    return missing(fmt::format("{}{}{}", fmt::join(found, "; "), problem.empty() ? "" : ". ", problem));
}

Result<HeldPanel> hold_panel(const PanelWish& wish) {
    struct Way {
        const char* name;
        bool open;
        Result<HeldPanel> (*hold)(const PanelWish&);
    };
    // libwayland would take the application's own connection from WAYLAND_SOCKET.
    const Way ways[] = {{"Wayland", set("WAYLAND_DISPLAY") && !set("WAYLAND_SOCKET"), lease_from_wayland},
                        {"X11", set("DISPLAY"), lease_from_x11},
                        {"graphics cards", true, hold_card}};
    ErrorKind kind = ErrorKind::missing;
    std::vector<std::string> tried;
    for (const Way& way : ways) {
        if (!way.open) continue;
        auto held = way.hold(wish);
        if (held) return held;
        if (held.error().kind != ErrorKind::missing) kind = held.error().kind;
        if (!tried.empty() && tried.back().ends_with(held.error().message)) continue;  // the same panel's, another way
        tried.push_back(fmt::format("{}: {}", way.name, held.error().message));
    }
    return tl::make_unexpected(Error{kind, fmt::format("No panel of a headset could be taken. {}", fmt::join(tried, "; "))});
}

}  // namespace entoptic::compositor::kms
