// Everything of the eye cameras that takes bytes from outside: motion JPEG pictures (decoded, checked, searched for a pupil), and what a UVC
// camera says of itself and sends over libusb. The first byte chooses.
#include "drivers/pupil_labs/eye_processor.h"
#include "drivers/uvc_camera/uvc_protocol.h"

#include <cmath>
#include <cstdlib>

namespace {

using namespace entoptic;
using namespace entoptic::drivers;

void require(bool condition) {
    if (!condition) std::abort();
}

void picture(std::span<const std::uint8_t> bytes) {
    static EyeProcessor processor(1, pupil_labs_camera("Pupil Cam3 ID0", 192, 192));
    const auto sample = processor.process({bytes, 1'000'000, 0}, 2'000'000);
    if (!sample) return;
    require(sample->confidence >= 0 && sample->confidence <= 1);
    require(!(sample->pupil_diameter_mm <= 0));  // NaN or a width, never zero
}

// The bytes themselves as a grey picture 64 px wide.
void detector(std::span<const std::uint8_t> bytes) {
    static PupilDetector finder;
    const PupilDetection got = finder.detect({bytes.data(), 64, static_cast<int>(bytes.size() / 64), 64});
    require(got.confidence >= 0 && got.confidence <= 1);
    require(std::isfinite(got.ellipse.x + got.ellipse.y + got.ellipse.major + got.ellipse.minor));
}

void descriptors(std::span<const std::uint8_t> bytes) {
    for (const auto& frame : uvc::parse_streaming_descriptors(bytes))
        require(frame.width > 0 && frame.height > 0 && !frame.intervals.empty());
    (void)uvc::parse_control_descriptors(bytes);
    (void)uvc::parse_probe(bytes);
}

// Packets of 32 bytes.
void packets(std::span<const std::uint8_t> bytes) {
    uvc::PictureAssembler assembler(1000);
    for (; bytes.size() >= 32; bytes = bytes.subspan(32))
        if (assembler.feed(bytes.first(32))) require(assembler.picture().size() <= 1000);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const std::span<const std::uint8_t> bytes(data + 1, size - 1);
    switch (data[0] % 4) {
        case 0:
            picture(bytes);
            break;
        case 1:
            detector(bytes);
            break;
        case 2:
            descriptors(bytes);
            break;
        default:
            packets(bytes);
            break;
    }
    return 0;
}
