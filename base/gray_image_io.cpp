#include "base/gray_image_io.h"

#include "base/image_io.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <turbojpeg.h>
#include <vector>

namespace entoptic {

namespace {

constexpr std::uintmax_t max_file_bytes = 256u << 20;

Error broken(const std::string& path, const std::string& why) {
    return {ErrorKind::failed, fmt::format("Cannot read '{}': {}", path, why)};
}

// BT.601, in 1/256.
std::uint8_t luma(const std::uint8_t* rgb) { return static_cast<std::uint8_t>((77 * rgb[0] + 150 * rgb[1] + 29 * rgb[2] + 128) >> 8); }

Image8 gray_of(const Image8& image) {
    if (image.channels == 1) return image;
    Image8 gray(image.width, image.height, 1);
    for (std::size_t i = 0; i < gray.data.size(); ++i) gray.data[i] = luma(&image.data[i * static_cast<std::size_t>(image.channels)]);
    return gray;
}

Result<Image8> read_pgm(const std::string& path) {
    int width = 0, height = 0, format = TJPF_GRAY;
    const std::unique_ptr<unsigned char, decltype(&tjFree)> pixels(tjLoadImage(path.c_str(), &width, 1, &height, &format, 0), &tjFree);
    if (!pixels) return forward_error(broken(path, fmt::format("{}.", tjGetErrorStr2(nullptr))));
    if (format != TJPF_GRAY) return forward_error(broken(path, "it has colours; convert it to a grey PGM first."));
    Image8 image(width, height, 1);
    std::memcpy(image.data.data(), pixels.get(), image.data.size());
    return image;
}

Result<Image8> read_jpeg(const std::string& path, std::ifstream& in) {
    const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    JpegLumaDecoder decoder;
    Image8 image;
    if (auto done = decoder.decode({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, image); !done)
        return forward_error(broken(path, done.error().message));
    return image;
}

}  // namespace

struct JpegLumaDecoder::Handle {
    tjhandle decoder = tjInitDecompress();
    Handle() = default;
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
        if (decoder) tjDestroy(decoder);
    }
    Result<void> decode(std::span<const std::uint8_t> jpeg, Image8& image);
};

Result<void> JpegLumaDecoder::Handle::decode(std::span<const std::uint8_t> jpeg, Image8& image) {
    const auto size = static_cast<unsigned long>(jpeg.size());
    int width = 0, height = 0, subsampling = 0, colours = 0;
    if (tjDecompressHeader3(decoder, jpeg.data(), size, &width, &height, &subsampling, &colours) != 0)
        return failure(fmt::format("not a JPEG picture: {}.", tjGetErrorStr2(decoder)));
    if (width > max_gray_side || height > max_gray_side)
        return failure(fmt::format("{} x {} pixels; at most {} each way are accepted.", width, height, max_gray_side));
    image.width = width;
    image.height = height;
    image.channels = 1;
    image.data.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    if (tjDecompress2(decoder, jpeg.data(), size, image.data.data(), width, width, height, TJPF_GRAY, TJFLAG_STOPONWARNING) != 0)
        return failure(fmt::format("a corrupt JPEG picture: {}.", tjGetErrorStr2(decoder)));
    return {};
}

JpegLumaDecoder::JpegLumaDecoder() : handle_(std::make_unique<Handle>()) {}
JpegLumaDecoder::~JpegLumaDecoder() = default;
JpegLumaDecoder::JpegLumaDecoder(JpegLumaDecoder&&) noexcept = default;
JpegLumaDecoder& JpegLumaDecoder::operator=(JpegLumaDecoder&&) noexcept = default;

Result<void> JpegLumaDecoder::decode(std::span<const std::uint8_t> jpeg, Image8& image) {
    if (!handle_->decoder) return failure("libturbojpeg has no memory for a decoder.");
    auto done = handle_->decode(jpeg, image);
    // A decoder that met an error in a header goes on in the middle of it with the next picture (libjpeg-turbo 2.1.5): begin anew.
    if (!done) handle_ = std::make_unique<Handle>();
    return done;
}

Result<Image8> read_gray(const std::string& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error)) return forward_error(broken(path, "it is a folder. Name pictures: FOLDER/*.png."));
    std::ifstream in(path, std::ios::binary);
    if (!in) return forward_error(broken(path, fmt::format("{}. Check the name and the permissions.", std::strerror(errno))));
    if (std::filesystem::file_size(path, error) > max_file_bytes) return forward_error(broken(path, "it is larger than 256 MiB."));
    std::array<unsigned char, 2> magic{};
    in.read(reinterpret_cast<char*>(magic.data()), magic.size());
    in.clear();
    in.seekg(0);
    if (magic[0] == 0xFF && magic[1] == 0xD8) return read_jpeg(path, in);
    if (magic[0] == 0x89 && magic[1] == 'P') {
        ENTOPTIC_TRY(image, read_png(path));
        return gray_of(image);
    }
    if (magic[0] == 'P' && (magic[1] == '2' || magic[1] == '5')) return read_pgm(path);
    return forward_error(broken(path, "it is neither PGM, PNG nor JPEG. Convert it to one of them first."));
}

}  // namespace entoptic
