// labels: gpu
#include "perception/storage/storage_pass.h"
#include "perception/testing/harness.h"
#include "perception/testing/oracles.h"
#include "perception/testing/scenes.h"

namespace entoptic::perception {
namespace {

using namespace testing;
const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard);

// Values go in as greys of a picture; infinities of the table are what we keep at the largest value.
void expect_column(StorageFormat format, int channel, const char* column, float largest) {
    const auto rows = oracle("storage_formats");
    ImageF in(static_cast<int>(rows.size()), 1, 3);
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (int c = 0; c < 3; ++c) in.at(static_cast<int>(i), 0, c) = static_cast<float>(rows[i].at("value"));
    const ImageF out = value(through_storage(device(), in, format, 1, 1)).picture;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const double expected = rows[i].at(column);
        EXPECT_FLOAT_EQ(out.at(static_cast<int>(i), 0, channel), std::isfinite(expected) ? static_cast<float>(expected) : largest)
            << column << " " << rows[i].at("value");
    }
}

TEST(Storage, SmallFloatsRoundAsTheTableHasThem) {
    expect_column(StorageFormat::fp16, 1, "fp16", 65504);
    expect_column(StorageFormat::r11g11b10, 0, "r11_6bit_mantissa", 65024);
    expect_column(StorageFormat::r11g11b10, 2, "b10_5bit_mantissa", 64512);
}

TEST(Storage, Fp32KeepsEveryBit) {
    const ImageF in = textured(97, 61, 1e-3, 1e8);
    EXPECT_EQ(value(through_storage(device(), in, StorageFormat::fp32, 1, 2)).picture.data, in.data);
}

// The shared exponent: the brightest channel of each pixel to half a step of 1/512 of the next power of two.
TEST(Storage, SharedExponentKeepsNineBitsOfTheBrightestChannel) {
    const ImageF in = textured(97, 61, 1, 6e4), out = value(through_storage(device(), in, StorageFormat::rgb9e5, 1, 1)).picture;
    for (std::size_t i = 0; i < in.data.size(); i += 3) {
        const float top = std::max({in.data[i], in.data[i + 1], in.data[i + 2]});
        float step = std::exp2(std::floor(std::log2(top)) - 8);
        if (top / step >= 511.5f) step *= 2;  // rounds up to the next exponent
        for (std::size_t c = i; c < i + 3; ++c)
            ASSERT_LE(std::abs(out.data[c] - in.data[c]), 0.5f * step * 1.0001f) << in.data[c] << " beside " << top;
    }
    ImageF hard(4, 1, 3);
    hard.data = {0, 0, 0, 1e8f, 1, 0, 511.75f, 0, 0, 1e-9f, 1e-9f, 1e-9f};
    const ImageF kept = value(through_storage(device(), hard, StorageFormat::rgb9e5, 1, 1)).picture;
    const std::vector<float> expected = {0, 0, 0, 65408, 0, 0, 512, 0, 0, 0, 0, 0};
    EXPECT_EQ(kept.data, expected);
}

TEST(Storage, PreExposureMakesRoomForTheSun) {
    const ImageF in = textured(97, 61, 100, 1e8);
    const float scale = pre_exposure(in);
    EXPECT_EQ(std::exp2(std::round(std::log2(scale))), scale) << "a power of two";
    const ImageF plain = value(through_storage(device(), in, StorageFormat::fp16, 1, 1)).picture,
                 exposed = value(through_storage(device(), in, StorageFormat::fp16, scale, 1)).picture;
    const float top = *std::max_element(in.data.begin(), in.data.end());
    EXPECT_EQ(*std::max_element(plain.data.begin(), plain.data.end()), 65504);
    EXPECT_NEAR(*std::max_element(exposed.data.begin(), exposed.data.end()) / top, 1, 5e-4);
    EXPECT_EQ(pre_exposure(ImageF(3, 2, 3)), 1) << "a black picture";
}

}  // namespace
}  // namespace entoptic::perception
