#include "samples/common/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>

#include <ImfArray.h>
#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfPartType.h>
#include <ImfRgbaFile.h>
#include <ImfStandardAttributes.h>
#include <ImfTestFile.h>
#include <fmt/format.h>
#include <png.h>

#include "samples/common/failure.h"

namespace samples {

// ---- reading --------------------------------------------------------------------------------------------------------------------

static Failure cannot_read(const std::string& path, const std::string& why) {
    return {ExitCode::failed, fmt::format("cannot read {}: {}", path, why)};
}

static void check_is_openexr(const std::string& path) {
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status)) { throw cannot_read(path, "there is no such file"); }
    if (std::filesystem::is_directory(status)) { throw cannot_read(path, "it is a folder"); }
    bool tiled = false, deep = false, multi_part = false;
    if (!Imf::isOpenExrFile(path.c_str(), tiled, deep, multi_part)) {
        throw cannot_read(path, "it is no OpenEXR file, or it may not be opened");
    }
    if (deep) { throw cannot_read(path, "it holds deep data: flatten it first"); }
}

static glm::uvec2 checked_size(const std::string& path, const Imath::Box2i& window, std::uint32_t largest_side) {
    const std::int64_t width = std::int64_t{window.max.x} - window.min.x + 1;
    const std::int64_t height = std::int64_t{window.max.y} - window.min.y + 1;
    if (width <= 0 || height <= 0) { throw cannot_read(path, "its data window is empty"); }
    if (width > largest_side || height > largest_side) {
        throw cannot_read(path, fmt::format("it is {} x {} pixels and this device draws images up to {} a side: scale it down", width,
                                            height, largest_side));
    }
    return {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height)};
}

// Reads channels as float into one field each of the pixels. Absent channels stay as they are.
static void read_channels(Imf::InputFile& file, const std::array<const char*, 3>& names, Picture& picture) {
    const Imath::Box2i window = file.header().dataWindow();
    const std::size_t x_stride = sizeof(glm::vec3);
    const std::size_t y_stride = x_stride * picture.width;
    Imf::FrameBuffer frame;
    for (int i = 0; i < 3; ++i) {
        auto* first = reinterpret_cast<char*>(&picture.pixels[0][i]);
        char* origin = first - static_cast<std::ptrdiff_t>(x_stride) * window.min.x - static_cast<std::ptrdiff_t>(y_stride) * window.min.y;
        frame.insert(names.at(static_cast<std::size_t>(i)), Imf::Slice(Imf::FLOAT, origin, x_stride, y_stride));
    }
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
}

// Luminance-chroma files store chroma at half resolution; the library's RGBA interface reconstructs it.
static void read_luminance_chroma(const std::string& path, Picture& picture) {
    Imf::RgbaInputFile file(path.c_str());
    const Imath::Box2i window = file.dataWindow();
    std::vector<Imf::Rgba> pixels(picture.pixels.size());
    file.setFrameBuffer(pixels.data() - window.min.x - std::ptrdiff_t{window.min.y} * picture.width, 1, picture.width);
    file.readPixels(window.min.y, window.max.y);
    std::transform(pixels.begin(), pixels.end(), picture.pixels.begin(),
                   [](const Imf::Rgba& p) { return glm::vec3(float(p.r), float(p.g), float(p.b)); });
}

static void convert_to_rec709(const Imf::Header& header, Picture& picture) {
    if (!Imf::hasChromaticities(header)) { return; }
    const Imf::Chromaticities rec709;
    const Imf::Chromaticities& given = Imf::chromaticities(header);
    const auto same = [](const Imath::V2f& a, const Imath::V2f& b) { return (a - b).length() < 1e-3F; };
    if (same(given.red, rec709.red) && same(given.green, rec709.green) && same(given.blue, rec709.blue) &&
        same(given.white, rec709.white)) {
        return;
    }
    // Row vectors: rgb * RGBtoXYZ = xyz. Both scale white to Y = 1, so the whiteLuminance stays what it is.
    const Imath::M44f m = Imf::RGBtoXYZ(given, 1) * Imf::XYZtoRGB(rec709, 1);
    for (glm::vec3& p : picture.pixels) {
        const Imath::V3f converted = Imath::V3f(p.x, p.y, p.z) * m;
        p = {converted.x, converted.y, converted.z};
    }
}

static bool all_half(const Imf::ChannelList& channels) {
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        if (channel.channel().type != Imf::HALF) { return false; }
    }
    return true;
}

static std::string names_of(const Imf::ChannelList& channels) {
    std::string names;
    for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
        names += names.empty() ? "" : ", ";
        names += channel.name();
    }
    return names;
}

// OpenEXR's exceptions may span lines and repeat the path; one line is enough.
static std::string first_line(std::string text) { return text.substr(0, text.find('\n')); }

static bool has_channel(const Imf::ChannelList& channels, const char* name) { return channels.findChannel(name) != nullptr; }

RadianceMap read_radiance_map(const std::string& path, std::uint32_t largest_side) {
    check_is_openexr(path);
    try {
        // Checked when the header is read: a damaged one must not make the library allocate without bound.
        Imf::Header::setMaxImageSize(1 << 20, 1 << 20);
        Imf::InputFile file(path.c_str());
        const Imf::Header& header = file.header();
        const Imf::ChannelList& channels = header.channels();
        const glm::uvec2 size = checked_size(path, header.dataWindow(), largest_side);
        RadianceMap map;
        map.half_precision = all_half(channels);
        map.picture = {size.x, size.y, std::vector<glm::vec3>(std::size_t{size.x} * size.y)};
        if (has_channel(channels, "R") && has_channel(channels, "G") && has_channel(channels, "B")) {
            read_channels(file, {"R", "G", "B"}, map.picture);
            convert_to_rec709(header, map.picture);
        } else if (has_channel(channels, "Y") && has_channel(channels, "RY")) {
            read_luminance_chroma(path, map.picture);
            convert_to_rec709(header, map.picture);
        } else if (has_channel(channels, "Y")) {
            read_channels(file, {"Y", "unused 1", "unused 2"}, map.picture);
            for (glm::vec3& p : map.picture.pixels) { p = glm::vec3(p.x); }
        } else {
            throw cannot_read(path, fmt::format("it has neither R, G and B nor Y, only: {}", names_of(channels)));
        }
        if (Imf::hasWhiteLuminance(header)) { map.white_luminance = Imf::whiteLuminance(header); }
        return map;
    } catch (const Failure&) { throw; } catch (const std::bad_alloc&) {
        throw cannot_read(path, "there is not enough memory for it");
    } catch (const std::exception& error) { throw cannot_read(path, "damaged or cut short (" + first_line(error.what()) + ")"); }
}

// ---- writing --------------------------------------------------------------------------------------------------------------------

void write_radiance_map(const std::string& path, const Picture& picture, float white_luminance) {
    try {
        Imf::Header header(static_cast<int>(picture.width), static_cast<int>(picture.height));
        header.compression() = Imf::ZIP_COMPRESSION;
        Imf::addWhiteLuminance(header, white_luminance);
        Imf::addChromaticities(header, Imf::Chromaticities());  // the defaults are Rec.709's, with D65
        Imf::FrameBuffer frame;
        constexpr std::array names{"R", "G", "B"};
        for (int i = 0; i < 3; ++i) {
            const char* name = names.at(static_cast<std::size_t>(i));
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
            auto* first = reinterpret_cast<char*>(const_cast<float*>(&picture.pixels[0][i]));
            frame.insert(name, Imf::Slice(Imf::FLOAT, first, sizeof(glm::vec3), sizeof(glm::vec3) * picture.width));
        }
        if (!picture.distances.empty()) {
            header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
            auto* first = reinterpret_cast<char*>(const_cast<float*>(picture.distances.data()));
            frame.insert("Z", Imf::Slice(Imf::FLOAT, first, sizeof(float), sizeof(float) * picture.width));
        }
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(static_cast<int>(picture.height));
    } catch (const std::exception& error) {
        throw Failure(ExitCode::failed, fmt::format("cannot write {}: {}", path, first_line(error.what())));
    }
}

static std::uint8_t preview_code(float value) {
    const float shoulder = value <= 0.8F ? value : 1.0F - 0.2F * std::exp(-(value - 0.8F) / 0.2F);
    const float linear = std::clamp(shoulder, 0.0F, 1.0F);
    const float encoded = linear <= 0.0031308F ? 12.92F * linear : 1.055F * std::pow(linear, 1.0F / 2.4F) - 0.055F;
    return static_cast<std::uint8_t>(encoded * 255.0F + 0.5F);
}

void write_preview(const std::string& path, const Picture& picture, float white) {
    std::vector<std::uint8_t> codes;
    codes.reserve(picture.pixels.size() * 3);
    for (const glm::vec3& pixel : picture.pixels) {
        for (int i = 0; i < 3; ++i) { codes.push_back(preview_code(pixel[i] / white)); }
    }
    png_image png{};
    png.version = PNG_IMAGE_VERSION;
    png.width = picture.width;
    png.height = picture.height;
    png.format = PNG_FORMAT_RGB;
    if (png_image_write_to_file(&png, path.c_str(), 0, codes.data(), 0, nullptr) == 0) {
        throw Failure(ExitCode::failed, fmt::format("cannot write {}: {}", path, png.message));
    }
}

}  // namespace samples
