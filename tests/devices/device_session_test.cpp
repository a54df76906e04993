// labels: device
// Whole sessions on emulated hardware: hello_xr under `entoptic run`, the headset on the kernel's USB, its panel on the kernel's display code.
// Runs on tests/devices/run_um.sh --edid; ENTOPTIC_COMMAND is the command's path.
#include "base/image_io.h"
#include "base/noise.h"
#include "compositor/targets/kms/testing/wayland_lessor.h"
#include "drivers/pupil_labs/pupil_labs_device.h"
#include "drivers/vive_pro/vive_pro_connection.h"
#include "tests/devices/emulated_eyes.h"
#include "tests/devices/emulated_vive.h"
#include "tests/devices/panel_on_kernel.h"
#include "tests/devices/test_process.h"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <thread>

namespace entoptic::devices {
namespace {

namespace fs = std::filesystem;

MonotonicClock the_clock;

std::string command_path() {
    const char* command = std::getenv("ENTOPTIC_COMMAND");
    return command ? command : "entoptic";
}

// One run in a folder of its own. `frames` 0: until end().
class SessionRun {
public:
    SessionRun(const std::string& options, int frames) {
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        call_ = fmt::format("exec {} run {} --report {}/report.json {} -- hello_xr -g Vulkan2 >{}/output 2>&1", command_path(),
                            frames ? fmt::format("--frames {}", frames) : "", folder_.string(), options, folder_.string());
        int ends[2] = {-1, -1};  // hello_xr ends when its standard input does
        EXPECT_EQ(pipe2(ends, O_CLOEXEC), 0);
        process_ = fork();
        if (process_ == 0) {
            dup2(ends[0], 0);
            execl("/bin/sh", "sh", "-c", call_.c_str(), nullptr);
            _exit(127);
        }
        close(ends[0]);
        input_ = ends[1];
    }
    ~SessionRun() { end(); }
    SessionRun(const SessionRun&) = delete;
    SessionRun& operator=(const SessionRun&) = delete;
    // As a key pressed in hello_xr's terminal.
    void end() {
        if (input_ >= 0) close(input_);
        input_ = -1;
    }
    // The exit code; -1 when it did not end in time.
    int wait(double seconds) {
        int state = 0;
        for (int i = 0; i < seconds * 10; ++i) {
            if (waitpid(process_, &state, WNOHANG) == process_) return WIFEXITED(state) ? WEXITSTATUS(state) : -2;
            the_clock.sleep_until(the_clock.now() + ns_per_s / 10);
        }
        kill(process_, SIGTERM);
        waitpid(process_, &state, 0);
        return -1;
    }
    std::string text(const char* name) const {
        std::ifstream in(folder_ / name);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    nlohmann::json report() const { return nlohmann::json::parse(text("report.json"), nullptr, false); }
    const fs::path& folder() const { return folder_; }

private:
    fs::path folder_ = fs::temp_directory_path() / fmt::format("entoptic-session-{}", getpid());
    std::string call_;
    pid_t process_ = -1;
    int input_ = -1;
};

// What `entoptic status` says of the one runtime that runs; null when none does. Asking takes no virtual time, but a second of the machine's.
nlohmann::json runtime_status() {
    std::string text;
    FILE* output = popen((command_path() + " status --json 2>/dev/null").c_str(), "r");
    char piece[4096];
    for (std::size_t got = 0; output && (got = fread(piece, 1, sizeof piece, output)) > 0;) text.append(piece, got);
    if (output) pclose(output);
    const auto json = nlohmann::json::parse(text, nullptr, false);
    return json.is_object() && json["runtimes"].size() == 1 ? json["runtimes"][0] : nlohmann::json();
}

bool plug_in(EmulatedVive& vive) {
    return bool(vive.plug()) && within(10, [] {
               const auto found = drivers::vive_pro::find_headsets(drivers::system_hid_bus());
               return found.size() == 1 && !found[0].light.path.empty() && !found[0].mainboard.path.empty();
           });
}

bool plug_in(EmulatedEyes& eyes) {
    return bool(eyes.plug()) && within(10, [] { return drivers::find_eye_cameras(drivers::linux_video_system()).size() == 2; });
}

// The dumped frame whose codes are exactly what was scanned out; "" for none.
std::string dumped_frame(const fs::path& dumps, const std::vector<std::uint32_t>& pixels) {
    for (const auto& entry : fs::directory_iterator(dumps)) {
        const std::string name = entry.path().filename().string();
        const auto at = name.find("_left_panel.png");
        if (at == std::string::npos) continue;
        bool same = true;
        for (int eye = 0; eye < 2 && same; ++eye) {
            const auto image = read_png((dumps / (name.substr(0, at) + (eye ? "_right_panel.png" : "_left_panel.png"))).string());
            if (!image) return image.error().message;
            for (int y = 0; y < 1600 && same; ++y)
                for (int x = 0; x < 1440 && same; ++x) {
                    const std::uint32_t code =
                        std::uint32_t(image->at(x, y, 0)) << 16 | std::uint32_t(image->at(x, y, 1)) << 8 | image->at(x, y, 2);
                    same = (pixels[std::size_t(y) * 2880 + std::size_t(eye * 1440 + x)] & 0xffffffu) == code;
                }
        }
        if (same) return name.substr(0, at);
    }
    return "";
}

TEST(Session, HelloXrOnTheViveProsPanelAtItsOwnRate) {
    EmulatedVive vive;
    EmulatedEyes eyes;
    ASSERT_TRUE(plug_in(vive));
    ASSERT_TRUE(plug_in(eyes));
    constexpr int frames = 20;
    SessionRun run("--hmd vive-pro --target kms --preset off --eye-scale 0.5 --dump " +
                       (fs::temp_directory_path() / "entoptic-dumps").string() + " --dump-stages panel",
                   frames);
    const int fd = open("/dev/dri/card0", O_RDWR | O_CLOEXEC | O_NONBLOCK);  // may become master before it: given up at once
    drmDropMaster(fd);
    ASSERT_TRUE(within(120, [&] { return is_lit(fd); })) << run.text("output");
    the_clock.sleep_until(the_clock.now() + ns_per_s / 10);
    const auto pixels = scanned_out(fd);
    EXPECT_EQ(run.wait(120), 0) << run.text("output");
    close(fd);
    const auto report = run.report();
    ASSERT_TRUE(report.is_object()) << run.text("output");
    std::printf("%s\nframes %s\n", report["target"].get<std::string>().c_str(), report["frames"].dump().c_str());
    EXPECT_EQ(report["target"].get<std::string>().find("HTC Vive Pro on DP-1 of /dev/dri/card0 (vkms), 2880x1600 at 90.04 Hz"), 0u);
    EXPECT_EQ(report["errors"].dump(), "[]");
    EXPECT_GT(eyes.right.frames, 0);
    EXPECT_GT(eyes.left.frames, 0);
    EXPECT_GE(report["frames"]["displayed"].get<int>(), frames);
    EXPECT_EQ(report["frames"]["missed"].get<int>(), 0);
    EXPECT_EQ(report["frames"]["unseen"].get<int>(), 0);
    ASSERT_EQ(pixels.size(), std::size_t(2880) * 1600);
    const std::string frame = dumped_frame(fs::temp_directory_path() / "entoptic-dumps", pixels);
    std::printf("scanned out: frame %s\n", frame.c_str());
    EXPECT_NE(frame, "");
}

// On a small panel and with the virtual headset: what counts here is who holds the panel.
TEST(Session, GoesOnWhenTheWaylandCompositorTakesItsLeaseBackAndGivesItAgain) {
    Lessor card;
    std::atomic<bool> gives{true};
    compositor::kms::testing::WaylandLessor::Behaviour behaviour;
    behaviour.connector = card.connector();
    behaviour.reader = [] { return open(card_node, O_RDWR | O_CLOEXEC); };  // not the master: that is `card`
    behaviour.lease = [&] { return gives ? card.lease() : -1; };
    compositor::kms::testing::WaylandLessor server(behaviour);
    SessionRun run("--hmd virtual --panel 320x360 --target kms --preset off", 100);
    ASSERT_TRUE(within(60, [&] { return server.leases() == 1; })) << run.text("output");
    the_clock.sleep_until(the_clock.now() + ns_per_s / 2);
    gives = false;
    card.revoke();
    the_clock.sleep_until(the_clock.now() + ns_per_s);
    gives = true;
    EXPECT_EQ(run.wait(200), 0) << run.text("output");
    const auto report = run.report();
    ASSERT_TRUE(report.is_object()) << run.text("output");
    std::printf("%s\nframes %s\nerrors %s\n", report["target"].get<std::string>().c_str(), report["frames"].dump().c_str(),
                report["errors"].dump().c_str());
    EXPECT_NE(report["target"].get<std::string>().find("a lease of the Wayland compositor"), std::string::npos);
    EXPECT_GE(report["frames"]["displayed"].get<int>(), 100);
    EXPECT_GT(report["frames"]["unseen"].get<int>(), 50);
    EXPECT_EQ(report["frames"]["missed"].get<int>(), 0);
    EXPECT_NE(report["errors"].dump().find("taken back by the display server"), std::string::npos);
    EXPECT_EQ(server.leases(), 0);
}

// A headset whose panel has a hundredth of the real one's pixels, for where pictures do not matter: one CPU draws them.
std::string small_headset() {
    auto configuration = nlohmann::json::parse(drivers::vive_pro::testing::example_configuration());
    configuration["device"]["eye_target_width_in_pixels"] = 144;
    configuration["device"]["eye_target_height_in_pixels"] = 160;
    return configuration.dump();
}

// Any of headset and eye cameras goes and comes again, whatever the drivers are just doing. The application never notices more than lost tracking.
TEST(Session, StaysAliveThroughRandomUnplugs) {
    EmulatedVive vive({}, small_headset());
    vive.model.motion = {0.5, 0.3, 0.1};
    EmulatedEyes eyes;
    ASSERT_TRUE(plug_in(vive));
    ASSERT_TRUE(plug_in(eyes));
    SessionRun run("--hmd vive-pro --target headless --preset off", 0);
    const auto all_there = [&] {
        const auto status = runtime_status();
        if (!status.is_object() || !status["headset"]["present"].get<bool>() || !vive.model.display_on) return false;
        const std::string tracker = status["eye_tracker"]["why"];
        return tracker.find("left: tracked") != std::string::npos && tracker.find("right: tracked") != std::string::npos;
    };
    ASSERT_TRUE(within(60, all_there, 0.5)) << run.text("output");
    const char* wanted = std::getenv("ENTOPTIC_DEVICE_REPLUGS");
    const int replugs = wanted ? std::atoi(wanted) : 10;
    const auto random = [](int i, std::uint64_t what) { return uniform01(what, static_cast<std::uint64_t>(i)); };
    std::array<int, 4> unplugged{};
    const TimeNs begun = the_clock.now();
    for (int i = 0; i < replugs; ++i) {
        sleep_s(random(i, 1));
        const auto which = static_cast<std::size_t>(random(i, 2) * 4);
        EmulatedUsb& device = *std::array<EmulatedUsb*, 4>{&vive.unit, &vive.board, &eyes.right, &eyes.left}[which];
        ++unplugged[which];
        fmt::print(stderr, "{:.1f} s: unplug {} of {}\n", seconds(the_clock.now() - begun), i + 1, replugs);
        device.unplug();
        if (which == 1) vive.model.display_on = false;  // it has no power
        sleep_s(0.5 * random(i, 3));
        ASSERT_TRUE(within(5, [&] {
            return bool(device.plug(std::array{1, 0, EmulatedEyes::right_port, EmulatedEyes::left_port}[which]));
        })) << i;
        ASSERT_TRUE(i % 10 != 9 || runtime_status().is_object()) << i << "\n" << run.text("output");
    }
    EXPECT_TRUE(within(30, all_there, 0.5)) << runtime_status().dump(2);
    run.end();
    EXPECT_EQ(run.wait(60), 0) << run.text("output");
    const auto report = run.report();
    ASSERT_TRUE(report.is_object()) << run.text("output");
    fmt::print("{} unplugs of the tracking unit, {} of the mainboard, {} and {} of the cameras\nframes {}\nerrors {}\n", unplugged[0],
               unplugged[1], unplugged[2], unplugged[3], report["frames"].dump(), report["errors"].dump());
    EXPECT_EQ(report["errors"].dump(), "[]");
    EXPECT_EQ(report["frames"]["missed"].get<int>(), 0);
    EXPECT_GT(report["frames"]["displayed"].get<int>(), replugs * 40);
}

// Debian's Xorg with its modesetting driver, of a seat without a terminal. Its one output is the headset's, which it lights for want of others.
class XServer {
public:
    XServer() {
        {
            std::ofstream conf(folder_ + ".conf");
            conf << "Section \"ServerFlags\"\nOption \"AutoAddDevices\" \"false\"\nOption \"AutoAddGPU\" \"false\"\nEndSection\n"
                    "Section \"Device\"\nIdentifier \"card\"\nDriver \"modesetting\"\nOption \"kmsdev\" \""
                 << card_node
                 << "\"\nOption \"AccelMethod\" \"none\"\nEndSection\n"
                    "Section \"Screen\"\nIdentifier \"screen\"\nDevice \"card\"\nEndSection\n";
        }
        process_ = fork();
        if (process_ == 0) {
            const std::string conf = folder_ + ".conf", log = folder_ + ".log";
            if (!freopen((folder_ + ".err").c_str(), "w", stderr)) _exit(126);
            execl("/usr/lib/xorg/Xorg", "Xorg", ":7", "-seat", "seat-1", "-config", conf.c_str(), "-logfile", log.c_str(), "-noreset",
                  "-ac", "-nolisten", "tcp", nullptr);
            _exit(127);
        }
        setenv("DISPLAY", ":7", 1);
    }
    ~XServer() {
        kill(process_, SIGTERM);
        waitpid(process_, nullptr, 0);
        unsetenv("DISPLAY");
    }
    static bool run(const char* command) { return std::system(command) == 0; }

private:
    std::string folder_ = (fs::temp_directory_path() / fmt::format("entoptic-xorg-{}", getpid())).string();
    pid_t process_ = -1;
};

TEST(Session, OnAPanelThatTheXServerLeases) {
    const XServer server;
    ASSERT_TRUE(within(20, [] { return XServer::run("xrandr >/dev/null 2>&1"); }))
        << "no X server, or no xrandr: apt-get install xserver-xorg-core x11-xserver-utils";
    const std::string options = "--hmd virtual --panel 320x360 --target kms --preset off";
    SessionRun used(options, 30);
    EXPECT_EQ(used.wait(60), 125);
    EXPECT_NE(used.text("output").find("Take it away: xrandr --output DP-1 --off"), std::string::npos) << used.text("output");
    ASSERT_TRUE(XServer::run("xrandr --output DP-1 --off"));  // as that message says
    SessionRun run(options, 60);
    EXPECT_EQ(run.wait(100), 0) << run.text("output");
    const auto report = run.report();
    ASSERT_TRUE(report.is_object()) << run.text("output");
    std::printf("%s\nframes %s\n", report["target"].get<std::string>().c_str(), report["frames"].dump().c_str());
    EXPECT_NE(report["target"].get<std::string>().find("a lease of the X server"), std::string::npos);
    EXPECT_GE(report["frames"]["displayed"].get<int>(), 60);
    EXPECT_EQ(report["frames"]["missed"].get<int>(), 0);
}

}  // namespace
}  // namespace entoptic::devices
