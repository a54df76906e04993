// A graphics card of a test's own: a Vive Pro's panel on DP-2 beside a desktop's monitor, memory that the GPU can draw into, refreshes on a
// virtual clock, and faults to order.
#pragma once

#include "compositor/targets/kms/panel.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <map>
#include <vector>

namespace entoptic::compositor::kms::testing {

// What the hands of a test reach while the target holds the card.
struct CardState {
    std::vector<Connector> connectors;
    std::int64_t period_ns = 11'111'111;
    TimeNs first_vblank = 2 * ns_per_s + 4'000'000;
    std::uint32_t first_sequence = 100;
    bool counts = true;  // refreshes have numbers

    // Faults: the next answers, 0 for well.
    std::deque<int> set_mode_errors, flip_errors, wait_errors, framebuffer_errors;
    std::deque<DurationNs> stamp_errors;  // added to the next stamps
    int connectors_error = 0, import_error = EOPNOTSUPP;
    bool misaligned = false;  // memory that Vulkan cannot draw into
    bool hotplug = false;     // the kernel tells of a change

    // What was done.
    std::vector<std::uint32_t> shown;  // framebuffers, in order
    int modes_set = 0, flips = 0, turned_off = 0, probes = 0, held = 0;
    drmModeModeInfo mode{};
    std::uint32_t crtc = 0, connector = 0;
    std::vector<std::uint32_t> picture;  // shown last, row after row without padding
    std::uint32_t width = 0, height = 0;
};

inline drmModeModeInfo mode(std::uint16_t width, std::uint16_t height, std::uint32_t clock_khz, std::uint16_t total_width,
                            std::uint16_t total_height) {
    drmModeModeInfo m{};
    m.hdisplay = width, m.vdisplay = height, m.htotal = total_width, m.vtotal = total_height, m.clock = clock_khz;
    return m;
}

inline Connector monitor() {
    Connector c;
    c.id = 10, c.name = "DP-1", c.connected = true, c.crtcs = {1, 2}, c.crtc = 1;
    c.edid = {1};
    c.modes = {mode(1920, 1080, 148'500, 2200, 1125)};
    return c;
}
inline Connector headset() {
    Connector c;
    c.id = 20, c.name = "DP-2", c.connected = true, c.crtcs = {1, 2}, c.edid = {2}, c.non_desktop = true;
    c.modes = {mode(1440, 900, 106'500, 1904, 934), mode(2880, 1600, 447'000, 3054, 1624), mode(2880, 1600, 298'000, 3054, 1624)};
    return c;
}
inline PanelWish wish() {
    PanelWish w;
    w.headset_of_edid = [](std::span<const std::uint8_t> edid) { return std::string(edid[0] == 2 ? "HTC Vive Pro" : ""); };
    return w;
}

class FakeCard final : public DrmCard {
public:
    FakeCard(CardState& state, Clock& clock) : s_(state), clock_(clock) { ++s_.held; }
    ~FakeCard() override { --s_.held; }
    std::string name() const override { return "card7 (fake)"; }

    int connectors(bool probe, std::vector<Connector>& out) override {
        s_.probes += probe;
        out = s_.connectors;
        return s_.connectors_error;
    }
    bool changed() override { return std::exchange(s_.hotplug, false); }

    int create_framebuffer(std::uint32_t width, std::uint32_t height, Framebuffer& out) override {
        if (const int error = next(s_.framebuffer_errors)) return error;
        const std::uint32_t pitch = (width * 4 + 255) / 256 * 256;
        const std::size_t size = (std::size_t(pitch) * height + 4095) / 4096 * 4096;
        auto* whole = static_cast<std::byte*>(std::aligned_alloc(4096, size + 4096));
        std::memset(whole, 0xee, size + 4096);
        out = {++last_id_, last_id_, pitch, {whole + (s_.misaligned ? 64 : 0), size}};
        s_.width = width, s_.height = height;
        buffers_[out.id] = out;
        return 0;
    }
    int import_framebuffer(int, std::uint32_t, std::uint32_t, std::uint32_t, Framebuffer&) override { return s_.import_error; }
    void destroy(Framebuffer& framebuffer) override {
        if (framebuffer.id) std::free(framebuffer.bytes.data() - (s_.misaligned ? 64 : 0));
        buffers_.erase(framebuffer.id);
        framebuffer = {};
    }

    int set_mode(std::uint32_t crtc, std::uint32_t connector, const drmModeModeInfo& mode, std::uint32_t framebuffer) override {
        if (const int error = next(s_.set_mode_errors)) return error;
        ++s_.modes_set;
        s_.crtc = crtc, s_.connector = connector, s_.mode = mode;
        show(framebuffer);
        return 0;
    }
    void turn_off(std::uint32_t) override { ++s_.turned_off; }
    int flip(std::uint32_t, std::uint32_t framebuffer) override {
        if (const int error = next(s_.flip_errors)) return error;
        ++s_.flips;
        show(framebuffer);
        return 0;
    }
    int wait_flip(DurationNs patience, Vblank& out) override {
        if (const int error = next(s_.wait_errors)) {
            if (error == ETIMEDOUT) clock_.sleep_until(clock_.now() + patience);
            return error;
        }
        const std::int64_t k = (clock_.now() - s_.first_vblank) / s_.period_ns + 1;
        clock_.sleep_until(s_.first_vblank + k * s_.period_ns);
        out = stamp(k);
        return 0;
    }
    int last_vblank(std::uint32_t, Vblank& out) override {
        if (!s_.counts) return EOPNOTSUPP;
        out = stamp((clock_.now() - s_.first_vblank) / s_.period_ns);
        return 0;
    }
    int become_master() override { return 0; }

private:
    static int next(std::deque<int>& answers) {
        if (answers.empty()) return 0;
        const int answer = answers.front();
        answers.pop_front();
        return answer;
    }
    Vblank stamp(std::int64_t k) {
        Vblank out{s_.counts ? s_.first_sequence + static_cast<std::uint32_t>(k) : 0, s_.first_vblank + k * s_.period_ns};
        if (!s_.stamp_errors.empty()) {
            out.time += s_.stamp_errors.front();
            s_.stamp_errors.pop_front();
        }
        return out;
    }
    void show(std::uint32_t id) {
        s_.shown.push_back(id);
        const Framebuffer& buffer = buffers_.at(id);
        s_.picture.resize(std::size_t(s_.width) * s_.height);
        for (std::uint32_t y = 0; y < s_.height; ++y)
            std::memcpy(&s_.picture[std::size_t(y) * s_.width], &buffer.bytes[std::size_t(y) * buffer.pitch], std::size_t(s_.width) * 4);
    }

    CardState& s_;
    Clock& clock_;
    std::map<std::uint32_t, Framebuffer> buffers_;
    std::uint32_t last_id_ = 0;
};

}  // namespace entoptic::compositor::kms::testing
