// Finding a headset of the Vive family among the HID devices, and the conversation with which it begins. No threads, no clock.
#pragma once

#include "drivers/hid/hid_bus.h"
#include "drivers/vive_pro/vive_pro_calibration.h"

#include <memory>
#include <string>

namespace entoptic::drivers::vive_pro {

struct Functions {
    HidInfo imu, light, mainboard;  // light and mainboard may be absent (empty path)
    bool is_vive = false;           // the Vive of 2016, not a Vive Pro
};

// Every tracking unit that may be a headset, each with the mainboard that is nearest in the USB tree.
std::vector<Functions> find_headsets(HidBus& bus);

struct Connection {
    Functions functions;
    std::unique_ptr<HidDevice> imu, light, mainboard;  // the last two may be null
    Calibration calibration;
    std::string configuration;  // the JSON text that `calibration` came from
    ImuRanges ranges;
    Firmware firmware;
};

// Opens the functions, reads configuration and ranges. Errors: it cannot be opened (missing); its configuration does not come whole after
// several tries, or says that it is no headset.
Result<Connection> connect(HidBus& bus, const Functions& functions);

// Opens light receiver and mainboard of a connection that lacks them, where they have come since: the functions of a headset that is plugged
// in come one after the other. True when there is more than before.
bool complete(HidBus& bus, Connection& connection);

// Downloads and unpacks the configuration, once.
Result<std::string> download_configuration(HidDevice& device);

// Display and light receiver on. A refusal of the receiver is an error, as there is then no position.
Result<void> switch_on(Connection& connection);
// Display off; the device may be gone.
void switch_off(Connection& connection);

}  // namespace entoptic::drivers::vive_pro
