// labels: unit fault
// Bytes as the specification's tables have them, cut short, wrong, and in any order.
#include "drivers/uvc_camera/uvc_protocol.h"

#include <gtest/gtest.h>
#include <random>

namespace entoptic::drivers::uvc {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put(Bytes& to, std::initializer_list<int> bytes) {
    for (const int b : bytes) to.push_back(static_cast<std::uint8_t>(b));
}

// VS_INPUT_HEADER, VS_FORMAT_MJPEG 1, VS_FRAME_MJPEG 1: 192x192 at 200 and 120 Hz, 2: 400x400 at 120 Hz; an uncompressed format behind.
Bytes streaming() {
    Bytes b;
    put(b, {14, 0x24, 0x01, 2, 0, 0, 0x81, 0, 1, 0, 0, 0, 1, 0});
    put(b, {11, 0x24, 0x06, 1, 2, 1, 1, 0, 0, 0, 0});
    put(b, {34, 0x24, 0x07, 1, 0, 192, 0, 192, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x85, 0x45, 1, 0, 2});
    put(b, {0x85, 0x45, 1, 0, 0x50, 0xC3, 0, 0});  // 83 333 and 50 000 times 100 ns
    put(b, {30, 0x24, 0x07, 2, 0, 0x90, 1, 0x90, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x85, 0x45, 1, 0, 1, 0x85, 0x45, 1, 0});
    put(b, {4, 0x24, 0x04, 2});
    return b;
}

TEST(Uvc, SizesAndRatesOfTheMotionJpegFormat) {
    const auto frames = parse_streaming_descriptors(streaming());
    ASSERT_EQ(frames.size(), 2u);
    EXPECT_EQ(frames[0].width, 192);
    EXPECT_EQ(frames[0].format_index, 1);
    EXPECT_EQ(frames[0].intervals, (std::vector<std::uint32_t>{50000, 83333}));
    EXPECT_EQ(frames[1].height, 400);
    EXPECT_EQ(frames[1].frame_index, 2);
}

TEST(Uvc, CutAndRandomDescriptorsAreBorne) {
    const Bytes whole = streaming();
    for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_LE(parse_streaming_descriptors({whole.data(), size}).size(), 2u);
    std::mt19937 random(1);
    for (int i = 0; i < 20000; ++i) {
        Bytes bytes = whole;
        for (int k = 0; k < 4; ++k) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
        for (const Frame& frame : parse_streaming_descriptors(bytes)) {
            EXPECT_GT(frame.width, 0);
            EXPECT_FALSE(frame.intervals.empty());
            EXPECT_GT(frame.intervals.front(), 0u);
        }
        (void)parse_control_descriptors(bytes);
    }
}

TEST(Uvc, EntitiesThatOwnControls) {
    Bytes b;
    put(b, {13, 0x24, 0x01, 0x10, 1, 0, 0, 0, 0, 0, 0, 1, 1});
    put(b, {18, 0x24, 0x02, 7, 0x01, 0x02, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 0, 0});
    put(b, {11, 0x24, 0x05, 9, 7, 0, 0, 2, 0x0A, 0, 0});
    const Entities entities = parse_control_descriptors(b);
    EXPECT_EQ(entities.camera_terminal, 7);
    EXPECT_EQ(entities.processing_unit, 9);
}

TEST(Uvc, ProbeRoundTrip) {
    const auto bytes = encode({2, 3, 50000, 123456, 3640});
    EXPECT_EQ(bytes[2], 2);
    EXPECT_EQ(bytes[4] | bytes[5] << 8, 50000);
    const auto back = parse_probe(bytes);
    ASSERT_TRUE(back);
    EXPECT_EQ(back->frame_index, 3);
    EXPECT_EQ(back->interval, 50000u);
    EXPECT_EQ(back->max_payload_bytes, 3640u);
    EXPECT_FALSE(parse_probe({bytes.data(), 25}));
}

// facts/devices.md 3.4: 243 bytes for 192x192 at 200 Hz, 617 for 400x400 at 120 Hz; the alternates 128 to 3072.
TEST(Uvc, TheSmallestSufficientAlternateIsTaken) {
    EXPECT_NEAR(estimated_payload(192, 192, 200, 2.0), 243, 1);
    EXPECT_NEAR(estimated_payload(400, 400, 120, 2.0), 617, 1);
    std::vector<AlternateSetting> settings;
    for (const std::uint32_t bytes : {0u, 128u, 256u, 800u, 1600u, 2400u, 3072u})
        settings.push_back({static_cast<int>(settings.size()), 0x81, bytes});
    EXPECT_EQ(choose_alternate(settings, 243)->bytes, 256u);
    EXPECT_EQ(choose_alternate(settings, 617)->bytes, 800u);
    EXPECT_EQ(choose_alternate(settings, 5000)->bytes, 3072u) << "too little shows as corrupt pictures, not as a refusal";
    EXPECT_FALSE(choose_alternate({}, 1));
    EXPECT_FALSE(choose_alternate({settings.data(), 1}, 1));
    EXPECT_EQ(bytes_of_packet_size(0x1400), 3072u);  // 1024 bytes, three transactions
    EXPECT_EQ(bytes_of_packet_size(0x0B20), 1600u);
}

Bytes packet(int flags, std::initializer_list<int> payload) {
    Bytes b;
    put(b, {2, flags});
    put(b, payload);
    return b;
}

TEST(Uvc, PayloadsBecomePictures) {
    PictureAssembler assembler(100);
    EXPECT_FALSE(assembler.feed(packet(0, {1, 2})));
    EXPECT_FALSE(assembler.feed({}));
    EXPECT_TRUE(assembler.feed(packet(2, {3})));
    EXPECT_EQ(Bytes(assembler.picture().begin(), assembler.picture().end()), (Bytes{1, 2, 3}));
    EXPECT_FALSE(assembler.feed(packet(1, {4})));
    EXPECT_TRUE(assembler.feed(packet(0, {5}))) << "the end was lost: the toggled bit tells";
    EXPECT_EQ(Bytes(assembler.picture().begin(), assembler.picture().end()), (Bytes{4}));
    EXPECT_TRUE(assembler.feed(packet(2, {6})));
    EXPECT_EQ(Bytes(assembler.picture().begin(), assembler.picture().end()), (Bytes{5, 6}));
    EXPECT_EQ(assembler.corrupt(), 0u);
}

TEST(Uvc, PicturesWithAnErrorAreDropped) {
    PictureAssembler assembler(8);
    assembler.feed(packet(0, {1}));
    assembler.feed(packet(0x40, {2}));  // the camera's error bit
    EXPECT_FALSE(assembler.feed(packet(2, {3})));
    EXPECT_EQ(assembler.corrupt(), 1u);
    EXPECT_FALSE(assembler.feed(packet(1, {1, 2, 3, 4, 5})));
    EXPECT_FALSE(assembler.feed(packet(3, {1, 2, 3, 4, 5}))) << "too long";
    EXPECT_EQ(assembler.corrupt(), 2u);
    assembler.feed(packet(0, {1}));
    assembler.feed(Bytes{200, 0, 1});  // a header longer than its packet
    EXPECT_FALSE(assembler.feed(packet(2, {1})));
    EXPECT_TRUE(assembler.feed(packet(3, {7})));
    EXPECT_EQ(assembler.picture().size(), 1u);
}

TEST(Uvc, RandomPacketsNeverGrowAPictureBeyondItsLimit) {
    std::mt19937 random(2);
    PictureAssembler assembler(500);
    for (int i = 0; i < 20000; ++i) {
        Bytes bytes(random() % 60);
        for (auto& b : bytes) b = static_cast<std::uint8_t>(random());
        if (!bytes.empty()) bytes[0] = static_cast<std::uint8_t>(random() % 16);
        if (assembler.feed(bytes)) {
            EXPECT_LE(assembler.picture().size(), 500u);
        }
    }
}

}  // namespace
}  // namespace entoptic::drivers::uvc
