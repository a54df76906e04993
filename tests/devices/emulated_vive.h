// A Vive Pro on the kernel's USB: the tracking unit with its IMU and light functions, and the mainboard, around one ViveModel.
#pragma once

#include "drivers/vive_pro/testing/vive_model.h"
#include "tests/devices/emulated_usb.h"

#include <functional>

namespace entoptic::devices {

using drivers::vive_pro::testing::ViveModel;

// What a HID interface's report descriptor declares: which reports exist and how long they are, without their ids.
struct HidReport {
    std::uint8_t id = 0;
    int bytes = 0;
    bool feature = false;
};

// A device of HID interfaces only. Endpoint of interface i: 1 + i, 1 ms.
class EmulatedHid : public EmulatedUsb {
protected:
    EmulatedHid(UsbDescriptors descriptors, const std::vector<std::vector<HidReport>>& interfaces);
    virtual std::optional<Bytes> get_feature(int interface, std::uint8_t id) = 0;
    virtual bool set_feature(int interface, std::span<const std::uint8_t> report) = 0;

    std::optional<Bytes> control_in(const Setup& setup) final;
    bool control_out(const Setup& setup, std::span<const std::uint8_t> data) final;

private:
    std::vector<Bytes> report_descriptors_;
};

// Changes a report before it is sent; empty: it is not sent. From the device's thread.
using Tamper = std::function<void(int function, std::int64_t number, Bytes& report)>;

class TrackingUnit final : public EmulatedHid {
public:
    TrackingUnit(ViveModel& model, Tamper tamper);
    std::atomic<bool> frozen = false;       // sends nothing any more
    std::atomic<std::int64_t> samples = 0;  // of the IMU, up to the newest report that was sent

private:
    std::optional<Bytes> get_feature(int interface, std::uint8_t id) override { return model_.get_feature(interface, id); }
    bool set_feature(int interface, std::span<const std::uint8_t> report) override { return model_.set_feature(interface, report); }
    InAnswer in(int endpoint, TimeNs now) override;
    InAnswer motion(TimeNs now);
    InAnswer light(TimeNs now);
    void plugged_in() override;

    ViveModel& model_;
    Tamper tamper_;
    TimeNs start_ = 0;  // of the model's time
    std::int64_t next_sample_ = 0, next_subframe_ = 0;
    std::deque<Bytes> light_queue_;
    TimeNs next_light_ = 0;
};

class Mainboard final : public EmulatedHid {
public:
    explicit Mainboard(ViveModel& model);

private:
    std::optional<Bytes> get_feature(int, std::uint8_t id) override { return model_.get_feature(2, id); }
    bool set_feature(int, std::span<const std::uint8_t> report) override { return model_.set_feature(2, report); }
    InAnswer in(int endpoint, TimeNs now) override;

    ViveModel& model_;
    TimeNs next_ = 0;
};

// The whole headset, on two ports.
class EmulatedVive {
public:
    // `configuration` is the JSON text that it holds.
    explicit EmulatedVive(Tamper tamper = {}, std::string configuration = drivers::vive_pro::testing::example_configuration())
        : model(std::move(configuration)), unit(model, std::move(tamper)), board(model) {}
    Result<void> plug() {
        ENTOPTIC_CHECK(board.plug(0));
        return unit.plug(1);
    }
    void unplug() {
        unit.unplug();
        board.unplug();
    }

    ViveModel model;
    TrackingUnit unit;
    Mainboard board;
};

}  // namespace entoptic::devices
