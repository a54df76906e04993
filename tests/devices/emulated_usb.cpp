#include "tests/devices/emulated_usb.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <endian.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/socket.h>
#include <unistd.h>

namespace entoptic::devices {

namespace {

constexpr std::uint32_t command_submit = 1, command_unlink = 2, return_submit = 3, return_unlink = 4;
constexpr int speed_high = 3;
constexpr std::uint8_t get_status = 0, clear_feature = 1, set_feature = 3, get_descriptor = 6, get_configuration = 8, set_configuration = 9,
                       usb_set_interface = 11;

using Header = std::array<std::uint32_t, 12>;  // big-endian on the wire, but for the setup packet in the last two

void send_all(int socket, const Bytes& bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
        const ssize_t sent = send(socket, bytes.data() + at, bytes.size() - at, MSG_NOSIGNAL);
        if (sent <= 0) return;  // the reading side notices
        at += static_cast<std::size_t>(sent);
    }
}

Bytes message(std::initializer_list<std::uint32_t> words) {
    Bytes out(48, 0);
    std::size_t at = 0;
    for (const std::uint32_t word : words) {
        const std::uint32_t big = htobe32(word);
        std::memcpy(&out[at], &big, 4);
        at += 4;
    }
    return out;
}

// A line to a file of sysfs, in one write.
bool write_line(const char* path, const std::string& text) {
    const int file = open(path, O_WRONLY | O_CLOEXEC);
    if (file < 0) return false;
    const bool written = write(file, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    close(file);
    return written;
}

// By the kernel's own table: lines of "hs  0004 004 ..." with the port and its state, 4 for free.
bool port_is_free(int port) {
    std::ifstream table("/sys/devices/platform/vhci_hcd.0/status");
    for (std::string line; std::getline(table, line);) {
        int number = -1, state = -1;
        if (std::sscanf(line.c_str(), "hs %d %d", &number, &state) == 2 && number == port) return state == 4;
    }
    return false;
}

}  // namespace

TimeNs monotonic_now() { return MonotonicClock().now(); }

UsbDescriptors usb_descriptors(std::uint16_t vendor, std::uint16_t product, std::vector<std::string> strings) {
    UsbDescriptors out;
    const auto low = [](std::uint16_t v) { return static_cast<std::uint8_t>(v); };
    const auto high = [](std::uint16_t v) { return static_cast<std::uint8_t>(v >> 8); };
    out.device = {18, 1, 0, 2, 0, 0, 0, 64, low(vendor), high(vendor), low(product), high(product), 0, 1, 1, 2, 3, 1};
    out.configuration = {9, 2, 9, 0, 0, 1, 0, 0x80, 50};
    out.strings = std::move(strings);
    return out;
}

EmulatedUsb::~EmulatedUsb() { unplug(); }

Result<void> EmulatedUsb::plug(int port) {
    int sockets[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0)
        return failure(fmt::format("No socket pair: {}.", std::strerror(errno)));
    constexpr const char* attach = "/sys/devices/platform/vhci_hcd.0/attach";
    const bool attached = write_line(attach, fmt::format("{} {} {} {}", port, sockets[1], (1 << 16) | (port + 2), speed_high));
    const int why = errno;
    close(sockets[1]);
    if (!attached) {
        close(sockets[0]);
        return missing(fmt::format("{}: {}. Run this on the device tests' kernel: tests/devices/run_um.sh", attach, std::strerror(why)));
    }
    socket_ = sockets[0];
    port_ = port;
    waiting_.clear();
    configuration_ = 0;
    plugged_in();
    thread_ = std::thread([this] { run(); });
    return {};
}

void EmulatedUsb::unplug() {
    if (socket_ < 0) return;
    shutdown(socket_, SHUT_RDWR);  // the kernel sees the device go
    thread_.join();
    close(socket_);
    socket_ = -1;
    write_line("/sys/devices/platform/vhci_hcd.0/detach", fmt::format("{}", port_));
    for (int i = 0; i < 1000 && !port_is_free(port_); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

InAnswer EmulatedUsb::in_packets(int, std::span<IsoPacket>, TimeNs) { return {InAnswer::Kind::stall, {}, -1}; }

void EmulatedUsb::run() {
    // It stands for hardware, which does not wait for the one CPU; where that is refused, it does.
    const sched_param priority{1};
    pthread_setschedparam(pthread_self(), SCHED_FIFO, &priority);
    for (;;) {
        const TimeNs due = serve(monotonic_now());
        pollfd ready{socket_, POLLIN, 0};
        timespec wait{};
        if (due >= 0) {
            const TimeNs left = std::max<TimeNs>(0, due - monotonic_now());
            wait = {left / ns_per_s, left % ns_per_s};
        }
        const int events = ppoll(&ready, 1, due >= 0 ? &wait : nullptr, nullptr);
        if (events > 0 && !handle_message()) return;
    }
}

bool EmulatedUsb::receive(void* into, std::size_t bytes) {
    auto* at = static_cast<std::uint8_t*>(into);
    while (bytes > 0) {
        const ssize_t got = recv(socket_, at, bytes, MSG_WAITALL);
        if (got <= 0) return false;
        at += got;
        bytes -= static_cast<std::size_t>(got);
    }
    return true;
}

bool EmulatedUsb::handle_message() {
    Header h{};
    if (!receive(h.data(), sizeof h)) return false;
    for (std::size_t i = 0; i < 10; ++i) h[i] = be32toh(h[i]);
    const std::uint32_t sequence = h[1], endpoint = h[4];
    if (h[0] == command_unlink) {
        std::int32_t status = 0;
        for (auto& [number, requests] : waiting_)
            if (std::erase_if(requests, [&](const Request& r) { return r.sequence == h[5]; }) > 0) status = -ECONNRESET;
        send_all(socket_, message({return_unlink, sequence, 0, 0, 0, static_cast<std::uint32_t>(status)}));
        return true;
    }
    if (h[0] != command_submit) return false;
    const bool to_host = h[3] != 0;
    Bytes data;
    if (!to_host && h[6] > 0) {
        data.resize(std::min<std::uint32_t>(h[6], 1 << 20));
        if (!receive(data.data(), data.size())) return false;
    }
    std::vector<IsoPacket> packets;
    if (h[8] != 0 && h[8] != 0xffffffff) {
        packets.resize(std::min<std::uint32_t>(h[8], 1024));
        for (IsoPacket& packet : packets) {
            std::array<std::uint32_t, 4> words{};
            if (!receive(words.data(), sizeof words)) return false;
            packet = {be32toh(words[0]), be32toh(words[1]), 0, 0};
        }
    }
    Setup setup;
    static_assert(sizeof setup == 8);
    std::memcpy(static_cast<void*>(&setup), &h[10], sizeof setup);  // little-endian on the wire, as this machine is
    if (endpoint == 0)
        handle_control(sequence, to_host, setup, data);
    else if (to_host)
        waiting_[static_cast<int>(endpoint)].push_back({sequence, h[6], std::move(packets)});
    else
        reply(sequence, -EPIPE, false, {}, 0);  // no device here has an OUT endpoint
    return true;
}

std::optional<Bytes> EmulatedUsb::standard_in(const Setup& setup) {
    if ((setup.type & 0x60) != 0) return std::nullopt;
    if (setup.request == get_status) return Bytes{0, 0};
    if (setup.type != 0x80) return std::nullopt;
    if (setup.request == get_configuration) return Bytes{configuration_};
    if (setup.request != get_descriptor) return std::nullopt;
    const int kind = setup.value >> 8, number = setup.value & 255;
    if (kind == 1) return descriptors_.device;
    if (kind == 2) return descriptors_.configuration;
    if (kind != 3) return std::nullopt;
    if (number == 0) return Bytes{4, 3, 9, 4};
    if (number > static_cast<int>(descriptors_.strings.size())) return std::nullopt;
    Bytes text{0, 3};
    for (const char c : descriptors_.strings[static_cast<std::size_t>(number) - 1]) {
        text.push_back(static_cast<std::uint8_t>(c));
        text.push_back(0);
    }
    text[0] = static_cast<std::uint8_t>(text.size());
    return text;
}

void EmulatedUsb::handle_control(std::uint32_t sequence, bool to_host, const Setup& setup, std::span<const std::uint8_t> data) {
    if (to_host) {
        auto answer = standard_in(setup);
        if (!answer) answer = control_in(setup);
        if (answer && answer->size() > setup.length) answer->resize(setup.length);
        reply(sequence, answer ? 0 : -EPIPE, true, answer ? *answer : Bytes{}, answer ? answer->size() : 0);
        return;
    }
    const bool standard = (setup.type & 0x60) == 0;
    if (standard && setup.request == usb_set_interface) set_interface(setup.index, setup.value);
    if (standard && setup.request == set_configuration) configuration_ = static_cast<std::uint8_t>(setup.value);
    const bool done = standard ? (setup.request == set_configuration || setup.request == usb_set_interface ||
                                  setup.request == clear_feature || setup.request == set_feature)
                               : control_out(setup, data);
    reply(sequence, done ? 0 : -EPIPE, false, {}, done ? data.size() : 0);
}

void EmulatedUsb::reply(std::uint32_t sequence, std::int32_t status, bool to_host, std::span<const std::uint8_t> data, std::size_t actual,
                        std::span<const IsoPacket> packets) {
    Bytes out = message({return_submit, sequence, 0, 0, 0, static_cast<std::uint32_t>(status), static_cast<std::uint32_t>(actual), 0,
                         static_cast<std::uint32_t>(packets.size()), 0});
    if (to_host) out.insert(out.end(), data.begin(), data.end());
    for (const IsoPacket& packet : packets)
        for (const std::uint32_t word : {packet.offset, packet.length, packet.actual, packet.status})
            for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<std::uint8_t>(word >> shift));
    send_all(socket_, out);
}

// Answers what can be answered now; when to come back, or -1.
TimeNs EmulatedUsb::serve(TimeNs now) {
    TimeNs next = -1;
    for (auto& [endpoint, requests] : waiting_) {
        while (!requests.empty()) {
            Request& request = requests.front();
            InAnswer answer = request.packets.empty() ? in(endpoint, now) : in_packets(endpoint, request.packets, now);
            if (answer.kind == InAnswer::Kind::wait) {
                if (answer.due >= 0) next = next < 0 ? answer.due : std::min(next, answer.due);
                break;
            }
            if (answer.data.size() > request.length) answer.data.resize(request.length);
            reply(request.sequence, answer.kind == InAnswer::Kind::stall ? -EPIPE : 0, true, answer.data, answer.data.size(),
                  request.packets);
            requests.pop_front();
        }
    }
    return next;
}

}  // namespace entoptic::devices
