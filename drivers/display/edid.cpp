#include "drivers/display/edid.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <numeric>

namespace entoptic::drivers {

namespace {

constexpr std::size_t block_bytes = 128, descriptor_bytes = 18, first_descriptor = 54;
constexpr std::array<std::uint8_t, 8> header{0, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0};

// Two bytes, big-endian, five bits a letter, 1 is A.
std::string vendor_letters(std::uint8_t high, std::uint8_t low) {
    const unsigned code = static_cast<unsigned>(high) << 8 | low;
    std::string out;
    for (const unsigned shift : {10u, 5u, 0u}) {
        const unsigned letter = (code >> shift) & 31u;
        out += letter >= 1 && letter <= 26 ? static_cast<char>('A' + letter - 1) : '?';
    }
    return out;
}

EdidMode timing(std::span<const std::uint8_t> d) {
    EdidMode mode;
    mode.pixel_clock_hz = static_cast<std::int64_t>(d[0] | d[1] << 8) * 10'000;
    mode.width = d[2] | (d[4] & 0xf0) << 4;
    mode.height = d[5] | (d[7] & 0xf0) << 4;
    mode.total_width = mode.width + (d[3] | (d[4] & 0x0f) << 8);
    mode.total_height = mode.height + (d[6] | (d[7] & 0x0f) << 8);
    return mode;
}

std::string descriptor_text(std::span<const std::uint8_t> d) {
    std::string out;
    for (const std::uint8_t c : d.subspan(5)) {
        if (c == '\n') break;
        out += c >= 32 && c < 127 ? static_cast<char>(c) : '?';
    }
    while (!out.empty() && out.back() == ' ') out.pop_back();
    return out;
}

}  // namespace

double EdidMode::refresh_hz() const {
    const auto total = static_cast<double>(total_width) * total_height;
    return total > 0 ? static_cast<double>(pixel_clock_hz) / total : 0;
}

Result<Edid> parse_edid(std::span<const std::uint8_t> bytes) {
    if (bytes.size() < block_bytes) return failure(fmt::format("An EDID has at least {} bytes; these are {}.", block_bytes, bytes.size()));
    const auto block = bytes.first(block_bytes);
    if (!std::equal(header.begin(), header.end(), block.begin())) return failure("These bytes are no EDID: their header is another.");
    if (std::accumulate(block.begin(), block.end(), 0u) % 256 != 0) return failure("The EDID's check sum is wrong: it was read damaged.");
    Edid out;
    out.vendor = vendor_letters(block[8], block[9]);
    out.product = static_cast<std::uint16_t>(block[10] | block[11] << 8);
    out.serial = static_cast<std::uint32_t>(block[12]) | static_cast<std::uint32_t>(block[13]) << 8 |
                 static_cast<std::uint32_t>(block[14]) << 16 | static_cast<std::uint32_t>(block[15]) << 24;
    out.version = block[18];
    out.revision = block[19];
    for (std::size_t at = first_descriptor; at + descriptor_bytes < block_bytes; at += descriptor_bytes) {
        const auto descriptor = block.subspan(at, descriptor_bytes);
        const bool is_timing = descriptor[0] != 0 || descriptor[1] != 0;
        if (is_timing && out.preferred.width == 0) out.preferred = timing(descriptor);
        if (!is_timing && descriptor[3] == 0xfc) out.name = descriptor_text(descriptor);
    }
    return out;
}

// Vendor and products: facts/devices.md 1.5; aa01 and aa02 are also in the kernel's own table of non-desktop displays.
const char* headset_of_edid(const Edid& edid) {
    if (edid.vendor != "HVR") return nullptr;
    switch (edid.product) {
        case 0xaa01:
            return "HTC Vive";
        case 0xaa02:
            return "HTC Vive Pro";
        case 0xaa03:
        case 0xaa04:
            return "HTC Vive Pro 2";
        default:
            return nullptr;
    }
}

}  // namespace entoptic::drivers
