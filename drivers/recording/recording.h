// A recording: samples of several streams with one clock in one file that stays readable when it is cut short. Format: recording.md.
#pragma once

#include "base/result.h"
#include "base/time.h"

#include <cstdint>
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace entoptic::drivers {

enum class Stream : std::uint16_t {
    description = 0,  // JSON, first in the file: what was recorded, with which device
    pose = 1,         // of the head (recorded_samples.h)
    eye = 2,          // raw sample of an eye tracker
    vive_report = 3,  // one byte source, then the report as it was read
    event = 4,        // JSON: something happened
    eye_picture = 5,  // one picture of an eye camera as it came (recorded_samples.h)
};

struct Record {
    Stream stream = Stream::event;
    TimeNs time = 0;  // CLOCK_MONOTONIC (or the lockstep clock) when it was known
    std::vector<std::uint8_t> payload;
};

constexpr std::size_t max_record_bytes = 1 << 20;

class RecordingWriter {
public:
    // Errors: the file cannot be made. An existing file is not overwritten.
    static Result<std::unique_ptr<RecordingWriter>> create(const std::string& path, const std::string& description, TimeNs time);
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    // From any thread. What was written more than a tenth of a second ago is in the file even if this process dies. Errors are kept for close().
    void add(Stream stream, TimeNs time, std::span<const std::uint8_t> payload);
    void add(Stream stream, TimeNs time, const std::string& text);
    // Errors: the disk is full, or was at any time since create().
    Result<void> close();

private:
    explicit RecordingWriter(std::FILE* file, std::string path) : file_(file), path_(std::move(path)) {}
    std::mutex mutex_;
    std::FILE* file_;
    std::string path_;
    TimeNs flushed_ = 0;
    bool failed_ = false;
};

class RecordingReader {
public:
    // Errors: not there, no recording, of a newer version.
    static Result<RecordingReader> open(const std::string& path);
    RecordingReader(RecordingReader&&) = default;

    const std::string& description() const { return description_; }  // JSON text
    // The next whole record; none at the end, or where the file was cut or is damaged.
    std::optional<Record> next();
    // After next() returned none: bytes that are no whole record; 0 when the recording is complete.
    std::uint64_t lost_bytes() const { return lost_bytes_; }

private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    explicit RecordingReader(std::FILE* file) : file_(file) {}

    std::unique_ptr<std::FILE, Close> file_;
    std::string description_;
    std::uint64_t size_ = 0, at_ = 0, lost_bytes_ = 0;
};

}  // namespace entoptic::drivers
