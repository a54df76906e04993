// For tests: a folder of one's own, pictures in it, and the built `entoptic` run on them. Header-only, not in the library.
#pragma once

#include "base/image_io.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace entoptic::app::testing {

namespace fs = std::filesystem;

struct Outcome {
    int status = -1;  // exit code; 128 + n: signal n
    std::string out, err;
    nlohmann::ordered_json json() const { return nlohmann::ordered_json::parse(out); }
};

inline std::string text_of(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

inline std::string quoted(const std::string& text) {
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? "'\\''" : std::string(1, c);
    return out + "'";
}

// A test with a folder that goes away. XDG_CONFIG_HOME and XDG_RUNTIME_DIR of the commands it runs lie in it: the user's own do not matter.
class CommandLineTest : public ::testing::Test {
protected:
    void SetUp() override {
        fs::create_directories(folder_ / "config/entoptic");
        fs::create_directories(folder_ / "run");
    }
    void TearDown() override {
        if (!HasFailure()) fs::remove_all(folder_);
    }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name, std::ios::binary) << text;
    }
    std::string picture(const std::string& name, const ImageF& image, std::optional<float> white = 1.0f, const ImageF& depth = {}) const {
        ExrAttributes attributes;
        attributes.white_luminance = white;
        const auto written = write_exr(path(name), image, attributes, depth);
        if (!written) throw std::runtime_error(written.error().message);
        return path(name);
    }

    // `environment`: "NAME=value" for this call only.
    Outcome entoptic(const std::vector<std::string>& arguments, const std::vector<std::string>& environment = {}) const {
        std::string line = "env -u ENTOPTIC_CONFIG -u XR_RUNTIME_JSON XDG_CONFIG_HOME=" + quoted(path("config")) +
                           " XDG_RUNTIME_DIR=" + quoted(path("run"));
        for (const std::string& setting : environment) line += " " + quoted(setting);
        line += std::string(" ") + quoted(ENTOPTIC_BINARY_DIR "/bin/entoptic");
        for (const std::string& argument : arguments) line += " " + quoted(argument);
        line += " >" + quoted(path("stdout")) + " 2>" + quoted(path("stderr")) + " </dev/null";
        const int status = std::system(line.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), text_of(path("stdout")), text_of(path("stderr"))};
    }

    // Fails with this exit code and says `wanted`.
    void expect_error(int code, const std::string& wanted, const std::vector<std::string>& arguments,
                      const std::vector<std::string>& environment = {}) const {
        const Outcome outcome = entoptic(arguments, environment);
        EXPECT_EQ(outcome.status, code) << outcome.err;
        EXPECT_NE(outcome.err.find(wanted), std::string::npos) << "wanted: " << wanted << "\ngot: " << outcome.err;
        EXPECT_EQ(outcome.out, "");
    }

private:
    fs::path folder_ = fs::temp_directory_path() / ("entoptic_test_" + std::to_string(getpid()) + "_" +
                                                    ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

}  // namespace entoptic::app::testing
