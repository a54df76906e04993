// Prints the device that the tests compute on, as bench/ledger/accuracy.csv names it.
#include "gpu/device.h"

#include <cstdio>

int main() {
    const auto device = entoptic::gpu::Device::create({});
    if (!device) {
        std::fprintf(stderr, "%s\n", device.error().message.c_str());
        return static_cast<int>(device.error().kind);
    }
    std::printf("%s, %s\n", (*device)->name().c_str(), (*device)->driver().c_str());
    return 0;
}
