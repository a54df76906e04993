// labels: unit
#include "base/image_io.h"
#include "base/noise.h"

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfChromaticitiesAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTiledOutputFile.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <unistd.h>

namespace entoptic {
namespace {

namespace fs = std::filesystem;

class ImageIo : public ::testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    static ImageF colours(int width, int height) {
        ImageF image(width, height, 3);
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x) {
                image.at(x, y, 0) = 1e-6f * static_cast<float>(1 + x);
                image.at(x, y, 1) = 3.3f + static_cast<float>(y);
                image.at(x, y, 2) = 9.87654e7f / static_cast<float>(1 + x + y);
            }
        return image;
    }
    static std::string text_of(const std::string& file) {
        std::ifstream in(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    static void write(const std::string& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

    // Must fail, with a message that holds `wanted` and the file's name.
    static void expect_error(const std::string& file, const std::string& wanted) {
        const auto result = read_exr(file);
        ASSERT_FALSE(result) << file;
        EXPECT_NE(result.error().message.find(wanted), std::string::npos) << result.error().message;
        EXPECT_NE(result.error().message.find(file), std::string::npos) << result.error().message;
    }

private:
    fs::path folder_ = fs::temp_directory_path() / ("entoptic_image_io_test_" + std::to_string(getpid()));
};

// One channel as OpenEXR's own writer wants it.
struct Channel {
    std::string name;
    Imf::PixelType type = Imf::FLOAT;
    int sampling = 1;
    const void* data = nullptr;  // width / sampling values a row
};

Imf::FrameBuffer frame_of(Imf::Header& header, const std::vector<Channel>& channels) {
    const Imath::Box2i window = header.dataWindow();
    Imf::FrameBuffer frame;
    for (const Channel& c : channels) {
        header.channels().insert(c.name, Imf::Channel(c.type, c.sampling, c.sampling));
        const std::size_t size = c.type == Imf::HALF ? sizeof(half) : 4;
        const auto width = std::size_t((window.max.x - window.min.x + 1) / c.sampling);
        frame.insert(c.name, Imf::Slice::Make(c.type, c.data, window, size, size * width, c.sampling, c.sampling));
    }
    return frame;
}
void write_scanlines(const std::string& path, Imf::Header header, const std::vector<Channel>& channels) {
    const Imf::FrameBuffer frame = frame_of(header, channels);
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(header.dataWindow().max.y - header.dataWindow().min.y + 1);
}
std::vector<float> plane(const ImageF& image, int channel) {
    std::vector<float> out;
    for (std::size_t i = std::size_t(channel); i < image.data.size(); i += std::size_t(image.channels)) out.push_back(image.data[i]);
    return out;
}

TEST_F(ImageIo, FloatSurvivesToTheBitWithItsAttributes) {
    ImageF image = colours(37, 21);
    image.at(3, 4, 0) = std::numeric_limits<float>::quiet_NaN();
    image.at(4, 4, 1) = std::numeric_limits<float>::infinity();
    image.at(5, 4, 2) = -7;
    ASSERT_TRUE(write_exr(path("a.exr"), image, {179.5f, {{"who", "me"}}, {{"time", 0.25f}}}));
    const auto back = read_exr(path("a.exr"));
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->rgb.width, 37);
    EXPECT_EQ(back->rgb.height, 21);
    EXPECT_EQ(std::memcmp(back->rgb.data.data(), image.data.data(), image.data.size() * sizeof(float)), 0);
    EXPECT_EQ(back->white_luminance, 179.5f);
    EXPECT_EQ(back->text.at("who"), "me");
}

TEST_F(ImageIo, DistanceStandsBesideTheColour) {
    ImageF depth(5, 3, 1, 2.5f);
    depth.at(4, 2, 0) = std::numeric_limits<float>::infinity();
    ASSERT_TRUE(write_exr(path("z.exr"), colours(5, 3), {}, depth));
    const auto back = read_exr(path("z.exr"));
    ASSERT_TRUE(back) << back.error().message;
    EXPECT_EQ(back->depth.data, depth.data);
    EXPECT_EQ(back->rgb.data, colours(5, 3).data);
    EXPECT_FALSE(write_exr(path("z.exr"), colours(4, 3), {}, depth)) << "of another size";
    ASSERT_TRUE(write_exr(path("a.exr"), colours(4, 4)));
    EXPECT_TRUE(read_exr(path("a.exr"))->depth.data.empty());
}

TEST_F(ImageIo, WithoutWhiteLuminanceThereIsNone) {
    ASSERT_TRUE(write_exr(path("a.exr"), colours(4, 4)));
    EXPECT_FALSE(read_exr(path("a.exr"))->white_luminance);
}

TEST_F(ImageIo, OneChannelIsGrey) {
    ImageF grey(5, 3, 1);
    for (std::size_t i = 0; i < grey.data.size(); ++i) grey.data[i] = 0.1f * static_cast<float>(i);
    ASSERT_TRUE(write_exr(path("y.exr"), grey));
    const auto back = read_exr(path("y.exr"));
    ASSERT_TRUE(back) << back.error().message;
    for (int c = 0; c < 3; ++c) EXPECT_EQ(plane(back->rgb, c), grey.data);
}

TEST_F(ImageIo, HalfIsReadExactlyAndAlphaDropped) {
    const int width = 6, height = 5;
    std::vector<half> values;
    for (int i = 0; i < width * height; ++i) values.emplace_back(0.37f * static_cast<float>(i));
    write_scanlines(path("h.exr"), Imf::Header(width, height),
                    {{"R", Imf::HALF, 1, values.data()},
                     {"G", Imf::HALF, 1, values.data()},
                     {"B", Imf::HALF, 1, values.data()},
                     {"A", Imf::HALF, 1, values.data()}});
    const auto back = read_exr(path("h.exr"));
    ASSERT_TRUE(back) << back.error().message;
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(back->rgb.data[3 * i + 1], static_cast<float>(values[i]));
}

TEST_F(ImageIo, TilesAreReadLikeScanLines) {
    const ImageF image = colours(70, 45);
    for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS}) {
        Imf::Header header(image.width, image.height);
        header.setTileDescription({32, 16, mode});
        header.compression() = Imf::PIZ_COMPRESSION;
        const std::vector<float> r = plane(image, 0), g = plane(image, 1), b = plane(image, 2);
        const Imf::FrameBuffer frame =
            frame_of(header, {{"R", Imf::FLOAT, 1, r.data()}, {"G", Imf::FLOAT, 1, g.data()}, {"B", Imf::FLOAT, 1, b.data()}});
        {
            Imf::TiledOutputFile file(path("t.exr").c_str(), header);
            file.setFrameBuffer(frame);
            // Smaller levels hold whatever fits: only the largest is the picture.
            for (int level = 0; level < file.numLevels(); ++level)
                file.writeTiles(0, file.numXTiles(level) - 1, 0, file.numYTiles(level) - 1, level);
        }
        const auto back = read_exr(path("t.exr"));
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(back->rgb.data, image.data);
    }
}

// Smooth colours, so that the subsampled chroma loses little; OpenEXR's own (half-precision) writer is the witness.
TEST_F(ImageIo, LuminanceChromaComesBackAsColour) {
    const int width = 64, height = 48;
    Imf::Array2D<Imf::Rgba> rgba(height, width);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float u = static_cast<float>(x) / width, v = static_cast<float>(y) / height;
            rgba[y][x] = Imf::Rgba(1 + std::sin(2 * u), 1 + v, 2 - u * v);
        }
    {
        Imf::RgbaOutputFile file(path("yc.exr").c_str(), Imf::Header(width, height), Imf::WRITE_YC);
        file.setYCRounding(10, 10);  // all the bits that a half has
        file.setFrameBuffer(&rgba[0][0], 1, width);
        file.writePixels(height);
    }
    const auto back = read_exr(path("yc.exr"));
    ASSERT_TRUE(back) << back.error().message;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            // The writer's wide filter repeats the last chroma sample beyond the right and lower edges.
            const float tolerance = x < width - 10 && y < height - 10 ? 0.01f : 0.05f;
            EXPECT_NEAR(back->rgb.at(x, y, 0), static_cast<float>(rgba[y][x].r), tolerance) << x << ' ' << y;
            EXPECT_NEAR(back->rgb.at(x, y, 1), static_cast<float>(rgba[y][x].g), tolerance) << x << ' ' << y;
            EXPECT_NEAR(back->rgb.at(x, y, 2), static_cast<float>(rgba[y][x].b), tolerance) << x << ' ' << y;
        }
}

TEST_F(ImageIo, LuminanceChromaKeepsFloatRange) {
    const int width = 8, height = 8;
    const std::vector<float> luminance(64, 5e7f), none(16, 0.0f);
    write_scanlines(path("yc.exr"), Imf::Header(width, height),
                    {{"Y", Imf::FLOAT, 1, luminance.data()}, {"RY", Imf::FLOAT, 2, none.data()}, {"BY", Imf::FLOAT, 2, none.data()}});
    const auto back = read_exr(path("yc.exr"));
    ASSERT_TRUE(back) << back.error().message;
    for (const float v : back->rgb.data) EXPECT_NEAR(v / 5e7f, 1, 1e-5);
}

TEST_F(ImageIo, TheDisplayWindowIsThePicture) {
    const std::vector<float> ones(4 * 4, 1.0f);
    Imf::Header header(Imath::Box2i({0, 0}, {9, 7}), Imath::Box2i({8, 6}, {11, 9}));
    write_scanlines(path("w.exr"), header,
                    {{"R", Imf::FLOAT, 1, ones.data()}, {"G", Imf::FLOAT, 1, ones.data()}, {"B", Imf::FLOAT, 1, ones.data()}});
    const auto back = read_exr(path("w.exr"));
    ASSERT_TRUE(back) << back.error().message;
    ASSERT_EQ(back->rgb.width, 10);
    ASSERT_EQ(back->rgb.height, 8);
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 10; ++x) EXPECT_EQ(back->rgb.at(x, y, 1), x >= 8 && y >= 6 ? 1.0f : 0.0f);
}

TEST_F(ImageIo, OtherPrimariesBecomeBt709) {
    const std::vector<float> ones(1, 1.0f);
    Imf::Header header(1, 1);
    // BT.2020 with the same white: white stays white, to five digits.
    Imf::addChromaticities(header, Imf::Chromaticities({0.708f, 0.292f}, {0.170f, 0.797f}, {0.131f, 0.046f}, {0.3127f, 0.3290f}));
    const std::vector<float> none(1, 0.0f);
    write_scanlines(path("w.exr"), header,
                    {{"R", Imf::FLOAT, 1, ones.data()}, {"G", Imf::FLOAT, 1, ones.data()}, {"B", Imf::FLOAT, 1, ones.data()}});
    write_scanlines(path("g.exr"), header,
                    {{"R", Imf::FLOAT, 1, none.data()}, {"G", Imf::FLOAT, 1, ones.data()}, {"B", Imf::FLOAT, 1, none.data()}});
    const ImageF white = read_exr(path("w.exr"))->rgb;
    for (const float v : white.data) EXPECT_NEAR(v, 1, 1e-5);
    // BT.2087: the inverse of its matrix, second column.
    const ImageF green = read_exr(path("g.exr"))->rgb;
    EXPECT_NEAR(green.data[0], -0.5876, 2e-4);
    EXPECT_NEAR(green.data[1], 1.1329, 2e-4);
    EXPECT_NEAR(green.data[2], -0.1006, 2e-4);
}

TEST_F(ImageIo, WhatIsNoPictureSaysWhy) {
    expect_error(path("absent.exr"), "No such file");
    fs::create_directory(path("folder.exr"));
    expect_error(path("folder.exr"), "folder");
    write(path("empty.exr"), "");
    expect_error(path("empty.exr"), "not an OpenEXR");
    write(path("text.exr"), "this is a letter, not a picture");
    expect_error(path("text.exr"), "not an OpenEXR");
    const std::vector<float> values(4, 1.0f);
    write_scanlines(path("depth.exr"), Imf::Header(2, 2), {{"Z", Imf::FLOAT, 1, values.data()}});
    expect_error(path("depth.exr"), "no colour");
}

TEST_F(ImageIo, DeepAndManyPartsAreRefused) {
    ASSERT_TRUE(write_exr(path("a.exr"), colours(4, 4)));
    std::string bytes = text_of(path("a.exr"));
    bytes[5] = char(bytes[5] | 0x08);
    write(path("deep.exr"), bytes);
    expect_error(path("deep.exr"), "deep");
    bytes[5] = char(0x10);
    write(path("parts.exr"), bytes);
    expect_error(path("parts.exr"), "several parts");
}

// Every length from nothing to all but one byte: an error each time, never a picture with invented pixels, never a crash.
TEST_F(ImageIo, ATruncatedFileIsAnError) {
    ASSERT_TRUE(write_exr(path("a.exr"), colours(29, 40), {1.0f, {}, {}}));
    const std::string bytes = text_of(path("a.exr"));
    ASSERT_GT(bytes.size(), 1000u);
    for (std::size_t length = 0; length < bytes.size(); length += 1 + length / 97) {
        write(path("cut.exr"), bytes.substr(0, length));
        EXPECT_FALSE(read_exr(path("cut.exr"))) << length << " of " << bytes.size() << " bytes";
    }
    write(path("cut.exr"), bytes.substr(0, bytes.size() - 1));
    EXPECT_FALSE(read_exr(path("cut.exr")));
}

void put_int(std::string& bytes, std::size_t at, std::int32_t value) { std::memcpy(&bytes[at], &value, 4); }

TEST_F(ImageIo, AHugeHeaderIsRefusedBeforeMemoryIsTaken) {
    ASSERT_TRUE(write_exr(path("a.exr"), colours(4, 4)));
    const std::string good = text_of(path("a.exr"));
    for (const char* name : {"dataWindow", "displayWindow"}) {
        const std::size_t values = good.find(name) + std::strlen(name) + 1 + std::strlen("box2i") + 1 + 4;
        for (const std::int32_t far : {2147483647, 1000000, 20000}) {
            std::string bytes = good;
            put_int(bytes, values + 8, far);
            put_int(bytes, values + 12, far);
            write(path("huge.exr"), bytes);
            expect_error(path("huge.exr"), "million pixels");
        }
        std::string bytes = good;
        put_int(bytes, values + 8, -5);
        write(path("huge.exr"), bytes);
        expect_error(path("huge.exr"), "empty");
    }
}

// Damage anywhere: any answer but a crash, a hang or a huge allocation.
TEST_F(ImageIo, RandomDamageIsSurvived) {
    ASSERT_TRUE(write_exr(path("a.exr"), colours(29, 40), {1.0f, {{"who", "me"}}, {}}));
    const std::string good = text_of(path("a.exr"));
    for (std::uint64_t round = 0; round < 200; ++round) {
        std::string bytes = good;
        for (std::uint64_t i = 0; i < 1 + round % 4; ++i) {
            const std::size_t reach = round % 2 ? bytes.size() : std::size_t(400);  // half of the rounds: the header
            bytes[std::size_t(uniform01(round, 2 * i) * static_cast<double>(reach))] = static_cast<char>(mix64(round * 16 + i));
        }
        write(path("damaged.exr"), bytes);
        const auto result = read_exr(path("damaged.exr"));
        EXPECT_TRUE(result || !result.error().message.empty());
    }
}

TEST_F(ImageIo, RandomBytesAreNoPicture) {
    for (std::uint64_t round = 0; round < 50; ++round) {
        std::string bytes = round % 2 ? std::string("\x76\x2f\x31\x01\x02\x00\x00\x00", 8) : std::string();
        for (std::uint64_t i = 0; i < 500; ++i) bytes.push_back(static_cast<char>(mix64(round << 32 | i)));
        write(path("random.exr"), bytes);
        EXPECT_FALSE(read_exr(path("random.exr")));
    }
}

TEST_F(ImageIo, AFolderThatIsNotThereCannotBeWritten) {
    const auto exr = write_exr(path("nowhere/a.exr"), colours(2, 2));
    ASSERT_FALSE(exr);
    EXPECT_NE(exr.error().message.find("nowhere"), std::string::npos);
    EXPECT_FALSE(write_png(path("nowhere/a.png"), Image8(2, 2, 3)));
    EXPECT_FALSE(write_exr(path("a.exr"), ImageF(2, 2, 2)));
    EXPECT_FALSE(write_exr(path("a.exr"), ImageF()));
    EXPECT_FALSE(write_png(path("a.png"), Image8()));
}

TEST_F(ImageIo, PngComesBackToTheBit) {
    for (const int channels : {1, 3, 4}) {
        Image8 image(13, 7, channels);
        for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<std::uint8_t>(mix64(i));
        ASSERT_TRUE(write_png(path("a.png"), image));
        const auto back = read_png(path("a.png"));
        ASSERT_TRUE(back) << back.error().message;
        EXPECT_EQ(back->channels, channels);
        EXPECT_EQ(back->data, image.data);
    }
}

TEST_F(ImageIo, ABadPngIsAnError) {
    EXPECT_FALSE(read_png(path("absent.png")));
    ASSERT_TRUE(write_png(path("a.png"), Image8(64, 64, 3, 77)));
    const std::string bytes = text_of(path("a.png"));
    for (std::size_t length = 0; length + 12 < bytes.size(); length += 3) {
        write(path("cut.png"), bytes.substr(0, length));
        EXPECT_FALSE(read_png(path("cut.png"))) << length;
    }
}

}  // namespace
}  // namespace entoptic
