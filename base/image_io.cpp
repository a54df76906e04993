#include "base/image_io.h"

#include <ImfChannelList.h>
#include <ImfChromaticities.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfRgbaYca.h>
#include <ImfStandardAttributes.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <png.h>
#include <span>

namespace entoptic {
namespace {

// ---- What the header says, read by hand first: OpenEXR allocates from these numbers before anyone can check them. -------------

struct HeaderSizes {
    Imath::Box2i data_window{Imath::V2i(0), Imath::V2i(-1)}, display_window{Imath::V2i(0), Imath::V2i(-1)};
};

constexpr std::uint32_t exr_magic = 20000630;
constexpr std::uint32_t exr_deep_flag = 0x800, exr_multipart_flag = 0x1000;
constexpr std::streamoff longest_name = 256;
constexpr std::uint32_t longest_attribute = 64u << 20;

Error broken(const std::string& path, const std::string& why) {
    return {ErrorKind::failed, fmt::format("Cannot read '{}': {}", path, why)};
}
constexpr const char* cut_short = "the file is cut short. Copy or render it again.";

class HeaderScan {
public:
    explicit HeaderScan(const std::string& path) : path_(path), in_(path, std::ios::binary) {}

    Result<HeaderSizes> run() {
        std::error_code error;
        if (std::filesystem::is_directory(path_, error)) return forward_error(broken(path_, "it is a folder. Name an OpenEXR file."));
        if (!in_) return forward_error(broken(path_, fmt::format("{}. Check the name and the permissions.", std::strerror(errno))));
        const auto magic = number<std::uint32_t>();
        if (!in_ || magic != exr_magic)
            return forward_error(broken(path_, "it is not an OpenEXR file. Convert the picture to OpenEXR first."));
        const auto version = number<std::uint32_t>();
        if (version & exr_deep_flag) return forward_error(broken(path_, "it holds deep data, not an image. Flatten it first."));
        if (version & exr_multipart_flag)
            return forward_error(broken(path_, "it has several parts. Split it first, for example with 'exrmultipart -separate'."));
        return attributes();
    }

private:
    Result<HeaderSizes> attributes() {
        HeaderSizes sizes;
        for (std::string name = text(); in_ && !name.empty(); name = text()) {
            const std::string type = text();
            const auto bytes = number<std::uint32_t>();
            if (!in_) break;
            if (bytes > longest_attribute)
                return forward_error(broken(path_, fmt::format("its attribute '{}' claims {} bytes.", name, bytes)));
            const auto start = in_.tellg();
            if (type == "box2i" && name == "dataWindow") sizes.data_window = box();
            if (type == "box2i" && name == "displayWindow") sizes.display_window = box();
            if (type == "tiledesc") ENTOPTIC_CHECK(check_tiles());
            if (type == "preview") ENTOPTIC_CHECK(check_preview(bytes));
            in_.seekg(start + std::streamoff(bytes));
        }
        if (!in_ || in_.peek() == std::char_traits<char>::eof()) return forward_error(broken(path_, cut_short));
        ENTOPTIC_CHECK(check_window("dataWindow", sizes.data_window));
        ENTOPTIC_CHECK(check_window("displayWindow", sizes.display_window));
        return sizes;
    }
    Result<void> check_window(const char* name, const Imath::Box2i& box) {
        const std::int64_t width = std::int64_t(box.max.x) - box.min.x + 1, height = std::int64_t(box.max.y) - box.min.y + 1;
        if (width < 1 || height < 1) return forward_error(broken(path_, fmt::format("its {} is empty or missing.", name)));
        if (width > max_image_pixels || height > max_image_pixels || width * height > max_image_pixels)
            return forward_error(
                broken(path_, fmt::format("its {} says {} x {} pixels; at most {} million pixels are accepted. Scale it down.", name, width,
                                          height, max_image_pixels / 1'000'000)));
        constexpr int far = 1 << 30;
        if (box.min.x < -far || box.min.y < -far || box.max.x > far || box.max.y > far)
            return forward_error(broken(path_, fmt::format("its {} lies outside what OpenEXR can address.", name)));
        return {};
    }
    Result<void> check_tiles() {
        const auto x = number<std::uint32_t>(), y = number<std::uint32_t>();
        if (x < 1 || y < 1 || std::uint64_t(x) * y > std::uint64_t(max_image_pixels))
            return forward_error(broken(path_, fmt::format("its tiles claim {} x {} pixels.", x, y)));
        return {};
    }
    Result<void> check_preview(std::uint32_t bytes) {
        const auto x = number<std::uint32_t>(), y = number<std::uint32_t>();
        if (std::uint64_t(x) * y * 4 + 8 != bytes) return forward_error(broken(path_, "its preview picture has the wrong size."));
        return {};
    }
    Imath::Box2i box() {
        std::array<std::int32_t, 4> v{};
        for (auto& x : v) x = static_cast<std::int32_t>(number<std::uint32_t>());
        return {Imath::V2i(v[0], v[1]), Imath::V2i(v[2], v[3])};
    }
    template <class T> T number() {  // little endian
        T value = 0;
        for (unsigned i = 0; i < sizeof(T); ++i) value |= static_cast<T>(static_cast<T>(in_.get() & 0xff) << (8 * i));
        return value;
    }
    std::string text() {
        std::string s;
        for (int c = in_.get(); in_ && c != 0; c = in_.get()) {
            s.push_back(static_cast<char>(c));
            if (s.size() > longest_name) in_.setstate(std::ios::failbit);
        }
        return s;
    }

    std::string path_;
    std::ifstream in_;
};

// ---- Channels -----------------------------------------------------------------------------------------------------------------

std::string channel_names(const Imf::ChannelList& channels) {
    std::string names;
    for (auto i = channels.begin(); i != channels.end(); ++i) names += fmt::format("{}{}", names.empty() ? "" : ", ", i.name());
    return names;
}

// The channel `name` at full size, brought up from its own sampling by Catmull-Rom's cubic (co-sited samples).
class Plane {
public:
    Plane(const Imf::Channel& channel, int width, int height)
        : step_x_(std::max(1, channel.xSampling)),
          step_y_(std::max(1, channel.ySampling)),
          samples_(width / step_x_, height / step_y_, 1) {}

    Imf::Slice slice(const Imath::Box2i& window) {
        return Imf::Slice::Make(Imf::FLOAT, samples_.data.data(), window, sizeof(float), sizeof(float) * std::size_t(samples_.width),
                                step_x_, step_y_);
    }
    float at(int x, int y) const {
        if (step_x_ == 1 && step_y_ == 1) return samples_.at(x, y, 0);
        const auto wx = cubic(x, step_x_), wy = cubic(y, step_y_);
        float sum = 0;
        for (int j = 0; j < 4; ++j) {
            if (wy[std::size_t(j)] == 0) continue;
            for (int i = 0; i < 4; ++i)
                if (wx[std::size_t(i)] != 0)
                    sum += wx[std::size_t(i)] * wy[std::size_t(j)] * sample(x / step_x_ + i - 1, y / step_y_ + j - 1);
        }
        return sum;
    }

private:
    static std::array<float, 4> cubic(int position, int step) {
        const float t = float(position % step) / float(step);
        return {0.5f * t * (t * (2 - t) - 1), 0.5f * (t * t * (3 * t - 5) + 2), 0.5f * t * (t * (4 - 3 * t) + 1), 0.5f * t * t * (t - 1)};
    }
    float sample(int x, int y) const { return samples_.at(std::clamp(x, 0, samples_.width - 1), std::clamp(y, 0, samples_.height - 1), 0); }

    int step_x_, step_y_;
    ImageF samples_;
};

// Throws what OpenEXR throws.
ImageF read_planes(Imf::InputFile& file, const Imath::Box2i& window, const std::vector<std::string>& names, std::vector<Plane>& planes) {
    const Imf::ChannelList& channels = file.header().channels();
    const int width = window.max.x - window.min.x + 1, height = window.max.y - window.min.y + 1;
    Imf::FrameBuffer frame;
    for (const std::string& name : names) planes.emplace_back(channels[name.c_str()], width, height);
    for (std::size_t i = 0; i < names.size(); ++i) frame.insert(names[i], planes[i].slice(window));
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    return {width, height, 3};
}

bool full_size(const Imf::ChannelList& channels, const std::vector<std::string>& names) {
    return std::all_of(names.begin(), names.end(),
                       [&](const std::string& n) { return channels[n.c_str()].xSampling == 1 && channels[n.c_str()].ySampling == 1; });
}

ImageF read_rgb(Imf::InputFile& file, const Imath::Box2i& window) {
    const std::vector<std::string> names{"R", "G", "B"};
    if (!full_size(file.header().channels(), names)) {
        std::vector<Plane> planes;
        ImageF rgb = read_planes(file, window, names, planes);
        for (int y = 0; y < rgb.height; ++y)
            for (int x = 0; x < rgb.width; ++x)
                for (int c = 0; c < 3; ++c) rgb.at(x, y, c) = planes[std::size_t(c)].at(x, y);
        return rgb;
    }
    ImageF rgb(window.max.x - window.min.x + 1, window.max.y - window.min.y + 1, 3);
    Imf::FrameBuffer frame;
    const std::size_t pixel = 3 * sizeof(float);
    for (std::size_t c = 0; c < 3; ++c)
        frame.insert(names[c], Imf::Slice::Make(Imf::FLOAT, rgb.data.data() + c, window, pixel, pixel * std::size_t(rgb.width)));
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    return rgb;
}

ImageF read_grey(Imf::InputFile& file, const Imath::Box2i& window) {
    std::vector<Plane> planes;
    ImageF rgb = read_planes(file, window, {"Y"}, planes);
    for (int y = 0; y < rgb.height; ++y)
        for (int x = 0; x < rgb.width; ++x) rgb.at(x, y, 0) = rgb.at(x, y, 1) = rgb.at(x, y, 2) = planes[0].at(x, y);
    return rgb;
}

Imf::Chromaticities chromaticities_of(const Imf::Header& header) {
    return Imf::hasChromaticities(header) ? Imf::chromaticities(header) : Imf::Chromaticities();
}

// Y, RY = (R-Y)/Y, BY = (B-Y)/Y (OpenEXR, "Luminance/Chroma Images"), in float: the library's own reader goes through half.
ImageF read_luminance_chroma(Imf::InputFile& file, const Imath::Box2i& window) {
    std::vector<Plane> planes;
    ImageF rgb = read_planes(file, window, {"Y", "RY", "BY"}, planes);
    const Imath::V3f weight = Imf::RgbaYca::computeYw(chromaticities_of(file.header()));
    for (int y = 0; y < rgb.height; ++y)
        for (int x = 0; x < rgb.width; ++x) {
            const float luminance = planes[0].at(x, y);
            const float red = (planes[1].at(x, y) + 1) * luminance, blue = (planes[2].at(x, y) + 1) * luminance;
            rgb.at(x, y, 0) = red;
            rgb.at(x, y, 1) = (luminance - red * weight.x - blue * weight.z) / weight.y;
            rgb.at(x, y, 2) = blue;
        }
    return rgb;
}

// Z, where it is a distance beside a colour: with X and Y, it is a colour itself.
ImageF read_depth(Imf::InputFile& file, const Imath::Box2i& window) {
    const Imf::ChannelList& channels = file.header().channels();
    if (!channels.findChannel("Z") || channels.findChannel("X") || !full_size(channels, {"Z"})) return {};
    std::vector<Plane> planes;
    const ImageF size = read_planes(file, window, {"Z"}, planes);
    ImageF depth(size.width, size.height, 1);
    for (int y = 0; y < depth.height; ++y)
        for (int x = 0; x < depth.width; ++x) depth.at(x, y, 0) = planes[0].at(x, y);
    return depth;
}

Result<ImageF> read_channels(Imf::InputFile& file, const Imath::Box2i& window, const std::string& path) {
    const Imf::ChannelList& channels = file.header().channels();
    const auto has = [&](const char* name) { return channels.findChannel(name) != nullptr; };
    if (has("R") && has("G") && has("B")) return read_rgb(file, window);
    if (has("Y") && has("RY") && has("BY")) return read_luminance_chroma(file, window);
    if (has("Y") && !has("X") && !has("Z")) return read_grey(file, window);
    return forward_error(
        broken(path, fmt::format("it has no colour: the channels are {}; wanted are R, G, B or Y or Y, RY, BY.", channel_names(channels))));
}

// ---- From what the file holds to what its viewer should see ----------------------------------------------------------------------

// Light in other primaries (attribute chromaticities) as light in BT.709 primaries; the colour of the light stays what it is.
void to_bt709(ImageF& rgb, const Imf::Chromaticities& from) {
    const Imf::Chromaticities bt709;
    const auto near = [](const Imath::V2f& a, const Imath::V2f& b) { return (a - b).length() < 2e-3f; };
    if (near(from.red, bt709.red) && near(from.green, bt709.green) && near(from.blue, bt709.blue) && near(from.white, bt709.white)) return;
    const Imath::M44f matrix = Imf::RGBtoXYZ(from, 1) * Imf::XYZtoRGB(bt709, 1);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!std::isfinite(matrix[i][j])) throw std::runtime_error("its chromaticities describe no colour space");
    for (std::size_t i = 0; i < rgb.data.size(); i += 3) {
        const Imath::V3f c = Imath::V3f(rgb.data[i], rgb.data[i + 1], rgb.data[i + 2]) * matrix;
        rgb.data[i] = c.x;
        rgb.data[i + 1] = c.y;
        rgb.data[i + 2] = c.z;
    }
}

// The display window is the picture; where there are no data it is black.
ImageF place(ImageF&& data, const Imath::Box2i& window, const Imath::Box2i& display) {
    if (window == display) return std::move(data);
    const int channels = data.channels;
    ImageF out(display.max.x - display.min.x + 1, display.max.y - display.min.y + 1, channels);
    const int left = std::max(window.min.x, display.min.x), right = std::min(window.max.x, display.max.x);
    if (left > right) return out;
    for (int y = std::max(window.min.y, display.min.y); y <= std::min(window.max.y, display.max.y); ++y)
        std::copy_n(&data.at(left - window.min.x, y - window.min.y, 0), channels * (right - left + 1),
                    &out.at(left - display.min.x, y - display.min.y, 0));
    return out;
}

void read_attributes(const Imf::Header& header, ExrImage& image) {
    if (Imf::hasWhiteLuminance(header)) image.white_luminance = Imf::whiteLuminance(header);
    for (auto i = header.begin(); i != header.end(); ++i)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&i.attribute())) image.text[i.name()] = text->value();
}

Result<ExrImage> read_checked(const std::string& path, const HeaderSizes& sizes) {
    Imf::InputFile file(path.c_str(), 1);
    if (!file.isComplete()) return forward_error(broken(path, cut_short));
    ENTOPTIC_TRY(rgb, read_channels(file, sizes.data_window, path));
    to_bt709(rgb, chromaticities_of(file.header()));
    ExrImage image;
    image.rgb = place(std::move(rgb), sizes.data_window, sizes.display_window);
    if (ImageF depth = read_depth(file, sizes.data_window); !depth.data.empty())
        image.depth = place(std::move(depth), sizes.data_window, sizes.display_window);
    read_attributes(file.header(), image);
    return image;
}

Error cannot_write(const std::string& path, const std::string& why) {
    return {ErrorKind::failed, fmt::format("Cannot write '{}': {}. Check that the folder exists, may be written and has room.", path, why)};
}

void write_exr_file(const std::string& path, const ImageF& image, const ExrAttributes& attributes, const ImageF& depth) {
    Imf::Header header(image.width, image.height);
    header.compression() = Imf::ZIP_COMPRESSION;
    if (attributes.white_luminance) Imf::addWhiteLuminance(header, *attributes.white_luminance);
    for (const auto& [name, value] : attributes.text) header.insert(name, Imf::StringAttribute(value));
    for (const auto& [name, value] : attributes.numbers) header.insert(name, Imf::FloatAttribute(value));
    const std::array<const char*, 3> names = image.channels == 3 ? std::array{"R", "G", "B"} : std::array{"Y", "", ""};
    Imf::FrameBuffer frame;
    const std::size_t pixel = sizeof(float) * std::size_t(image.channels);
    for (int c = 0; c < image.channels; ++c) {
        header.channels().insert(names[std::size_t(c)], Imf::Channel(Imf::FLOAT));
        char* base = reinterpret_cast<char*>(const_cast<float*>(image.data.data() + c));
        frame.insert(names[std::size_t(c)], Imf::Slice(Imf::FLOAT, base, pixel, pixel * std::size_t(image.width)));
    }
    if (!depth.data.empty()) {
        header.channels().insert("Z", Imf::Channel(Imf::FLOAT));
        char* base = reinterpret_cast<char*>(const_cast<float*>(depth.data.data()));
        frame.insert("Z", Imf::Slice(Imf::FLOAT, base, sizeof(float), sizeof(float) * std::size_t(depth.width)));
    }
    Imf::OutputFile file(path.c_str(), header, 1);
    file.setFrameBuffer(frame);
    file.writePixels(image.height);
}

std::optional<png_uint_32> png_format(int channels) {
    if (channels == 1) return PNG_FORMAT_GRAY;
    if (channels == 3) return PNG_FORMAT_RGB;
    if (channels == 4) return PNG_FORMAT_RGBA;
    return std::nullopt;
}

// libpng's simplified interface: errors come back as codes, never through longjmp.
struct PngImage {
    png_image image{};
    PngImage() { image.version = PNG_IMAGE_VERSION; }
    ~PngImage() { png_image_free(&image); }
    PngImage(const PngImage&) = delete;
    PngImage& operator=(const PngImage&) = delete;
};

template <class T> bool whole(const Image<T>& image) {
    return image.width > 0 && image.height > 0 && image.channels > 0 &&
           image.data.size() == std::size_t(image.width) * std::size_t(image.height) * std::size_t(image.channels);
}

}  // namespace

Result<ExrImage> read_exr(const std::string& path) {
    ENTOPTIC_TRY(sizes, HeaderScan(path).run());
    try {
        return read_checked(path, sizes);
    } catch (const std::bad_alloc&) {
        return forward_error(broken(path, "there is not enough memory for it. Scale it down."));
    } catch (const std::exception& e) {
        return forward_error(broken(path, fmt::format("the file is damaged or cut short ({}).", e.what())));
    }
}

Result<void> write_exr(const std::string& path, const ImageF& image, const ExrAttributes& attributes, const ImageF& depth) {
    if (!whole(image) || (image.channels != 1 && image.channels != 3))
        return forward_error(
            cannot_write(path, fmt::format("an image of {} x {} with {} channels", image.width, image.height, image.channels)));
    if (!depth.data.empty() && (!whole(depth) || depth.channels != 1 || depth.width != image.width || depth.height != image.height))
        return forward_error(cannot_write(path, "a depth of another size than its picture"));
    try {
        write_exr_file(path, image, attributes, depth);
        return {};
    } catch (const std::exception& e) { return forward_error(cannot_write(path, e.what())); }
}

Result<void> write_png(const std::string& path, const Image8& image) {
    const auto format = png_format(image.channels);
    if (!whole(image) || !format)
        return forward_error(
            cannot_write(path, fmt::format("an image of {} x {} with {} channels", image.width, image.height, image.channels)));
    PngImage png;
    png.image.width = png_uint_32(image.width);
    png.image.height = png_uint_32(image.height);
    png.image.format = *format;
    if (!png_image_write_to_file(&png.image, path.c_str(), 0, image.data.data(), 0, nullptr))
        return forward_error(cannot_write(path, png.image.message));
    return {};
}

Result<Image8> read_png(const std::string& path) {
    PngImage png;
    if (!png_image_begin_read_from_file(&png.image, path.c_str()))
        return forward_error(broken(path, fmt::format("it is no PNG, or empty or cut short (libpng: {}).", png.image.message)));
    const std::int64_t pixels = std::int64_t(png.image.width) * std::int64_t(png.image.height);
    if (pixels > max_image_pixels)
        return forward_error(broken(path, fmt::format("it has {} x {} pixels; at most {} million are accepted.", png.image.width,
                                                      png.image.height, max_image_pixels / 1'000'000)));
    const bool colour = png.image.format & PNG_FORMAT_FLAG_COLOR, alpha = png.image.format & PNG_FORMAT_FLAG_ALPHA;
    png.image.format = alpha ? PNG_FORMAT_RGBA : colour ? PNG_FORMAT_RGB : PNG_FORMAT_GRAY;
    Image8 image(int(png.image.width), int(png.image.height), alpha ? 4 : colour ? 3 : 1);
    if (!png_image_finish_read(&png.image, nullptr, image.data.data(), 0, nullptr))
        return forward_error(broken(path, fmt::format("it is no PNG, or empty or cut short (libpng: {}).", png.image.message)));
    return image;
}

}  // namespace entoptic
