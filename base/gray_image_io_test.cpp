// labels: unit fault
#include "base/gray_image_io.h"
#include "base/image_io.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <turbojpeg.h>
#include <unistd.h>

namespace entoptic {
namespace {

namespace fs = std::filesystem;

Image8 waves(int width, int height) {
    Image8 image(width, height, 1);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image.at(x, y, 0) = static_cast<std::uint8_t>(128 + 100 * std::sin(0.11 * x) * std::cos(0.07 * y));
    return image;
}

// As motion JPEG cameras send it: colour, 4:2:2, neutral chroma.
std::vector<std::uint8_t> jpeg_of(const Image8& image, int quality = 95) {
    std::vector<std::uint8_t> rgb;
    for (const std::uint8_t v : image.data) rgb.insert(rgb.end(), 3, v);
    tjhandle encoder = tjInitCompress();
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    EXPECT_EQ(tjCompress2(encoder, rgb.data(), image.width, 0, image.height, TJPF_RGB, &bytes, &size, TJSAMP_422, quality, 0), 0);
    const std::vector<std::uint8_t> out(bytes, bytes + size);
    tjFree(bytes);
    tjDestroy(encoder);
    return out;
}

// Removes the segments that define Huffman tables (marker FFC4, ITU-T T.81 B.2.4.2).
std::vector<std::uint8_t> without_huffman_tables(std::vector<std::uint8_t> jpeg) {
    for (std::size_t i = 2; i + 3 < jpeg.size() && jpeg[i] == 0xFF && jpeg[i + 1] != 0xDA;) {
        const std::size_t length = 2 + 256 * jpeg[i + 2] + jpeg[i + 3];
        if (jpeg[i + 1] == 0xC4)
            jpeg.erase(jpeg.begin() + static_cast<long>(i), jpeg.begin() + static_cast<long>(i + length));
        else
            i += length;
    }
    return jpeg;
}

double worst_difference(const Image8& a, const Image8& b) {
    int worst = a.width == b.width && a.height == b.height ? 0 : 255;
    for (std::size_t i = 0; i < std::min(a.data.size(), b.data.size()); ++i)
        worst = std::max(worst, std::abs(int(a.data[i]) - int(b.data[i])));
    return worst;
}

class GrayImageIo : public ::testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }
    std::string write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder_ / name, std::ios::binary) << bytes;
        return (folder_ / name).string();
    }
    fs::path folder_ = fs::temp_directory_path() / ("entoptic_gray_" + std::to_string(getpid()));
};

TEST_F(GrayImageIo, MotionJpegFramesDecodeWithAndWithoutTables) {
    const Image8 image = waves(192, 192);
    const auto jpeg = jpeg_of(image);
    const auto bare = without_huffman_tables(jpeg);
    ASSERT_LT(bare.size(), jpeg.size());
    JpegLumaDecoder decoder;
    Image8 whole, short_one;
    ASSERT_TRUE(decoder.decode(jpeg, whole));
    ASSERT_TRUE(decoder.decode(bare, short_one));
    EXPECT_LE(worst_difference(whole, image), 6);
    EXPECT_EQ(worst_difference(whole, short_one), 0);
}

TEST_F(GrayImageIo, EveryTruncationIsAnError) {
    const auto jpeg = jpeg_of(waves(64, 48), 80);
    JpegLumaDecoder decoder;
    Image8 image;
    for (std::size_t size = 0; size + 2 < jpeg.size(); size += 7)  // only the end marker is not missed
        EXPECT_FALSE(decoder.decode({jpeg.data(), size}, image)) << size << " of " << jpeg.size();
    const auto after = decoder.decode(jpeg, image);
    EXPECT_TRUE(after) << "a good picture after bad ones: " << after.error().message;
}

TEST_F(GrayImageIo, FilesOfEachFormat) {
    const Image8 image = waves(40, 30);
    std::string pgm = "P5\n# a comment\n40 30\n255\n";
    pgm.append(image.data.begin(), image.data.end());
    const auto from_pgm = read_gray(write("a.pgm", pgm));
    ASSERT_TRUE(from_pgm) << from_pgm.error().message;
    EXPECT_EQ(worst_difference(*from_pgm, image), 0);
    ASSERT_TRUE(write_png((folder_ / "a.png").string(), image));
    EXPECT_EQ(worst_difference(*read_gray((folder_ / "a.png").string()), image), 0);
    const auto jpeg = jpeg_of(image);
    EXPECT_LE(worst_difference(*read_gray(write("a.jpg", {jpeg.begin(), jpeg.end()})), image), 6);
}

TEST_F(GrayImageIo, WhatIsNotAPictureIsSaid) {
    const auto says = [&](const std::string& path, const char* wanted) {
        const auto read = read_gray(path);
        ASSERT_FALSE(read);
        EXPECT_NE(read.error().message.find(wanted), std::string::npos) << read.error().message;
        EXPECT_NE(read.error().message.find(path), std::string::npos) << read.error().message;
    };
    says((folder_ / "none").string(), "No such file");
    says(folder_.string(), "folder");
    says(write("text", "hello"), "neither PGM, PNG nor JPEG");
    says(write("empty", ""), "neither");
    says(write("short.pgm", "P5\n40 30\n255\nabc"), ".");
    says(write("huge.pgm", "P5\n9999999999 9999999999\n255\n"), ".");
    says(write("zero.pgm", "P5\n0 0\n255\n"), ".");
    says(write("short.png", "\x89PNG"), ".");
    says(write("short.jpg", "\xFF\xD8\xFF"), "JPEG");
}

}  // namespace
}  // namespace entoptic
