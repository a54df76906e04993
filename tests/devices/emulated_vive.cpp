#include "tests/devices/emulated_vive.h"

namespace entoptic::devices {

namespace {

constexpr DurationNs sample_period = 1'000'000, mainboard_period = 52'000'000;
constexpr std::uint8_t hid_get_report = 1, hid_set_report = 9;

Bytes report_descriptor(const std::vector<HidReport>& reports) {
    Bytes out{0x06, 0x00, 0xff, 0x09, 0x01, 0xa1, 0x01, 0x15, 0x00, 0x26, 0xff, 0x00, 0x75, 0x08};  // vendor page; bytes
    for (const HidReport& r : reports) {
        const Bytes one{
            0x85, r.id, 0x95, static_cast<std::uint8_t>(r.bytes), 0x09, 0x01, static_cast<std::uint8_t>(r.feature ? 0xb1 : 0x81), 0x02};
        out.insert(out.end(), one.begin(), one.end());
    }
    out.push_back(0xc0);
    return out;
}

UsbDescriptors with_interfaces(UsbDescriptors out, const std::vector<Bytes>& report_descriptors) {
    Bytes& c = out.configuration;
    for (std::size_t i = 0; i < report_descriptors.size(); ++i) {
        const auto number = static_cast<std::uint8_t>(i);
        const auto size = report_descriptors[i].size();
        const Bytes one{9,
                        4,
                        number,
                        0,
                        1,
                        3,
                        0,
                        0,
                        0,  // interface: HID
                        9,
                        0x21,
                        0x11,
                        1,
                        0,
                        1,
                        0x22,
                        static_cast<std::uint8_t>(size),
                        static_cast<std::uint8_t>(size >> 8),  // its reports
                        7,
                        5,
                        static_cast<std::uint8_t>(0x81 + i),
                        3,
                        64,
                        0,
                        4};  // interrupt IN, 1 ms
        c.insert(c.end(), one.begin(), one.end());
    }
    c[2] = static_cast<std::uint8_t>(c.size());
    c[3] = static_cast<std::uint8_t>(c.size() >> 8);
    c[4] = static_cast<std::uint8_t>(report_descriptors.size());
    return out;
}

std::vector<Bytes> descriptors_of(const std::vector<std::vector<HidReport>>& interfaces) {
    std::vector<Bytes> out;
    for (const auto& reports : interfaces) out.push_back(report_descriptor(reports));
    return out;
}

}  // namespace

EmulatedHid::EmulatedHid(UsbDescriptors descriptors, const std::vector<std::vector<HidReport>>& interfaces)
    : EmulatedUsb(with_interfaces(std::move(descriptors), descriptors_of(interfaces))), report_descriptors_(descriptors_of(interfaces)) {}

std::optional<Bytes> EmulatedHid::control_in(const Setup& s) {
    const auto interface = static_cast<std::size_t>(s.index & 255);
    if (interface >= report_descriptors_.size()) return std::nullopt;
    if (s.type == 0x81 && s.request == 6 && (s.value >> 8) == 0x22) return report_descriptors_[interface];
    if (s.type == 0xa1 && s.request == hid_get_report && (s.value >> 8) == 3)
        return get_feature(static_cast<int>(interface), static_cast<std::uint8_t>(s.value));
    return std::nullopt;
}

bool EmulatedHid::control_out(const Setup& s, std::span<const std::uint8_t> data) {
    if (s.type != 0x21) return false;
    if (s.request == hid_set_report && (s.value >> 8) == 3) return set_feature(s.index & 255, data);
    return s.request == 0x0a;  // SET_IDLE
}

TrackingUnit::TrackingUnit(ViveModel& model, Tamper tamper)
    : EmulatedHid(usb_descriptors(0x28de, 0x2300, {"Valve", "LHR", "LHR-EXAMPLE1"}),
                  {{{0x20, 51}, {0x01, 63, true}, {0x04, 63, true}, {0x05, 63, true}, {0x07, 63, true}, {0x10, 63, true}, {0x11, 63, true}},
                   {{0x25, 63}, {0x28, 63}}}),
      model_(model),
      tamper_(std::move(tamper)) {}

void TrackingUnit::plugged_in() {
    const TimeNs now = monotonic_now();
    if (start_ == 0) start_ = now;  // its clock runs on over a short unplugging, as a battery would: the model's motion does, too
    next_sample_ = std::max(next_sample_, (now - start_) / sample_period + 3);
    next_subframe_ = std::max<std::int64_t>(next_subframe_, (now - start_) * 120 / ns_per_s);
    light_queue_.clear();
}

InAnswer TrackingUnit::in(int endpoint, TimeNs now) {
    if (frozen) return {InAnswer::Kind::wait, {}, now + 10'000'000};
    return endpoint == 1 ? motion(now) : light(now);
}

InAnswer TrackingUnit::motion(TimeNs now) {
    for (;;) {
        const TimeNs due = start_ + next_sample_ * sample_period;
        if (now < due) return {InAnswer::Kind::wait, {}, due};
        // A host that comes late gets the newest three, as from the real ring.
        next_sample_ = std::max(next_sample_, (now - start_) / sample_period - 1);
        Bytes report = model_.imu_report(next_sample_);
        samples = next_sample_;
        ++next_sample_;
        if (tamper_) tamper_(0, next_sample_ - 1, report);
        if (!report.empty()) return {InAnswer::Kind::data, std::move(report), -1};
    }
}

// Reports of a sub-frame come after it, one a millisecond.
InAnswer TrackingUnit::light(TimeNs now) {
    for (;;) {
        if (!light_queue_.empty()) {
            if (now < next_light_) return {InAnswer::Kind::wait, {}, next_light_};
            Bytes report = std::move(light_queue_.front());
            light_queue_.pop_front();
            next_light_ = now + sample_period / 2;
            if (tamper_) tamper_(1, next_subframe_, report);
            if (report.empty()) continue;
            return {InAnswer::Kind::data, std::move(report), -1};
        }
        const TimeNs due = start_ + (next_subframe_ + 1) * ns_per_s / 120;
        if (model_.room.stations.empty() || !model_.light_is_on) return {InAnswer::Kind::wait, {}, now + 8'000'000};
        if (now < due) return {InAnswer::Kind::wait, {}, due};
        next_subframe_ = std::max(next_subframe_, (now - start_) * 120 / ns_per_s - 2);
        for (Bytes& report : model_.light_reports(next_subframe_)) light_queue_.push_back(std::move(report));
        ++next_subframe_;
    }
}

Mainboard::Mainboard(ViveModel& model)
    : EmulatedHid(usb_descriptors(0x0bb4, 0x0309, {"HTC", "VIVE Pro", "EXAMPLE0000001"}), {{{0x03, 63}, {0x04, 63, true}}}),
      model_(model) {}

InAnswer Mainboard::in(int, TimeNs now) {
    if (now < next_) return {InAnswer::Kind::wait, {}, next_};
    next_ = now + mainboard_period;
    return {InAnswer::Kind::data, model_.mainboard_report(), -1};
}

}  // namespace entoptic::devices
