#include "drivers/recording/recording.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

namespace entoptic::drivers {

namespace {

constexpr std::array<char, 8> magic{'E', 'N', 'T', 'R', 'E', 'C', '1', '\n'};
constexpr std::size_t header_bytes = 16;  // u32 length of the payload, u16 stream, u16 zero, i64 time
constexpr std::size_t sum_bytes = 4;      // CRC-32 of header and payload
constexpr DurationNs flush_every = 100'000'000;

void put(std::uint8_t* at, std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) at[i] = static_cast<std::uint8_t>(value >> (8 * i));
}
std::uint64_t get(const std::uint8_t* at, int bytes) {
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) value |= static_cast<std::uint64_t>(at[i]) << (8 * i);
    return value;
}

std::uint32_t check_sum(std::span<const std::uint8_t> header, std::span<const std::uint8_t> payload) {
    const uLong first = crc32(0, header.data(), static_cast<uInt>(header.size()));
    return static_cast<std::uint32_t>(payload.empty() ? first : crc32(first, payload.data(), static_cast<uInt>(payload.size())));
}

}  // namespace

Result<std::unique_ptr<RecordingWriter>> RecordingWriter::create(const std::string& path, const std::string& description, TimeNs time) {
    const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (descriptor < 0)
        return failure(fmt::format("{} cannot be made: {}. {}", path, std::strerror(errno),
                                   errno == EEXIST ? "Recordings are never overwritten; choose another name." : "Choose another place."));
    std::FILE* file = fdopen(descriptor, "wb");
    std::unique_ptr<RecordingWriter> writer(new RecordingWriter(file, path));
    if (std::fwrite(magic.data(), 1, magic.size(), file) != magic.size()) writer->failed_ = true;
    writer->add(Stream::description, time, description);
    return writer;
}

RecordingWriter::~RecordingWriter() { (void)close(); }

void RecordingWriter::add(Stream stream, TimeNs time, const std::string& text) {
    add(stream, time, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

void RecordingWriter::add(Stream stream, TimeNs time, std::span<const std::uint8_t> payload) {
    std::array<std::uint8_t, header_bytes> header{};
    std::array<std::uint8_t, sum_bytes> sum{};
    put(&header[0], payload.size(), 4);
    put(&header[4], static_cast<std::uint64_t>(stream), 2);
    put(&header[8], static_cast<std::uint64_t>(time), 8);
    put(sum.data(), check_sum(header, payload), 4);
    const std::lock_guard lock(mutex_);
    if (!file_ || payload.size() > max_record_bytes) {
        failed_ = true;
        return;
    }
    const auto write = [&](const void* data, std::size_t bytes) { failed_ |= std::fwrite(data, 1, bytes, file_) != bytes; };
    write(header.data(), header.size());
    write(payload.data(), payload.size());
    write(sum.data(), sum.size());
    if (time - flushed_ > flush_every || time < flushed_) {
        failed_ |= std::fflush(file_) != 0;
        flushed_ = time;
    }
}

Result<void> RecordingWriter::close() {
    const std::lock_guard lock(mutex_);
    if (!file_) return {};
    failed_ |= std::fclose(file_) != 0;
    file_ = nullptr;
    if (failed_) return failure(fmt::format("{} could not be written whole; the disk may be full. What is in it can be read.", path_));
    return {};
}

Result<RecordingReader> RecordingReader::open(const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "rbe");
    struct stat info {};
    if (!file || fstat(fileno(file), &info) != 0 || !S_ISREG(info.st_mode)) {
        const std::string why = file ? "it is no file" : std::strerror(errno);
        if (file) std::fclose(file);
        return failure(fmt::format("The recording {} cannot be read: {}.", path, why));
    }
    RecordingReader reader(file);
    reader.size_ = static_cast<std::uint64_t>(info.st_size);
    std::array<char, magic.size()> begin{};
    if (std::fread(begin.data(), 1, begin.size(), file) != begin.size() || std::memcmp(begin.data(), magic.data(), 6) != 0)
        return failure(fmt::format("{} is no recording of Entoptic.", path));
    if (begin != magic) return failure(fmt::format("{} is of another version of Entoptic ({}); use that one.", path, begin[6]));
    reader.at_ = magic.size();
    const auto first = reader.next();
    if (!first || first->stream != Stream::description)
        return failure(fmt::format("{} has no description: it was cut at its very beginning.", path));
    reader.description_.assign(first->payload.begin(), first->payload.end());
    return reader;
}

std::optional<Record> RecordingReader::next() {
    std::array<std::uint8_t, header_bytes> header{};
    std::array<std::uint8_t, sum_bytes> sum{};
    lost_bytes_ = size_ - std::min(size_, at_);
    if (std::fread(header.data(), 1, header.size(), file_.get()) != header.size()) return std::nullopt;
    const std::uint64_t length = get(&header[0], 4);
    if (length > max_record_bytes) return std::nullopt;
    Record record;
    record.stream = static_cast<Stream>(get(&header[4], 2));
    record.time = static_cast<TimeNs>(get(&header[8], 8));
    record.payload.resize(length);
    if (std::fread(record.payload.data(), 1, length, file_.get()) != length) return std::nullopt;
    if (std::fread(sum.data(), 1, sum.size(), file_.get()) != sum.size()) return std::nullopt;
    if (get(sum.data(), 4) != check_sum(header, record.payload)) return std::nullopt;
    at_ += header.size() + length + sum.size();
    lost_bytes_ = size_ - std::min(size_, at_);
    return record;
}

}  // namespace entoptic::drivers
