// labels: unit
#include "drivers/vive_pro/vive_pro_device.h"

#include "base/noise.h"
#include "base/testing/ledger.h"
#include "drivers/optics/lens_fov.h"
#include "drivers/vive_pro/testing/vive_model.h"
#include "drivers/vive_pro/vive_pro_connection.h"
#include "drivers/vive_pro/vive_pro_tracker.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <mutex>

namespace entoptic::drivers::vive_pro {
namespace {

using testing::Report;
using testing::ViveModel;

constexpr double degrees = 180 / std::numbers::pi;

Report from_hex(const std::string& hex) {
    Report out;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2) out.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
    return out;
}

// ---- Reports ----------------------------------------------------------------------------------------------------------------------------

// The first report of a recording of a real Vive (facts/devices.md 1.2).
const Report recorded_imu =
    from_hex("20e6ffe0df6cff95ff5a00d8ff5a8aa04cd63000e6df7effa3ff4100ddff37139f4cd40800f2df6eff9cff5300dcffc9ce9f4cd5");

TEST(Protocol, ARecordedImuReport) {
    const auto report = parse_imu(recorded_imu);
    ASSERT_TRUE(report);
    const ImuSample& s = (*report)[0];
    EXPECT_EQ(s.acceleration, (std::array<std::int16_t, 3>{-26, -8224, -148}));
    EXPECT_EQ(s.angular_rate, (std::array<std::int16_t, 3>{-107, 90, -40}));
    EXPECT_EQ(s.ticks, 0x4ca08a5au);
    EXPECT_EQ(s.sequence, 0xd6);
    EXPECT_EQ((*report)[1].sequence, 0xd4);
    EXPECT_EQ((*report)[2].sequence, 0xd5);
}

TEST(Protocol, ImuRangesAndTheFirstEmptyAnswer) {
    const auto ranges = parse_imu_ranges(from_hex("010101010000"));
    ASSERT_TRUE(ranges);
    EXPECT_NEAR(ranges->angular_rate, 8.7266, 1e-4);   // 500 deg/s
    EXPECT_NEAR(ranges->acceleration, 39.2266, 1e-4);  // 4 g
    EXPECT_FALSE(parse_imu_ranges(from_hex("01000000")));
    EXPECT_FALSE(parse_imu_ranges(from_hex("01050100")));
    EXPECT_FALSE(parse_imu_ranges(from_hex("01")));
}

TEST(Protocol, ARecordedLightReportAndItsRejectedEvents) {
    const auto report =
        parse_light(from_hex("25026c133a9a9e4c0d67133f9a9e4c167c132a9a9e4c1a77132f9a9e4c007613319a9e4c"
                             "feffffffffffff"
                             "fd000044112233"
                             "1b78132f9a9e4c"
                             "03ffff319a9e4c"));
    ASSERT_TRUE(report);
    ASSERT_EQ(report->count, 7u);  // one empty vsync with duration ffff and one half event are left out
    EXPECT_EQ(report->events[0].id, 2);
    EXPECT_EQ(report->events[0].duration, 0x136c);
    EXPECT_EQ(report->events[0].ticks, 0x4c9e9a3au);
    EXPECT_EQ(report->events[5].id, light_camera);
}

TEST(Protocol, ARecordedMainboardReport) {
    Report bytes = from_hex("03d02c3c270600000000000001002300441b0000");
    const auto state = parse_mainboard(bytes);
    ASSERT_TRUE(state);
    EXPECT_EQ(state->ipd_10um, 6980);  // 69.80 mm
    EXPECT_EQ(state->proximity, 35);
    EXPECT_FALSE(state->system_button);
    bytes[1] ^= 1;
    EXPECT_FALSE(parse_mainboard(bytes));
}

TEST(Protocol, DisplayPowerIsTheRecordedThirteenBytesAndZeros) {
    const auto on = display_power(true), off = display_power(false);
    const Report expected_on = from_hex("04782938010000000000020001"), expected_off = from_hex("04782938000000000000020000");
    EXPECT_TRUE(std::equal(expected_on.begin(), expected_on.end(), on.begin()));
    EXPECT_TRUE(std::equal(expected_off.begin(), expected_off.end(), off.begin()));
    EXPECT_TRUE(std::all_of(on.begin() + 13, on.end(), [](std::uint8_t b) { return b == 0; }));
}

TEST(Protocol, LightOfBaseStations2) {
    // Channel 5 in conflict; a sync with its bit set at time 0x123456; a sweep of sensor 19 at 0xabcdef with the half clock.
    const std::uint32_t sync = 0x123456u << 2 | 1u << 26, sweep = 2u | 4u | 0xabcdefu << 3 | 19u << 27;
    Report bytes{report_light_v2, 9, 0x55};
    for (const std::uint32_t word : {sync, sweep})
        for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(word >> (8 * i)));
    bytes.resize(64);
    const auto report = parse_light_v2(bytes);
    ASSERT_TRUE(report);
    ASSERT_EQ(report->count, 3u);
    EXPECT_EQ(report->items[0].channel, 5);
    EXPECT_TRUE(report->items[0].conflict);
    EXPECT_EQ(report->items[1].kind, LightV2Item::Kind::sync);
    EXPECT_EQ(report->items[1].ticks24, 0x123456u);
    EXPECT_TRUE(report->items[1].ootx_bit);
    EXPECT_EQ(report->items[2].kind, LightV2Item::Kind::sweep);
    EXPECT_EQ(report->items[2].ticks24, 0xabcdefu);
    EXPECT_EQ(report->items[2].sensor, 19);
    bytes[1] = 8;  // the last word is cut
    EXPECT_FALSE(parse_light_v2(bytes));
    bytes[1] = 63;
    EXPECT_FALSE(parse_light_v2(bytes));
}

template <class Parse> void survives(Parse parse, const Report& good) {
    for (std::size_t length = 0; length <= good.size(); ++length) parse(Bytes(good.data(), length));
    for (std::uint64_t i = 0; i < 20'000; ++i) {
        Report bytes = good;
        for (int k = 0; k < 4; ++k)
            bytes[mix64(i * 4 + static_cast<std::uint64_t>(k)) % bytes.size()] =
                static_cast<std::uint8_t>(mix64(~i + static_cast<std::uint64_t>(k)));
        parse(Bytes(bytes.data(), mix64(i) % (bytes.size() + 1)));
    }
}

TEST(Protocol, TruncatedAndRandomReportsAreRefusedOrHarmless) {
    survives([](Bytes b) { EXPECT_EQ(parse_imu(b).has_value(), b.size() >= 52 && b[0] == 0x20); }, recorded_imu);
    survives(
        [](Bytes b) {
            if (const auto light = parse_light(b)) {
                EXPECT_LE(light->count, 9u);
                for (std::size_t i = 0; i < light->count; ++i) EXPECT_TRUE(light->events[i].id < 32 || light->events[i].id >= 0xfd);
            }
        },
        Report(64, 0x25));
    survives([](Bytes b) { parse_light(b); }, Report(58, 0x21));
    survives(
        [](Bytes b) {
            const auto light = parse_light_v2(b);
            EXPECT_LE(light ? light->count : 0u, 62u);
        },
        [] {
            Report r(64, 0x28);
            r[1] = 62;
            return r;
        }());
    survives([](Bytes b) { parse_mainboard(b); }, Report(64, 0x03));
    survives(
        [](Bytes b) {
            const auto block = parse_configuration_block(b);
            EXPECT_LE(block ? block->size() + 2 : 0u, b.size());
        },
        Report(64, 0x11));
    survives([](Bytes b) { parse_firmware(b); }, Report(64, 0x05));
}

TEST(Worn, HasHysteresis) {
    WornState worn;
    EXPECT_FALSE(worn.update(37));
    EXPECT_FALSE(worn.update(70));
    EXPECT_TRUE(worn.update(90));
    EXPECT_TRUE(worn.update(70));
    EXPECT_FALSE(worn.update(40));
}

// ---- The stream of samples -----------------------------------------------------------------------------------------------------------

TEST(ImuStream, EachSampleOnceAndInOrder) {
    ViveModel model;
    ImuStream stream;
    std::uint32_t last = 0;
    std::uint64_t count = 0;
    for (std::int64_t n = 3; n < 3000; n += 1 + n % 3) {  // a report after one, two or three samples
        const NewSamples fresh = stream.take(*parse_imu(model.imu_report(n)));
        for (std::size_t i = 0; i < fresh.count; ++i) {
            if (count++ > 0) { EXPECT_EQ(fresh.samples[i].ticks - last, 48'000u); }
            last = fresh.samples[i].ticks;
        }
    }
    EXPECT_EQ(stream.lost(), 0u);
    EXPECT_EQ(stream.received(), count);
    EXPECT_GT(count, 2990u);
}

TEST(ImuStream, CountsWhatIsLost) {
    for (const std::int64_t gap : {1, 2, 50, 100, 119, 127, 300, 2000}) {
        ViveModel model;
        ImuStream stream;
        for (std::int64_t n = 3; n < 100; ++n) stream.take(*parse_imu(model.imu_report(n)));
        for (std::int64_t n = 100 + gap; n < 200 + gap; ++n) stream.take(*parse_imu(model.imu_report(n)));
        // The first report after the gap brings two older samples as well.
        EXPECT_EQ(stream.lost(), static_cast<std::uint64_t>(std::max<std::int64_t>(0, gap - 2))) << gap;
        EXPECT_EQ(stream.restarts(), 0u) << gap;
    }
}

TEST(ImuStream, RepeatedReportsBringNothing) {
    ViveModel model;
    ImuStream stream;
    stream.take(*parse_imu(model.imu_report(10)));
    EXPECT_EQ(stream.take(*parse_imu(model.imu_report(10))).count, 0u);
    EXPECT_EQ(stream.take(*parse_imu(model.imu_report(9))).count, 0u);
    EXPECT_EQ(stream.lost(), 0u);
}

TEST(ImuStream, AJumpOfTheClockIsARestart) {
    ViveModel model;
    ImuStream stream;
    for (std::int64_t n = 3; n < 100; ++n) stream.take(*parse_imu(model.imu_report(n)));
    model.clock_offset -= 48'000'000u * 30;
    std::size_t after = 0;
    for (std::int64_t n = 100; n < 200; ++n) after += stream.take(*parse_imu(model.imu_report(n))).count;
    EXPECT_EQ(stream.restarts(), 1u);
    EXPECT_GE(after, 100u);
}

// ---- Configuration ----------------------------------------------------------------------------------------------------------------

// What Valve's mapping says of a place on the panel (facts/devices.md 1.4): U, V of the render target.
glm::dvec2 render_target(const Lens& lens, std::size_t channel, double u, double v) {
    const ChannelDistortion& c = lens.channels[channel];
    const double a = double(lens.aspect), x = 2 * u - 1 - double(c.centre.x), y = (2 * v - 1) / a - double(c.centre.y), r2 = x * x + y * y;
    const double d = 1 / (1 + double(c.coefficients.x) * r2 + double(c.coefficients.y) * r2 * r2 + double(c.coefficients.z) * r2 * r2 * r2);
    const double scale = 0.5 / (1 + double(lens.grow_for_undistort));
    return {0.5 + (x * d + double(c.centre.x)) * scale, 0.5 + (y * d + double(c.centre.y)) * a * scale};
}

TEST(Configuration, LensesOfTheExampleMapAsThePublishedVectors) {
    const auto calibration = parse_calibration(testing::example_configuration());
    ASSERT_TRUE(calibration) << calibration.error().message;
    struct Vector {
        double u, v;
        std::array<glm::dvec2, 3> rgb;
    };
    const Vector vectors[] = {{0.5, 0.5, {{{0.499974, 0.499999}, {0.499968, 0.499999}, {0.499962, 0.499999}}}},
                              {0.25, 0.5, {{{0.332235, 0.499968}, {0.330226, 0.499956}, {0.328129, 0.499942}}}},
                              {0.5, 0.2, {{{0.497705, 0.295389}, {0.497298, 0.292425}, {0.496865, 0.289308}}}},
                              {0.9, 0.8, {{{0.810697, 0.737993}, {0.823477, 0.748623}, {0.837944, 0.760665}}}}};
    for (const Vector& v : vectors)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const glm::dvec2 uv = render_target(calibration->lenses[0], channel, v.u, v.v);
            EXPECT_NEAR(uv.x, v.rgb[channel].x, 2e-6);
            EXPECT_NEAR(uv.y, v.rgb[channel].y, 2e-6);
        }
    const Fov fov = lens_fov(calibration->lenses[0]);
    EXPECT_NEAR(double(fov.angle_left) * degrees, -54.4784, 2e-4);
    EXPECT_NEAR(double(fov.angle_right) * degrees, 51.6915, 2e-4);
    EXPECT_NEAR(double(fov.angle_up) * degrees, 55.9457, 2e-4);
    EXPECT_NEAR(double(fov.angle_down) * degrees, -56.0155, 2e-4);
}

TEST(Configuration, EverythingElseOfTheExample) {
    const auto c = parse_calibration(testing::example_configuration());
    ASSERT_TRUE(c);
    EXPECT_TRUE(c->is_headset);
    EXPECT_EQ(c->serial, "LHR-EXAMPLE1");
    EXPECT_EQ(c->model, "Vive_Pro MV");
    EXPECT_EQ(c->panel_width, 1440);
    EXPECT_EQ(c->panel_height, 1600);
    EXPECT_NEAR(c->lens_separation_m, 0.063, 1e-9);
    EXPECT_EQ(c->edid_vendor, 0x22d2);   // HVR
    EXPECT_EQ(c->edid_product, 0xaa02);  // Vive Pro
    EXPECT_EQ(c->sensors.size(), 32u);
    // trackref is x left, z forward; the head looks along -z, so the sensors' front is at negative z.
    EXPECT_LT(c->sensors[0].position.z, 0);
    EXPECT_NEAR(c->sensors[0].normal.z, -0.992715, 1e-5);
    EXPECT_NEAR(c->imu.position_in_head.x, -0.0012, 1e-9);
    EXPECT_NEAR(c->imu.position_in_head.y, 0.031 - 0.0021, 1e-9);
    EXPECT_NEAR(c->imu.position_in_head.z, -(0.0264 + 0.0714), 1e-9);
}

// At rest the chip of a Vive Pro feels gravity along its own +y (facts 1.2: counts (-x, y, -z) are OpenXR's axes).
TEST(Configuration, GravityIsUp) {
    const auto c = parse_calibration(testing::example_configuration());
    ASSERT_TRUE(c);
    ImuSample s;
    s.acceleration = {100, 8200, -200};
    const glm::dvec3 felt = c->imu.acceleration(s, {});
    EXPECT_NEAR(felt.y, 0.9987 * 8200 / 32768 * 39.2266 + 0.034, 1e-3);
    EXPECT_LT(felt.x, 0);
    EXPECT_GT(felt.z, 0);
}

TEST(Configuration, WrongOnesSayWhatIsWrong) {
    const std::string good = testing::example_configuration();
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        const auto at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        return text.replace(at, from.size(), to);
    };
    for (const auto& [text, word] : std::vector<std::pair<std::string, std::string>>{
             {"", "JSON"},
             {"[1,2]", "JSON"},
             {good.substr(0, good.size() / 2), "JSON"},
             {with("\"lens_separation\":0.063", "\"lens_separation\":0.63"), "lens_separation"},
             {with("\"physical_aspect_x_over_y\":0.9", "\"physical_aspect_x_over_y\":null"), "physical_aspect_x_over_y"},
             {with("DISTORT_DPOLY3", "DISTORT_FTHETA"), "DISTORT_FTHETA"},
             {with("\"acc_scale\"", "\"acc_skale\""), "acc_scale"},
             {with("\"plus_x\":[-1.0", "\"plus_x\":[-0.1"), "unit vector"},
             {with("\"undistort_r2_cutoff\":1.11", "\"undistort_r2_cutoff\":-1"), "undistort_r2_cutoff"}}) {
        const auto c = parse_calibration(text);
        ASSERT_FALSE(c) << word;
        EXPECT_NE(c.error().message.find(word), std::string::npos) << c.error().message;
    }
}

TEST(Configuration, ATrackersFileIsNoHeadset) {
    const auto c = parse_calibration(R"({"device_class":"generic_tracker","model_number":"VIVE Tracker"})");
    ASSERT_TRUE(c);
    EXPECT_FALSE(c->is_headset);
}

TEST(Configuration, CutOrDamagedStreamsAreRefused) {
    Report whole = testing::deflate_text(testing::example_configuration());
    EXPECT_TRUE(inflate_configuration(whole));
    for (std::size_t length : {std::size_t(0), std::size_t(1), whole.size() / 2, whole.size() - 1})
        EXPECT_FALSE(inflate_configuration(Bytes(whole.data(), length))) << length;
    Report bomb = testing::deflate_text(std::string(10'000'000, ' '));
    EXPECT_FALSE(inflate_configuration(bomb));
    EXPECT_FALSE(inflate_configuration(Report(max_compressed_bytes + 1, 0x78)));
    whole[whole.size() / 2] ^= 0x10;
    EXPECT_FALSE(inflate_configuration(whole));  // Adler's sum
}

// ---- A bus without USB ---------------------------------------------------------------------------------------------------------------

// Serves a model's reports as fast as they are read, each stamped by the virtual clock.
class FakeHid final : public HidDevice {
public:
    FakeHid(ViveModel& model, int function, std::atomic<bool>& plugged) : model_(model), function_(function), plugged_(plugged) {}
    Result<std::size_t> read(std::span<std::uint8_t> report, int timeout_ms) override {
        if (!plugged_) return failure("unplugged");
        if (timeout_ms == 0) return std::size_t(0);
        if (function_ != 0) std::this_thread::sleep_for(std::chrono::milliseconds(std::min(timeout_ms, 5)));
        if (function_ == 1) return std::size_t(0);
        if (function_ == 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const Report bytes = function_ == 0 ? model_.imu_report(++n_) : model_.mainboard_report();
        const std::size_t count = std::min(report.size(), bytes.size());
        std::copy_n(bytes.begin(), count, report.begin());
        return count;
    }
    Result<std::size_t> get_feature(std::span<std::uint8_t> report) override {
        const auto answer = plugged_ ? model_.get_feature(function_, report[0]) : std::nullopt;
        if (!answer) return failure("STALL");
        std::copy_n(answer->begin(), std::min(report.size(), answer->size()), report.begin());
        return answer->size();
    }
    Result<void> send_feature(std::span<const std::uint8_t> report) override {
        if (!plugged_ || !model_.set_feature(function_, report)) return failure("STALL");
        return {};
    }

private:
    ViveModel& model_;
    int function_;
    std::atomic<bool>& plugged_;
    std::int64_t n_ = 3;
};

class FakeBus final : public HidBus {
public:
    explicit FakeBus(ViveModel& m) : model(m) {}
    ViveModel& model;
    std::atomic<bool> plugged = true;
    std::mutex mutex;  // of devices
    std::vector<HidInfo> devices{{"/dev/hidraw0", vendor_valve, 0x2101, 0, "dongle", "1-1.3"},
                                 {"/dev/hidraw1", vendor_valve, tracking_vive_pro, 0, "LHR-1", "1-1.1.2"},
                                 {"/dev/hidraw2", vendor_valve, tracking_vive_pro, 1, "LHR-1", "1-1.1.2"},
                                 {"/dev/hidraw3", vendor_htc, mainboard_vive_pro, 0, "205A", "2-4"},
                                 {"/dev/hidraw4", vendor_htc, mainboard_vive_pro, 0, "205B", "1-1.1.1"}};
    std::vector<HidInfo> list(std::uint16_t vendor) override {
        std::vector<HidInfo> out;
        const std::lock_guard lock(mutex);
        if (plugged)
            std::copy_if(devices.begin(), devices.end(), std::back_inserter(out), [&](const HidInfo& d) { return d.vendor == vendor; });
        return out;
    }
    Result<std::unique_ptr<HidDevice>> open(const HidInfo& info) override {
        const int function = info.path == "/dev/hidraw1" ? 0 : info.path == "/dev/hidraw2" ? 1 : 2;
        return std::make_unique<FakeHid>(model, function, plugged);
    }
};

TEST(Connection, FindsTheFunctionsThatBelongTogether) {
    ViveModel model;
    FakeBus bus(model);
    const auto found = find_headsets(bus);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].imu.path, "/dev/hidraw1");
    EXPECT_EQ(found[0].light.path, "/dev/hidraw2");
    EXPECT_EQ(found[0].mainboard.path, "/dev/hidraw4");  // the one on the same hub
    EXPECT_FALSE(found[0].is_vive);
}

TEST(Connection, ConfigurationComesThroughStallsShortAndDamagedDownloads) {
    ViveModel model;
    model.stalled_configurations = 2;
    model.short_configurations = 1;
    model.corrupt_configurations = 2;
    FakeBus bus(model);
    const auto connection = connect(bus, find_headsets(bus)[0]);
    ASSERT_TRUE(connection) << connection.error().message;
    EXPECT_EQ(connection->calibration.serial, "LHR-EXAMPLE1");
    EXPECT_NEAR(connection->ranges.angular_rate, 8.7266, 1e-4);
    EXPECT_EQ(connection->firmware.hardware_major, 1);
}

TEST(Connection, AHeadsetThatNeverAnswersIsAnError) {
    ViveModel model;
    model.stalled_configurations = 1000;
    FakeBus bus(model);
    const auto connection = connect(bus, find_headsets(bus)[0]);
    ASSERT_FALSE(connection);
    EXPECT_NE(connection.error().message.find("STALL"), std::string::npos) << connection.error().message;
}

TEST(Device, NobodyThereIsMissing) {
    ViveModel model;
    FakeBus bus(model);
    bus.plugged = false;
    MonotonicClock clock;
    const auto device = open_device(bus, clock);
    ASSERT_FALSE(device);
    EXPECT_EQ(device.error().kind, ErrorKind::missing);
    EXPECT_NE(device.error().message.find("28de:2300"), std::string::npos);
}

template <class Condition> bool within(double seconds, Condition condition) {
    for (int i = 0; i < static_cast<int>(seconds * 100); ++i) {
        if (condition()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return condition();
}

TEST(Device, TracksSaysHowItIsWornAndSurvivesBeingUnplugged) {
    ViveModel model;
    FakeBus bus(model);
    MonotonicClock clock;
    {
        auto device = open_device(bus, clock);
        ASSERT_TRUE(device) << device.error().message;
        const std::shared_ptr<Device> shared = std::move(*device);
        const Headset headset = headset_of(shared, shared->ipd_mm(ns_per_s));
        EXPECT_NEAR(double(headset.eyes[1].head_from_eye.position.x), 0.0324, 1e-6);  // the slider's 64.80 mm, not the file's 63
        EXPECT_EQ(headset.display.panel_width, 1440);
        EXPECT_NEAR(double(headset.display.refresh_numerator) / double(headset.display.refresh_denominator), 90.04, 1e-9);
        EXPECT_TRUE(within(5, [&] { return headset.head->pose_at(clock.now()).orientation_tracked; }));
        EXPECT_FALSE(headset.head->pose_at(clock.now()).position_tracked);
        EXPECT_FALSE(headset.eye_tracker->present());
        EXPECT_FALSE(headset.presence->user_present());
        model.proximity = 400;
        EXPECT_TRUE(within(5, [&] { return headset.presence->user_present(); }));
        EXPECT_TRUE(model.display_on);
        EXPECT_TRUE(model.light_is_on);

        bus.plugged = false;
        EXPECT_TRUE(within(5, [&] { return !headset.status->status().present; }));
        EXPECT_NE(headset.status->status().why.find("unplugged"), std::string::npos);
        EXPECT_TRUE(within(5, [&] { return !headset.head->pose_at(clock.now()).orientation_tracked; }));
        EXPECT_TRUE(headset.head->pose_at(clock.now()).orientation_valid);

        bus.plugged = true;
        EXPECT_TRUE(within(10, [&] { return headset.status->status().present && headset.head->pose_at(clock.now()).orientation_tracked; }));
        EXPECT_GE(shared->reconnections(), 1u);  // more when this machine is so busy that the device seems frozen
    }
    EXPECT_FALSE(model.display_on);
}

TEST(Device, AMainboardThatComesLaterIsSwitchedOnAndRead) {
    ViveModel model;
    FakeBus bus(model);
    const std::vector<HidInfo> all = bus.devices;
    bus.devices.resize(3);  // no mainboard yet
    MonotonicClock clock;
    auto device = open_device(bus, clock);
    ASSERT_TRUE(device) << device.error().message;
    EXPECT_TRUE(within(5, [&] { return (*device)->tracker().statistics().samples > 100; }));
    EXPECT_FALSE(model.display_on);
    EXPECT_FALSE((*device)->status().ipd_mm);
    {
        const std::lock_guard lock(bus.mutex);
        bus.devices = all;
    }
    EXPECT_TRUE(within(5, [&] { return model.display_on && (*device)->status().ipd_mm.has_value(); }));
    EXPECT_EQ((*device)->reconnections(), 0u) << "tracking goes on meanwhile";
}

// ---- From reports to poses -----------------------------------------------------------------------------------------------------------

TEST(Tracker, FollowsAHeadInARoomThroughReportsAlone) {
    ViveModel model;
    model.motion = {0.5, 0.25, 0.1};
    model.motion.sway_m = 0.1;
    model.motion.ease = 5;
    model.clock_ppm = 20;
    model.room.stations = {lighthouse::testing::perfect_station({-1.5, 2.2, -2}, 1), lighthouse::testing::perfect_station({1.8, 2.1, -1.6}, 2)};
    Tracker tracker(model.calibration(), {});
    const TimeNs start = 100 * ns_per_s;
    double worst_mm = 0, worst_degrees = 0;
    Eigen::Isometry3d align = Eigen::Isometry3d::Identity();
    bool aligned = false;
    for (std::int64_t n = 0; n < 12'000; ++n) {
        const double t = static_cast<double>(n) * 1e-3;
        const auto jitter = [&](std::uint64_t k) { return nanoseconds(1e-3 * uniform01(k, static_cast<std::uint64_t>(n)) + 0.2e-3); };
        tracker.imu_report(model.imu_report(n), start + nanoseconds(t) + jitter(1));
        if (n % 25 == 24)
            for (std::int64_t k = n / 25 * 3; k < n / 25 * 3 + 3; ++k)
                for (const Report& report : model.light_reports(k)) tracker.light_report(report, start + nanoseconds(t) + jitter(2));
        if (n < 6000) continue;
        const PoseState state = tracker.pose_at(start + nanoseconds(t + 0.2e-3));
        ASSERT_TRUE(state.position_tracked) << t;
        const auto& q = state.pose.orientation;
        const auto& p = state.pose.position;
        const Eigen::Isometry3d estimate = Eigen::Translation3d(double(p.x), double(p.y), double(p.z)) *
                                           Eigen::Quaterniond(double(q.w), double(q.x), double(q.y), double(q.z));
        const Eigen::Isometry3d truth = model.room.world_from_head(t);
        if (!aligned) align = truth * estimate.inverse(), aligned = true;
        const Eigen::Isometry3d off = truth.inverse() * align * estimate;
        worst_mm = std::max(worst_mm, off.translation().norm() * 1e3);
        worst_degrees = std::max(worst_degrees, Eigen::AngleAxisd(off.linear()).angle() * degrees);
    }
    const TrackerStatistics s = tracker.statistics();
    EXPECT_EQ(s.lost_samples, 0u);
    EXPECT_EQ(s.malformed, 0u);
    EXPECT_EQ(s.lighthouse.stations, 2);
    EXPECT_LT(worst_mm, 10);
    EXPECT_LT(worst_degrees, 0.5);
    entoptic::testing::ledger("drivers.vive_pro", "reports to poses; two stations; 20 ppm; 1 ms jitter", "position worst mm", worst_mm);
    entoptic::testing::ledger("drivers.vive_pro", "reports to poses; two stations; 20 ppm; 1 ms jitter", "orientation worst deg",
                              worst_degrees);
}

TEST(Tracker, GarbageIsCountedAndChangesNothing) {
    ViveModel model;
    Tracker tracker(model.calibration(), {});
    for (std::int64_t n = 0; n < 500; ++n) tracker.imu_report(model.imu_report(n), ns_per_s + n * 1'000'000);
    const PoseState before = tracker.pose_at(ns_per_s + 499'000'000);
    tracker.imu_report(Report(20, 0x20), ns_per_s);
    tracker.light_report(Report(10, 0x25), ns_per_s);
    tracker.mainboard_report(Report(64, 0x77), ns_per_s);
    EXPECT_EQ(tracker.statistics().malformed, 3u);
    EXPECT_EQ(tracker.pose_at(ns_per_s + 499'000'000).pose.orientation, before.pose.orientation);
}

}  // namespace
}  // namespace entoptic::drivers::vive_pro
