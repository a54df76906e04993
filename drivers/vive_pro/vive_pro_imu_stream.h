// From reports that each hold the last three samples to a stream in which every sample comes once, in order, with lost ones counted.
#pragma once

#include "drivers/vive_pro/vive_pro_protocol.h"

#include <array>
#include <cstdint>

namespace entoptic::drivers::vive_pro {

// The samples of a report that had not been there before, oldest first.
struct NewSamples {
    std::array<ImuSample, 3> samples;
    std::size_t count = 0;
};

class ImuStream {
public:
    NewSamples take(const ImuReport& report);

    std::uint64_t received() const { return received_; }
    // Samples that were taken (their sequence numbers are missing, or the clock says so) but never arrived.
    std::uint64_t lost() const { return lost_; }
    std::uint64_t gaps() const { return gaps_; }           // places where samples are missing
    std::uint64_t restarts() const { return restarts_; }   // the device's clock jumped, or the device began anew

private:
    void accept(const ImuSample& sample, NewSamples& out);
    void restart(const ImuReport& report, NewSamples& out);

    bool started_ = false;
    ImuSample last_;
    std::uint64_t received_ = 0, lost_ = 0, gaps_ = 0, restarts_ = 0;
};

}  // namespace entoptic::drivers::vive_pro
