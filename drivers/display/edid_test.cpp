// labels: unit
#include "drivers/display/edid.h"

#include "base/noise.h"

#include <array>
#include <gtest/gtest.h>

namespace entoptic::drivers {
namespace {

using Block = std::array<std::uint8_t, 128>;

void seal(Block& b) {
    b[127] = 0;
    unsigned sum = 0;
    for (const std::uint8_t byte : b) sum += byte;
    b[127] = static_cast<std::uint8_t>(256 - sum % 256);
}

// A panel of 2880 x 1600 with 1624 lines in all (as the Vive Pro's) and a pixel clock that gives 90 Hz.
Block vive_pro() {
    Block b{};
    b = {0, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0, 0x22, 0xd2, 0x02, 0xaa, 0x78, 0x56, 0x34, 0x12, 1, 30, 1, 4};
    constexpr int width = 2880, blank = 80, height = 1600, lines = 24;
    const auto clock = static_cast<unsigned>((width + blank) * (height + lines) * 90.0 / 10'000);
    std::uint8_t* d = &b[54];
    d[0] = static_cast<std::uint8_t>(clock);
    d[1] = static_cast<std::uint8_t>(clock >> 8);
    d[2] = width & 255, d[3] = blank, d[4] = static_cast<std::uint8_t>((width >> 8) << 4);
    d[5] = height & 255, d[6] = lines, d[7] = static_cast<std::uint8_t>((height >> 8) << 4);
    const std::array<std::uint8_t, 18> name{0, 0, 0, 0xfc, 0, 'V', 'I', 'V', 'E', ' ', 'P', 'r', 'o', '\n', ' ', ' ', ' ', ' '};
    std::copy(name.begin(), name.end(), b.begin() + 72);
    seal(b);
    return b;
}

TEST(Edid, OfAVivePro) {
    const auto edid = parse_edid(vive_pro());
    ASSERT_TRUE(edid) << edid.error().message;
    EXPECT_EQ(edid->vendor, "HVR");
    EXPECT_EQ(edid->product, 0xaa02);
    EXPECT_EQ(edid->serial, 0x12345678u);
    EXPECT_EQ(edid->name, "VIVE Pro");
    EXPECT_EQ(edid->preferred.width, 2880);
    EXPECT_EQ(edid->preferred.height, 1600);
    EXPECT_EQ(edid->preferred.total_height, 1624);
    EXPECT_NEAR(edid->preferred.refresh_hz(), 90, 0.01);
    EXPECT_STREQ(headset_of_edid(*edid), "HTC Vive Pro");
}

TEST(Edid, OtherDisplaysAreNoHeadsets) {
    Block b = vive_pro();
    b[8] = 0x10, b[9] = 0xac;  // DEL
    seal(b);
    const auto dell = parse_edid(b);
    ASSERT_TRUE(dell);
    EXPECT_EQ(dell->vendor, "DEL");
    EXPECT_EQ(headset_of_edid(*dell), nullptr);
    b = vive_pro();
    b[10] = 0x77;
    seal(b);
    EXPECT_EQ(headset_of_edid(*parse_edid(b)), nullptr);
}

TEST(Edid, DamagedOnesAreRefused) {
    const Block good = vive_pro();
    for (std::size_t length = 0; length < good.size(); ++length) EXPECT_FALSE(parse_edid(std::span(good).first(length)));
    for (std::size_t i = 0; i < good.size(); ++i) {
        Block b = good;
        b[i] ^= 0x10;
        EXPECT_FALSE(parse_edid(b)) << i;
    }
    for (std::uint64_t i = 0; i < 20'000; ++i) {  // any bytes with a right sum: read, whatever they mean
        Block b = good;
        for (std::size_t k = 8; k < 127; ++k) b[k] = static_cast<std::uint8_t>(mix64(i * 128 + k));
        seal(b);
        ASSERT_TRUE(parse_edid(b));
    }
}

}  // namespace
}  // namespace entoptic::drivers
