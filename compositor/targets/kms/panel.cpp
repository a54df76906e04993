#include "compositor/targets/kms/panel.h"

#include "base/log.h"
#include "compositor/targets/kms/scanout.h"
#include "compositor/targets/kms/vblank_clock.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <mutex>
#include <optional>

namespace entoptic::compositor::kms {
namespace {

constexpr DurationNs ask_again_every = ns_per_s;         // choice: for a panel that is away; probing takes a card tens of ms
constexpr DurationNs look_every = ns_per_s / 2;          // choice: at what the kernel knows of the connector, as some drivers tell nobody
constexpr DurationNs longest_flip = 250'000'000;         // choice: 22 refreshes of 90 Hz; a flip that takes longer is not coming
constexpr DurationNs longest_busy = 25'000'000;          // choice: two refreshes
constexpr DurationNs between_first_tries = 100'000'000;  // choice

const char* name_of(ScanoutPath path) {
    switch (path) {
        case ScanoutPath::shared:
            return "scanned out of the GPU's memory";
        case ScanoutPath::imported:
            return "drawn into the card's memory";
        default:
            return "copied to the card by the CPU";
    }
}

// What an errno of a mode or a flip means for a panel that was ours.
std::string why_lost(const PanelChoice& choice, const DrmCard& card, int error) {
    const std::string panel = fmt::format("{} on {}", choice.headset, choice.connector.name);
    switch (error) {
        case EACCES:
        case EPERM:
            return fmt::format("Another program took over {}: {} may not be lit. It is asked for again each second.", card.name(), panel);
        case ENOENT:
            return fmt::format("The lease of {} was taken back by the display server. It is asked for again each second.", panel);
        case ENODEV:
            return fmt::format("The graphics card {} is gone, and with it {}.", card.name(), panel);
        case ETIMEDOUT:
            return fmt::format("{} shows no pictures any more: the driver of {} did not confirm a flip in {} ms. It is set up anew.", panel,
                               card.name(), longest_flip / 1'000'000);
        default:
            return fmt::format("{} cannot be lit by {}: {}. It is set up anew.", panel, card.name(), strerror(error));
    }
}

class Panel final : public DisplayTarget {
public:
    Panel(gpu::Device& device, Clock& clock, PanelOptions options) : device_(device), clock_(clock), options_(std::move(options)) {}
    ~Panel() override { let_go(); }
    Result<void> open();

    Result<void> test(const PresentState& state) override;
    Result<void> commit(const PresentState& state) override;
    Result<PresentFeedback> wait_shown() override;
    bool lit() const override;
    std::string description() const override;

private:
    struct Held {
        HeldPanel panel;
        std::array<ScanoutBuffer, 2> buffers;  // one is shown; the flip to the other is waited for before the first is drawn again
        VblankClock vblanks{1e9 / 90};
    };
    Result<void> take();
    Result<void> make_buffers(Held& held) const;
    void let_go();
    tl::unexpected<Error> lost(std::string why);
    Result<void> look();
    int flip(ScanoutBuffer& buffer);
    Result<void> show(ScanoutBuffer& buffer);
    PictureSize eye() const { return {options_.wish.width / eye_count, options_.wish.height}; }
    void describe(bool lit, std::string text);

    gpu::Device& device_;
    Clock& clock_;
    PanelOptions options_;
    ScanoutPass pass_;
    gpu::Commands commands_;
    std::unique_ptr<Held> held_;  // null: the panel is away
    std::size_t back_ = 0;        // the buffer to draw next
    bool mode_set_ = false, flipping_ = false, committed_ = false;
    TimeNs asked_ = 0, looked_ = 0;

    mutable std::mutex mutex_;
    bool lit_ = false;
    std::string text_;
};

void Panel::describe(bool lit, std::string text) {
    const std::lock_guard lock(mutex_);
    lit_ = lit;
    text_ = std::move(text);
}

bool Panel::lit() const {
    const std::lock_guard lock(mutex_);
    return lit_;
}

std::string Panel::description() const {
    const std::lock_guard lock(mutex_);
    return text_;
}

Result<void> Panel::open() {
    ENTOPTIC_TRY(pass, ScanoutPass::create(device_));
    pass_ = std::move(pass);
    ENTOPTIC_TRY(commands, gpu::Commands::create(device_, "panel"));
    commands_ = std::move(commands);
    const TimeNs end = clock_.now() + options_.patience;
    for (;;) {
        auto taken = take();
        if (taken || taken.error().kind != ErrorKind::missing || clock_.now() >= end) return taken;
        clock_.sleep_until(std::min(end, clock_.now() + between_first_tries));
    }
}

Result<void> Panel::take() {
    asked_ = clock_.now();
    auto held = std::make_unique<Held>();
    ENTOPTIC_TRY(panel, options_.hold(options_.wish));
    held->panel = std::move(panel);
    ENTOPTIC_CHECK(make_buffers(*held));
    const PanelChoice& choice = held->panel.choice;
    held->vblanks = VblankClock(1e9 / refresh_hz(choice.mode));
    const std::string text =
        fmt::format("{} on {} of {}, {}x{} at {:.2f} Hz, {}", choice.headset, choice.connector.name, held->panel.card->name(),
                    choice.mode.hdisplay, choice.mode.vdisplay, refresh_hz(choice.mode), name_of(held->buffers[0].path()));
    log::info("Panel: {}", text);
    held_ = std::move(held);
    back_ = 0;
    mode_set_ = flipping_ = committed_ = false;
    looked_ = clock_.now();
    describe(true, text);
    return {};
}

Result<void> Panel::make_buffers(Held& held) const {
    ScanoutPath path = ScanoutPath::shared;
    for (ScanoutBuffer& buffer : held.buffers) {
        ENTOPTIC_TRY(made, ScanoutBuffer::create(device_, *held.panel.card, eye(), path));
        buffer = std::move(made);
        path = buffer.path();  // both the same way: cards flip between buffers of one kind only
    }
    if (held.buffers[0].path() == held.buffers[1].path()) return {};
    ENTOPTIC_TRY(first, ScanoutBuffer::create(device_, *held.panel.card, eye(), path));
    held.buffers[0] = std::move(first);
    return {};
}

void Panel::let_go() {
    if (!held_) return;
    DrmCard& card = *held_->panel.card;
    Vblank ignored;
    if (flipping_) (void)card.wait_flip(longest_flip, ignored);
    if (mode_set_) card.turn_off(held_->panel.choice.crtc);
    for (ScanoutBuffer& buffer : held_->buffers) buffer = {};
    held_.reset();
    mode_set_ = flipping_ = committed_ = false;
}

tl::unexpected<Error> Panel::lost(std::string why) {
    flipping_ = false;  // let_go() need not wait for what does not come
    let_go();
    describe(false, fmt::format("away: {}", why));
    return failure(std::move(why));
}

// Is the panel still plugged in? The driver is asked when the kernel tells of a change, the kernel's own list twice a second.
Result<void> Panel::look() {
    DrmCard& card = *held_->panel.card;
    const PanelChoice& choice = held_->panel.choice;
    const bool probe = card.changed();
    if (!probe && clock_.now() - looked_ < look_every) return {};
    looked_ = clock_.now();
    std::vector<Connector> connectors;
    if (const int error = card.connectors(probe, connectors); error != 0) return lost(why_lost(choice, card, error));
    const auto found = std::find_if(connectors.begin(), connectors.end(), [&](const Connector& c) { return c.id == choice.connector.id; });
    if (found == connectors.end()) return lost(why_lost(choice, card, ENOENT));
    if (!found->connected)
        return lost(fmt::format("{} was unplugged from {}, or switched off. Pictures are not shown until it is back.", choice.headset,
                                choice.connector.name));
    if (found->link_bad && mode_set_) {
        log::warn("The cable's link to {} on {} failed and is set up anew.", choice.headset, choice.connector.name);
        mode_set_ = false;
    }
    return {};
}

Result<void> Panel::test(const PresentState&) {
    if (held_) return look();
    if (clock_.now() - asked_ < ask_again_every) return {};
    if (const auto taken = take(); !taken) log::debug("{}", taken.error().message);
    return {};
}

Result<void> Panel::commit(const PresentState& state) {
    committed_ = false;
    if (!held_) return {};
    ScanoutBuffer& buffer = held_->buffers[back_];
    ENTOPTIC_CHECK(commands_.begin());
    pass_.record(commands_, *state.path->panel().codes, eye(), buffer);
    ENTOPTIC_CHECK(commands_.submit());
    ENTOPTIC_CHECK(commands_.wait());
    buffer.finish();
    return show(buffer);
}

// A driver may still be tidying up after the refresh that it told of.
int Panel::flip(ScanoutBuffer& buffer) {
    for (const TimeNs end = clock_.now() + longest_busy;;) {
        const int error = held_->panel.card->flip(held_->panel.choice.crtc, buffer.framebuffer());
        if (error != EBUSY || clock_.now() >= end) return error;
        clock_.sleep_until(clock_.now() + ns_per_s / 2000);
    }
}

Result<void> Panel::show(ScanoutBuffer& buffer) {
    DrmCard& card = *held_->panel.card;
    const PanelChoice& choice = held_->panel.choice;
    const int error = mode_set_ ? flip(buffer) : card.set_mode(choice.crtc, choice.connector.id, choice.mode, buffer.framebuffer());
    if (error != 0) return lost(why_lost(choice, card, error));
    flipping_ = mode_set_;
    mode_set_ = committed_ = true;
    back_ = 1 - back_;
    return {};
}

Result<PresentFeedback> Panel::wait_shown() {
    if (!held_ || !committed_) return PresentFeedback{false, 0, 0};
    DrmCard& card = *held_->panel.card;
    Vblank vblank;
    if (flipping_) {
        if (const int error = card.wait_flip(longest_flip, vblank); error != 0) return lost(why_lost(held_->panel.choice, card, error));
        flipping_ = false;
    } else if (card.last_vblank(held_->panel.choice.crtc, vblank) != 0 || vblank.time <= 0) {  // a mode is set at once
        return PresentFeedback{};
    }
    const VblankClock::Refresh refresh = held_->vblanks.add(vblank);
    return PresentFeedback{true, refresh.time, refresh.time ? held_->vblanks.period() : 0};
}

}  // namespace

Result<std::unique_ptr<DisplayTarget>> make_panel_target(gpu::Device& device, Clock& clock, PanelOptions options) {
    auto panel = std::make_unique<Panel>(device, clock, std::move(options));
    ENTOPTIC_CHECK(panel->open());
    return panel;
}

}  // namespace entoptic::compositor::kms
