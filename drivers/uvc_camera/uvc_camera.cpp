#include "drivers/uvc_camera/uvc_camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <fmt/format.h>
#include <libusb.h>
#include <linux/v4l2-controls.h>
#include <vector>

namespace entoptic::drivers {

namespace {

constexpr int transfers_in_flight = 8, packets_a_transfer = 32;  // 32 ms of microframes in all, 4 ms each
constexpr DurationNs microframe = 125'000;
constexpr unsigned control_timeout_ms = 1000;
constexpr std::size_t largest_picture = 4u << 20, most_waiting = 3;
constexpr double ample_factor = 2.0;  // bits a pixel (facts/devices.md 3.4)
constexpr int video_class = 0x0E, control_subclass = 1, streaming_subclass = 2;
constexpr std::uint8_t set_cur = 0x01, get_cur = 0x81, get_min = 0x82, get_max = 0x83;
constexpr std::uint8_t to_interface = 0x21, from_interface = 0xA1;
constexpr std::uint16_t probe_control = 0x0100, commit_control = 0x0200;

CameraFault fault_of(int code) {
    switch (code) {
        case LIBUSB_ERROR_NO_DEVICE:
        case LIBUSB_ERROR_NOT_FOUND:
            return CameraFault::gone;
        case LIBUSB_ERROR_ACCESS:
            return CameraFault::forbidden;
        case LIBUSB_ERROR_BUSY:
            return CameraFault::busy;
        case LIBUSB_ERROR_NO_MEM:
            return CameraFault::no_bandwidth;  // submitting: the host controller has no room
        default:
            return CameraFault::broken;
    }
}

// A control of V4L2 as UVC has it: whose it is, its selector and size (UVC 1.1, 4.2.2).
struct ControlAddress {
    bool camera_terminal;
    std::uint8_t selector;
    std::uint16_t bytes;
};
std::optional<ControlAddress> address_of(std::uint32_t v4l2_id) {
    switch (v4l2_id) {
        case V4L2_CID_EXPOSURE_AUTO:
            return ControlAddress{true, 0x02, 1};
        case V4L2_CID_EXPOSURE_AUTO_PRIORITY:
            return ControlAddress{true, 0x03, 1};
        case V4L2_CID_EXPOSURE_ABSOLUTE:
            return ControlAddress{true, 0x04, 4};
        case V4L2_CID_SATURATION:
            return ControlAddress{false, 0x07, 2};
        case V4L2_CID_GAMMA:
            return ControlAddress{false, 0x09, 2};
        default:
            return std::nullopt;
    }
}

struct DeviceListDeleter {
    void operator()(libusb_device** list) const { libusb_free_device_list(list, 1); }
};
struct ConfigDeleter {
    void operator()(libusb_config_descriptor* config) const { libusb_free_config_descriptor(config); }
};
using Config = std::unique_ptr<libusb_config_descriptor, ConfigDeleter>;

// What the configuration descriptor says of the camera.
struct Layout {
    int control_interface = -1, streaming_interface = -1;
    uvc::Entities entities;
    std::vector<uvc::Frame> frames;
    std::vector<uvc::AlternateSetting> settings;
};

std::span<const std::uint8_t> extra_of(const libusb_interface_descriptor& d) {
    return {d.extra, d.extra_length > 0 ? static_cast<std::size_t>(d.extra_length) : 0};
}

void add_settings(const libusb_interface& interface, Layout& layout) {
    for (int i = 0; i < interface.num_altsetting; ++i) {
        const libusb_interface_descriptor& d = interface.altsetting[i];
        for (int k = 0; k < d.bNumEndpoints; ++k) {
            const libusb_endpoint_descriptor& e = d.endpoint[k];
            const bool isochronous_in =
                (e.bmAttributes & 3) == LIBUSB_TRANSFER_TYPE_ISOCHRONOUS && (e.bEndpointAddress & LIBUSB_ENDPOINT_IN);
            if (isochronous_in)
                layout.settings.push_back({d.bAlternateSetting, e.bEndpointAddress, uvc::bytes_of_packet_size(e.wMaxPacketSize)});
        }
    }
}

Layout layout_of(const libusb_config_descriptor& config) {
    Layout layout;
    for (int i = 0; i < config.bNumInterfaces; ++i) {
        if (config.interface[i].num_altsetting < 1) continue;
        const libusb_interface_descriptor& d = config.interface[i].altsetting[0];
        if (d.bInterfaceClass != video_class) continue;
        if (d.bInterfaceSubClass == control_subclass) {
            layout.control_interface = d.bInterfaceNumber;
            layout.entities = uvc::parse_control_descriptors(extra_of(d));
        } else if (d.bInterfaceSubClass == streaming_subclass && layout.streaming_interface < 0) {
            layout.streaming_interface = d.bInterfaceNumber;
            layout.frames = uvc::parse_streaming_descriptors(extra_of(d));
            add_settings(config.interface[i], layout);
        }
    }
    return layout;
}

class UvcCamera final : public FrameStream {
public:
    UvcCamera(std::string product, const Clock& clock) : product_(std::move(product)), clock_(clock) {}
    ~UvcCamera() override {
        stop();
        if (handle_) {
            // The control interface last: the kernel's driver takes the camera back by it, and wants the streaming one free.
            for (auto interface = claimed_.rbegin(); interface != claimed_.rend(); ++interface) libusb_release_interface(handle_, *interface);
            libusb_close(handle_);
        }
        if (context_) libusb_exit(context_);
    }

    CameraResult<void> open(const CameraMode& wanted) {
        if (const int code = libusb_init(&context_); code != 0) return broken("starting libusb", code);
        if (auto done = find(); !done) return done;
        if (auto done = claim(); !done) return done;
        if (auto done = negotiate(wanted); !done) return done;
        return start();
    }

    CameraResult<std::optional<CompressedFrame>> next(int timeout_ms) override {
        if (!ready_.empty() && given_) ready_.pop_front();
        given_ = false;
        const TimeNs end = clock_.now() + TimeNs{timeout_ms} * 1'000'000;
        while (ready_.empty() && !fault_) {
            const TimeNs left = end - clock_.now();
            if (left <= 0) break;
            timeval wait{static_cast<time_t>(left / ns_per_s), static_cast<suseconds_t>(left % ns_per_s / 1000)};
            if (const int code = libusb_handle_events_timeout_completed(context_, &wait, nullptr);
                code != 0 && code != LIBUSB_ERROR_INTERRUPTED)
                return tl::make_unexpected(broken("waiting for a picture", code).value());
        }
        counts_.corrupt = assembler_.corrupt();
        if (ready_.empty() && fault_)
            return tl::make_unexpected(CameraError{*fault_, fmt::format("{} (libusb): the stream ended. Plug it in again.", product_)});
        if (ready_.empty()) return std::optional<CompressedFrame>{};
        given_ = true;
        ++counts_.frames;
        const Picture& picture = ready_.front();
        return std::optional<CompressedFrame>{CompressedFrame{picture.bytes, picture.time, picture.sequence}};
    }

    const CameraMode& mode() const override { return mode_; }
    const CameraCounts& counts() const override { return counts_; }

    bool set_control(std::uint32_t id, std::int32_t value) override {
        const auto address = address_of(id);
        if (!address) return false;
        const std::uint8_t entity = address->camera_terminal ? layout_.entities.camera_terminal : layout_.entities.processing_unit;
        if (entity == 0) return false;
        if (id != V4L2_CID_EXPOSURE_AUTO) {  // a bit map has no range
            if (const auto least = get_control(*address, entity, get_min)) value = std::max(value, *least);
            if (const auto most = get_control(*address, entity, get_max)) value = std::min(value, *most);
        }
        std::array<std::uint8_t, 4> bytes{};
        for (std::size_t i = 0; i < address->bytes; ++i) bytes[i] = static_cast<std::uint8_t>(value >> (8 * i));
        return libusb_control_transfer(handle_, to_interface, set_cur, static_cast<std::uint16_t>(address->selector << 8),
                                       entity_index(entity), bytes.data(), address->bytes, control_timeout_ms) == address->bytes;
    }

    CameraResult<void> restart() override {
        stop();
        return start();
    }

private:
    struct Picture {
        std::vector<std::uint8_t> bytes;
        TimeNs time = 0;
        std::uint32_t sequence = 0;
    };
    struct Transfer {
        libusb_transfer* transfer = nullptr;
        std::vector<std::uint8_t> memory;
        bool in_flight = false;
    };

    tl::unexpected<CameraError> broken(const char* what, int code) const {
        const CameraFault fault = fault_of(code);
        const char* advice = fault == CameraFault::forbidden
                                 ? "Install Entoptic's udev rules, so that you may reach it through libusb; `entoptic doctor` says how."
                             : fault == CameraFault::no_bandwidth ? "Plug one camera into another port, or take other devices off this bus."
                                                                  : "Plug it in again.";
        return tl::make_unexpected(
            CameraError{fault, fmt::format("{} (libusb): {} failed: {}. {}", product_, what, libusb_error_name(code), advice)});
    }
    tl::unexpected<CameraError> unsuitable(const std::string& why) const {
        return tl::make_unexpected(CameraError{CameraFault::unsuitable, fmt::format("{} (libusb): {}", product_, why)});
    }
    std::uint16_t entity_index(std::uint8_t entity) const { return static_cast<std::uint16_t>(entity << 8 | layout_.control_interface); }

    bool is_it(libusb_device* device) {
        libusb_device_descriptor d{};
        if (libusb_get_device_descriptor(device, &d) != 0 || d.iProduct == 0) return false;
        libusb_device_handle* handle = nullptr;
        if (const int code = libusb_open(device, &handle); code != 0) {
            if (code == LIBUSB_ERROR_ACCESS) forbidden_ = true;
            return false;
        }
        std::array<unsigned char, 128> name{};
        const int length = libusb_get_string_descriptor_ascii(handle, d.iProduct, name.data(), static_cast<int>(name.size()));
        if (length > 0 && std::string(name.begin(), name.begin() + length) == product_) {
            handle_ = handle;
            return true;
        }
        libusb_close(handle);
        return false;
    }

    CameraResult<void> find() {
        libusb_device** devices = nullptr;
        const ssize_t count = libusb_get_device_list(context_, &devices);
        if (count < 0) return broken("listing the devices", static_cast<int>(count));
        const std::unique_ptr<libusb_device*, DeviceListDeleter> owner(devices);
        for (ssize_t i = 0; i < count; ++i) {
            if (!is_it(devices[i])) continue;
            libusb_config_descriptor* config = nullptr;
            if (const int code = libusb_get_active_config_descriptor(devices[i], &config); code != 0)
                return broken("reading its description", code);
            layout_ = layout_of(*Config(config));
            return {};
        }
        return broken("finding it", forbidden_ ? LIBUSB_ERROR_ACCESS : LIBUSB_ERROR_NO_DEVICE);
    }

    CameraResult<void> claim() {
        if (layout_.control_interface < 0 || layout_.streaming_interface < 0) return unsuitable("it is no video camera.");
        libusb_set_auto_detach_kernel_driver(handle_, 1);
        for (const int interface : {layout_.control_interface, layout_.streaming_interface}) {
            if (const int code = libusb_claim_interface(handle_, interface); code != 0)
                return broken("taking it from the kernel's driver", code);
            claimed_.push_back(interface);
        }
        return {};
    }

    std::optional<std::int32_t> get_control(const ControlAddress& address, std::uint8_t entity, std::uint8_t request) {
        std::array<std::uint8_t, 4> bytes{};
        const int got = libusb_control_transfer(handle_, from_interface, request, static_cast<std::uint16_t>(address.selector << 8),
                                                entity_index(entity), bytes.data(), address.bytes, control_timeout_ms);
        if (got != address.bytes) return std::nullopt;
        std::int32_t value = 0;
        for (std::size_t i = 0; i < address.bytes; ++i) value |= bytes[i] << (8 * i);
        return value;
    }

    CameraResult<void> control(std::uint8_t direction, std::uint8_t request, std::uint16_t what, std::span<std::uint8_t> bytes,
                               const char* words) {
        const int got = libusb_control_transfer(handle_, direction, request, what, static_cast<std::uint16_t>(layout_.streaming_interface),
                                                bytes.data(), static_cast<std::uint16_t>(bytes.size()), control_timeout_ms);
        if (got < static_cast<int>(uvc::probe_bytes_1_0)) return broken(words, got < 0 ? got : LIBUSB_ERROR_IO);
        return {};
    }

    CameraResult<void> negotiate(const CameraMode& wanted) {
        const auto frame = std::find_if(layout_.frames.begin(), layout_.frames.end(),
                                        [&](const uvc::Frame& f) { return f.width == wanted.width && f.height == wanted.height; });
        if (frame == layout_.frames.end())
            return unsuitable(fmt::format("it has no motion JPEG of {} x {} pixels.", wanted.width, wanted.height));
        const double shortest = 1e7 / (wanted.rate_hz * 1.01);
        const auto interval =
            std::find_if(frame->intervals.begin(), frame->intervals.end(), [&](std::uint32_t i) { return i >= shortest; });
        uvc::Probe probe{frame->format_index, frame->frame_index, interval == frame->intervals.end() ? frame->intervals.back() : *interval,
                         0, 0};
        auto bytes = uvc::encode(probe);
        // Probe, see what the camera makes of it, commit to that.
        if (auto done = control(to_interface, set_cur, probe_control, bytes, "asking for a format"); !done) return done;
        if (auto done = control(from_interface, get_cur, probe_control, bytes, "reading the format"); !done) return done;
        const auto agreed = uvc::parse_probe(bytes);
        if (!agreed || agreed->frame_index != probe.frame_index || agreed->interval == 0)
            return unsuitable("it does not agree to the format that it offers.");
        if (auto done = control(to_interface, set_cur, commit_control, bytes, "setting the format"); !done) return done;
        mode_ = {wanted.width, wanted.height, 1e7 / agreed->interval};
        const auto setting =
            uvc::choose_alternate(layout_.settings, uvc::estimated_payload(mode_.width, mode_.height, mode_.rate_hz, ample_factor));
        if (!setting) return unsuitable("it has no isochronous endpoint.");
        setting_ = *setting;
        return {};
    }

    CameraResult<void> start() {
        if (const int code = libusb_set_interface_alt_setting(handle_, layout_.streaming_interface, setting_.number); code != 0)
            return broken("reserving room on the bus", code);
        fault_.reset();
        for (int i = 0; i < transfers_in_flight; ++i) {
            auto one = std::make_unique<Transfer>();
            one->memory.resize(std::size_t{setting_.bytes} * packets_a_transfer);
            one->transfer = libusb_alloc_transfer(packets_a_transfer);
            if (!one->transfer) return broken("making a transfer", LIBUSB_ERROR_OTHER);
            libusb_fill_iso_transfer(one->transfer, handle_, setting_.endpoint, one->memory.data(), static_cast<int>(one->memory.size()),
                                     packets_a_transfer, &UvcCamera::completed, this, 0);
            libusb_set_iso_packet_lengths(one->transfer, setting_.bytes);
            transfers_.push_back(std::move(one));
            if (const int code = libusb_submit_transfer(transfers_.back()->transfer); code != 0) return broken("starting the stream", code);
            transfers_.back()->in_flight = true;
        }
        return {};
    }

    void stop() {
        stopping_ = true;
        for (const auto& one : transfers_)
            if (one->in_flight) libusb_cancel_transfer(one->transfer);
        const auto any = [&] { return std::any_of(transfers_.begin(), transfers_.end(), [](const auto& t) { return t->in_flight; }); };
        timeval wait{0, 100'000};
        for (int i = 0; i < 20 && any(); ++i) libusb_handle_events_timeout_completed(context_, &wait, nullptr);
        for (auto& one : transfers_) {
            if (one->in_flight)
                (void)one.release();  // a device that vanished may never give it back: its memory must stay (facts/devices.md 3.4)
            else
                libusb_free_transfer(one->transfer);
        }
        transfers_.clear();
        if (handle_ && !claimed_.empty()) libusb_set_interface_alt_setting(handle_, layout_.streaming_interface, 0);
        ready_.clear();
        given_ = stopping_ = false;
    }

    static void LIBUSB_CALL completed(libusb_transfer* transfer) { static_cast<UvcCamera*>(transfer->user_data)->take(transfer); }

    void take(libusb_transfer* transfer) {
        const auto one = std::find_if(transfers_.begin(), transfers_.end(), [&](const auto& t) { return t->transfer == transfer; });
        if (one == transfers_.end()) return;
        (*one)->in_flight = false;
        if (transfer->status == LIBUSB_TRANSFER_NO_DEVICE) fault_ = CameraFault::gone;
        if (transfer->status != LIBUSB_TRANSFER_COMPLETED || stopping_) {
            if (!stopping_ && !fault_) fault_ = CameraFault::broken;
            return;
        }
        const TimeNs now = clock_.now();
        for (int i = 0; i < transfer->num_iso_packets; ++i) {
            const libusb_iso_packet_descriptor& packet = transfer->iso_packet_desc[i];
            if (packet.status != LIBUSB_TRANSFER_COMPLETED) continue;
            const unsigned char* bytes = libusb_get_iso_packet_buffer_simple(transfer, static_cast<unsigned>(i));
            feed({bytes, std::min<std::size_t>(packet.actual_length, setting_.bytes)}, now - (packets_a_transfer - 1 - i) * microframe);
        }
        (*one)->in_flight = libusb_submit_transfer(transfer) == 0;
        if (!(*one)->in_flight) fault_ = CameraFault::broken;
    }

    void feed(std::span<const std::uint8_t> packet, TimeNs time) {
        const bool fresh = !assembler_.begun();
        if (assembler_.feed(packet)) {
            if (ready_.size() == most_waiting && !given_) {
                ready_.pop_front();  // the reader is late: the newest pictures count
                ++counts_.lost;
            }
            ready_.push_back({{assembler_.picture().begin(), assembler_.picture().end()}, picture_time_, sequence_++});
            picture_time_ = time;
        } else if (fresh) {
            picture_time_ = time;
        }
    }

    std::string product_;
    const Clock& clock_;
    libusb_context* context_ = nullptr;
    libusb_device_handle* handle_ = nullptr;
    bool forbidden_ = false;
    Layout layout_;
    std::vector<int> claimed_;
    CameraMode mode_;
    CameraCounts counts_;
    uvc::AlternateSetting setting_;
    std::vector<std::unique_ptr<Transfer>> transfers_;
    uvc::PictureAssembler assembler_{largest_picture};
    std::deque<Picture> ready_;
    bool given_ = false, stopping_ = false;
    std::optional<CameraFault> fault_;
    TimeNs picture_time_ = 0;
    std::uint32_t sequence_ = 0;
};

}  // namespace

CameraResult<std::unique_ptr<FrameStream>> open_uvc_camera(const std::string& product, const CameraMode& mode, const Clock& clock) {
    auto camera = std::make_unique<UvcCamera>(product, clock);
    if (auto done = camera->open(mode); !done) return tl::make_unexpected(done.error());
    return camera;
}

}  // namespace entoptic::drivers
