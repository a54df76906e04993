#include "app/cli/output.h"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace entoptic::app {

double decimal(float value) { return std::isfinite(value) ? std::stod(fmt::format("{}", value)) : double(value); }

void print_json(const Json& document) { fmt::print("{}\n", document.dump(2, ' ', false, Json::error_handler_t::replace)); }

Result<void> write_json(const std::string& path, const Json& document) {
    const std::string part = fmt::format("{}.{}.part", path, getpid());
    {
        std::ofstream out(part, std::ios::trunc);
        out << document.dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
        out.close();
        if (!out) return failure(fmt::format("Cannot write '{}'. Check that its folder exists, may be written and has room.", path));
    }
    std::error_code error;
    std::filesystem::rename(part, path, error);
    if (!error) return {};
    std::filesystem::remove(part, error);
    return failure(fmt::format("Cannot write '{}': {}.", path, error.message()));
}

namespace {

std::string duration_text(double s) {
    if (s < 120) return fmt::format("{:.0f} s", s);
    if (s < 7200) return fmt::format("{:.0f} minutes", s / 60);
    return fmt::format("{:.1f} hours", s / 3600);
}

}  // namespace

Progress::Progress(std::string what, bool always)
    : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) == 1), on_(terminal_ || always) {}

Progress::~Progress() {
    if (shown_ && terminal_) fmt::print(stderr, "\r\x1b[K");
}

void Progress::update(std::uint64_t done, std::uint64_t total) {
    using namespace std::chrono_literals;
    const auto now = Steady::now();
    const double passed = std::chrono::duration<double>(now - start_).count();
    if (done > 0 && first_done_ == 0) {
        first_ = now;
        first_done_ = done;
    }
    const double since_first = std::chrono::duration<double>(now - first_).count();
    if (!told_ && !on_ && done > first_done_ && total > done && since_first > 3) {
        const double left = since_first / double(done - first_done_) * double(total - done);
        told_ = true;
        if (left > 30)
            fmt::print(stderr, "entoptic: {} of {} {} are done; the rest takes about {}. --progress tells more.\n", done, total, what_,
                       duration_text(left));
    }
    if (!on_ || now - start_ < 1s || now - last_ < (terminal_ ? 100ms : 2000ms)) return;
    last_ = now;
    shown_ = true;
    const std::string of = total > 0 ? fmt::format(" of {}", total) : "";
    const double rate = double(done) / passed;
    fmt::print(stderr, "{}{}{} {} ({:.1f} a second){}", terminal_ ? "\r\x1b[K" : "", done, of, what_, rate, terminal_ ? "" : "\n");
    std::fflush(stderr);
}

}  // namespace entoptic::app
