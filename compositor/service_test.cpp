// labels: gpu frame
// The service as the runtime uses it: lockstep and real clocks, sessions, dumps, errors.
#include "compositor/service.h"

#include "base/image_io.h"
#include "compositor/targets/headless.h"
#include "compositor/testing/frame_harness.h"
#include "gpu/testing/validation_guard.h"

#include <atomic>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>

namespace entoptic::compositor {
namespace {

using namespace testing;

const auto* const guard = ::testing::AddGlobalTestEnvironment(new gpu::testing::ValidationGuard(&test_device));

// A head that turns steadily, and eyes that look ahead.
struct TurningHead final : PoseSource {
    PoseState pose_at(TimeNs time) override {
        PoseState state;
        state.pose.orientation = glm::angleAxis(float(0.2 * seconds(time)), glm::vec3(0, 1, 0));
        return state;
    }
};
struct SteadyEyes final : EyeSource {
    Observer observer_at(TimeNs time) override {
        Observer observer;
        observer.time = time;
        return observer;
    }
    std::optional<RawEyeSample> raw_at(int, TimeNs) override { return std::nullopt; }
    bool present() const override { return true; }
    std::string description() const override { return "test"; }
};

// Keeps the codes of every frame it is given.
struct Recorder final : DisplayTarget {
    struct Log {
        std::vector<std::vector<std::uint32_t>> pictures;
        std::vector<FrameDescription> frames;
        std::atomic<bool> closed{false};
    };
    explicit Recorder(std::shared_ptr<Log> l) : log(std::move(l)) {}
    Result<void> test(const PresentState&) override { return {}; }
    Result<void> commit(const PresentState& state) override {
        const PanelCodes codes = state.path->panel();
        auto readback = must(gpu::Buffer::create(test_device(), codes.codes->size(), gpu::BufferKind::readback, "test"));
        auto commands = must(gpu::Commands::create(test_device(), "test"));
        must(commands.begin());
        commands.copy(*codes.codes, readback, codes.codes->size());
        must(commands.submit());
        must(commands.wait());
        const auto words = readback.as<std::uint32_t>();
        log->pictures.emplace_back(words.begin(), words.end());
        log->frames.push_back(*state.frame);
        return {};
    }
    bool close_wanted() const override { return log->closed; }
    std::string description() const override { return "recorder"; }
    std::shared_ptr<Log> log;
};

// A display with refreshes of its own, at 90.9 Hz and a phase that nobody knows before; and one that is away.
struct TellingDisplay final : DisplayTarget {
    static constexpr DurationNs period = 11'000'000;
    static constexpr TimeNs phase = 3'210'987;
    explicit TellingDisplay(std::shared_ptr<std::atomic<bool>> a) : away(std::move(a)) {}
    Result<void> test(const PresentState&) override { return {}; }
    Result<void> commit(const PresentState&) override { return {}; }
    Result<PresentFeedback> wait_shown() override {
        if (*away) return PresentFeedback{false, 0, 0};
        const TimeNs vblank = phase + ((clock.now() - phase) / period + 1) * period;
        clock.sleep_until(vblank);
        return PresentFeedback{true, vblank, period};
    }
    bool lit() const override { return !*away; }
    std::string description() const override { return "telling"; }
    MonotonicClock clock;
    std::shared_ptr<std::atomic<bool>> away;
};

struct Session {
    explicit Session(bool lockstep, std::function<void(ServiceOptions&)> change = {}, PictureSize panel = {48, 40},
                     std::unique_ptr<DisplayTarget> target = nullptr) {
        headset.head = &head;
        headset.eye_tracker = &eyes;
        headset.eyes = vive_pro_eyes();
        headset.display.vblank_to_photon = 2'000'000;
        ServiceOptions options;
        options.path.panel = panel;
        options.path.stopwatch = &monotonic;
        options.lockstep = lockstep;
        options.on_error = [this](const std::string& message) {
            const std::lock_guard lock(error_mutex);
            errors.push_back(message);
        };
        if (change) change(options);
        Clock& clock = lockstep ? static_cast<Clock&>(virtual_clock) : monotonic;
        if (!target) target = std::make_unique<Recorder>(log);
        service = must(CompositorService::create(test_device(), clock, headset, std::move(target), options));
        SwapchainRequest request;
        request.vk_format = VK_FORMAT_R8G8B8A8_SRGB;
        request.width = request.height = 64;
        request.vk_usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT;
        const SwapchainAllocation allocation = must(service->create_swapchain(request));
        for (std::uint8_t i = 0; i < 3; ++i) {  // as an application would: through imported memory
            const ImportedImage image(test_device(), allocation.images[i]);
            std::vector<Codes> texels;
            for (int at = 0; at < 64 * 64; ++at) texels.push_back({std::uint8_t(at), std::uint8_t(at / 16), std::uint8_t(80 * i), 255});
            write_image(test_device(), image.image(), 64, 64, 1, std::as_bytes(std::span(texels)));
        }
        swapchain = allocation.id;
    }
    Layer with_image(std::uint32_t image) const {
        Layer l = projection_layer({swapchain, 64, 64}, headset.eyes);
        for (auto& view : l.views) view.image.image_index = image;
        return l;
    }
    FrameTiming one_frame(bool with_layer = false) {
        const FrameTiming timing = service->wait_frame();
        service->begin_frame(timing.frame_id);
        FrameSubmission frame;
        frame.frame_id = timing.frame_id;
        frame.display_time = timing.predicted_display_time;
        if (with_layer) frame.layers.push_back(with_image(std::uint32_t(timing.frame_id % 3)));
        service->submit_frame(frame);
        return timing;
    }

    TurningHead head;
    SteadyEyes eyes;
    Headset headset;
    VirtualClock virtual_clock;
    MonotonicClock monotonic;
    std::shared_ptr<Recorder::Log> log = std::make_shared<Recorder::Log>();
    std::mutex error_mutex;
    std::vector<std::string> errors;
    std::unique_ptr<CompositorService> service;
    std::uint64_t swapchain = 0;
};

std::string folder(const char* name) {
    const auto path = std::filesystem::temp_directory_path() / (std::string("entoptic-") + name + "-" + std::to_string(getpid()));
    std::filesystem::remove_all(path);
    return path.string();
}

std::string file_bytes(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

TEST(Display, FramesAreOfTheRefreshesThatTheDisplayTells) {
    const auto away = std::make_shared<std::atomic<bool>>(false);
    Session s(false, {}, {48, 40}, std::make_unique<TellingDisplay>(away));
    s.service->begin_session();
    for (int i = 0; i < 30; ++i) s.one_frame();
    s.service->end_session();
    int shown = 0;
    for (const PresentationRecord& record : s.service->presentation_records(30)) {
        if (record.display_time == 0) continue;
        ++shown;
        const DurationNs vblank = record.display_time - s.headset.display.vblank_to_photon;
        EXPECT_EQ((vblank - TellingDisplay::phase) % TellingDisplay::period, 0);
        if (shown > 4) {  // promises of the first were made before the display had told anything
            EXPECT_EQ((record.predicted_display_time - record.display_time) % TellingDisplay::period, 0);
        }
    }
    EXPECT_GT(shown, 20);
    EXPECT_TRUE(s.service->display_lit());
}

TEST(Display, WhileItIsAwayTheSessionGoesOnAndNothingCountsAsShown) {
    const auto away = std::make_shared<std::atomic<bool>>(true);
    Session s(false, {}, {48, 40}, std::make_unique<TellingDisplay>(away));
    s.service->begin_session();
    for (int i = 0; i < 10; ++i) s.one_frame();
    EXPECT_FALSE(s.service->display_lit());
    EXPECT_EQ(s.service->report().frames.displayed, 0u);
    EXPECT_GT(s.service->report().frames.unseen, 5u);
    *away = false;
    for (int i = 0; i < 10; ++i) s.one_frame();
    s.service->end_session();
    EXPECT_GT(s.service->report().frames.displayed, 5u);
    EXPECT_EQ(s.service->report().frames.submitted, 20u);
}

TEST(Lockstep, EveryFrameIsComposedOnceAtItsPredictedTime) {
    Session s(true);
    s.service->begin_session();
    TimeNs before = 0;
    for (int i = 0; i < 8; ++i) {
        const FrameTiming timing = s.one_frame(true);
        EXPECT_TRUE(timing.should_render);
        if (before) { EXPECT_EQ(timing.predicted_display_time - before, s.headset.display.period); }
        before = timing.predicted_display_time;
    }
    s.service->end_session();
    EXPECT_EQ(s.virtual_clock.now(), before);
    ASSERT_EQ(s.log->frames.size(), 8u);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_EQ(s.log->frames[i].index, i);
        EXPECT_EQ(s.log->frames[i].display_time, s.log->frames[i].predicted_display_time);
        EXPECT_EQ(s.log->frames[i].perception.snap, i == 0);
    }
    for (const PresentationRecord& record : s.service->presentation_records(100)) {
        EXPECT_EQ(record.refreshes_shown, 1u);
        EXPECT_EQ(record.display_time, record.predicted_display_time);
    }
    const RunReport report = s.service->report();
    EXPECT_EQ(report.frames.displayed, 8u);
    EXPECT_EQ(report.frames.missed, 0u);
    EXPECT_EQ(report.frames.reused, 0u);
    EXPECT_EQ(report.gpu_ms.at("fused").samples, 8u);
    EXPECT_TRUE(s.errors.empty());
}

TEST(Lockstep, TheEyesBeginWithTheFirstPicture) {
    Session s(true);
    s.service->begin_session();
    s.one_frame();  // black: an application that has nothing to show yet
    s.one_frame(true);
    s.one_frame(true);
    s.service->end_session();
    ASSERT_EQ(s.log->frames.size(), 3u);
    EXPECT_TRUE(s.log->frames[1].perception.snap) << "adapted to the dark before the first picture, it would flash";
    EXPECT_FALSE(s.log->frames[2].perception.snap);
}

TEST(Lockstep, DiscardedFramesPassTheirTime) {
    Session s(true);
    s.service->begin_session();
    const FrameTiming first = s.one_frame(true);
    const FrameTiming second = s.service->wait_frame();
    s.service->begin_frame(second.frame_id);
    s.service->discard_frame(second.frame_id);
    const FrameTiming third = s.one_frame();
    s.service->end_session();
    EXPECT_EQ(third.predicted_display_time - first.predicted_display_time, 2 * s.headset.display.period);
    ASSERT_EQ(s.log->frames.size(), 2u);
    EXPECT_NEAR(s.log->frames[1].perception.dt_s, 2.0 / 90, 1e-6);
    EXPECT_EQ(s.service->report().frames.discarded, 1u);
    EXPECT_EQ(s.service->presentation_records(2).front().refreshes_shown, 0u);
}

// Two runs with noise, a turning head and every stage dumped: the same bytes.
TEST(Lockstep, TwoRunsAreTheSameToTheBit) {
    std::array<std::string, 2> folders{folder("run-a"), folder("run-b")};
    std::array<std::vector<std::vector<std::uint32_t>>, 2> pictures;
    std::array<std::vector<PresentationRecord>, 2> records;
    for (std::size_t run = 0; run < 2; ++run) {
        Session s(true, [&](ServiceOptions& options) {
            options.dump = {folders[run], {true, true, true, true, true}, 2};
            options.path.selection = must(perception::select("off", {"adaptation=krawczyk_exp_linear", "tone=key_reinhard"}));
        });
        s.service->begin_session();
        for (int i = 0; i < 4; ++i) s.one_frame(true);
        s.service->end_session();
        EXPECT_TRUE(s.errors.empty());
        pictures[run] = s.log->pictures;
        records[run] = s.service->presentation_records(100);
        EXPECT_FALSE(s.service->report().adaptation.empty());
        EXPECT_TRUE(s.service->report().effects.contains("tone"));
    }
    EXPECT_EQ(pictures[0], pictures[1]);
    EXPECT_NE(pictures[0][0], pictures[0][1]);  // the head turned, another image was shown
    ASSERT_EQ(records[0].size(), records[1].size());
    for (std::size_t i = 0; i < records[0].size(); ++i) {
        EXPECT_EQ(records[0][i].display_time, records[1][i].display_time);
        EXPECT_EQ(records[0][i].submitted_time, records[1][i].submitted_time);
    }
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folders[0])) {
        EXPECT_EQ(file_bytes(entry.path()), file_bytes(std::filesystem::path(folders[1]) / entry.path().filename())) << entry.path();
        ++files;
    }
    EXPECT_EQ(files, 2u * 2 * 5);  // frames 0 and 2, both eyes, five stages
    EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(folders[0]) / "000002_left_warp.exr"));
    const ExrImage image = must(read_exr((std::filesystem::path(folders[0]) / "000002_right_perceive.exr").string()));
    EXPECT_EQ(image.white_luminance, 1.0f);
    EXPECT_EQ(image.text.at("eye"), "right");
    for (const std::string& path : folders) std::filesystem::remove_all(path);
}

TEST(Service, ADumpThatFailsIsReportedOnceAndTheSessionGoesOn) {
    const std::string file = folder("not-a-folder");
    std::ofstream(file) << "here stands a file";
    Session s(true, [&](ServiceOptions& options) { options.dump = {file, {false, false, false, true, false}, 1}; });
    s.service->begin_session();
    for (int i = 0; i < 5; ++i) s.one_frame();
    s.service->end_session();
    EXPECT_EQ(s.errors.size(), 1u);
    EXPECT_EQ(s.service->report().errors.size(), 1u);
    EXPECT_EQ(s.service->report().frames.displayed, 5u);
    std::filesystem::remove_all(file);
}

TEST(Service, ExitIsWantedAfterTheFrameLimitOrWhenTheWindowIsClosed) {
    Session s(true, [](ServiceOptions& options) { options.frame_limit = 3; });
    s.service->begin_session();
    for (int i = 0; i < 3; ++i) {
        EXPECT_FALSE(s.service->exit_wanted());
        s.one_frame();
        s.service->wait_frame();  // returns when the frame is composed
        s.service->discard_frame(s.service->presentation_records(1).front().frame_id);
    }
    s.service->end_session();
    EXPECT_TRUE(s.service->exit_wanted());
    Session other(true);
    EXPECT_FALSE(other.service->exit_wanted());
    other.log->closed = true;
    EXPECT_TRUE(other.service->exit_wanted());
}

TEST(Service, OutsideASessionNothingIsRendered) {
    Session s(true);
    const FrameTiming timing = s.service->wait_frame();
    EXPECT_FALSE(timing.should_render);
    s.service->begin_frame(timing.frame_id);
    s.service->submit_frame({timing.frame_id, timing.predicted_display_time, {}});
    s.service->begin_session();
    s.one_frame();
    s.service->end_session();
    s.service->begin_session();
    s.one_frame();
    s.service->end_session();
    s.service->end_session();
    ASSERT_EQ(s.log->frames.size(), 2u);
    EXPECT_TRUE(s.log->frames[1].perception.snap);  // a new session, a new beginning
    EXPECT_GT(s.log->frames[1].display_time, s.log->frames[0].display_time);
}

TEST(Service, AStallOfTenSecondsIsANewBeginning) {
    Session s(true);
    s.service->begin_session();
    s.one_frame();
    const FrameTiming timing = s.service->wait_frame();
    (void)timing;
    s.service->end_session();
    s.virtual_clock.advance_to(s.virtual_clock.now() + 10 * ns_per_s);
    s.service->begin_session();
    s.one_frame();
    s.service->end_session();
    EXPECT_TRUE(s.log->frames.back().perception.snap);
    EXPECT_GE(s.log->frames.back().display_time - s.log->frames.front().display_time, 10 * ns_per_s);
}

TEST(Service, LayersOfDestroyedSwapchainsAreReportedNotShown) {
    Session s(true);
    s.service->begin_session();
    s.service->destroy_swapchain(s.swapchain);
    for (int i = 0; i < 3; ++i) s.one_frame(true);
    s.service->end_session();
    EXPECT_EQ(s.errors.size(), 1u);
    EXPECT_EQ(s.service->report().frames.displayed, 3u);
}

TEST(Service, WaitingApplicationsAreReleasedWhenTheSessionEnds) {
    Session s(false);
    s.service->begin_session();
    s.service->wait_frame();  // never begun
    std::thread waiting([&] { EXPECT_FALSE(s.service->wait_frame().should_render); });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    s.service->end_session();
    waiting.join();
}

TEST(RealClock, FramesAreShownAndCountedAndImagesComeBack) {
    Session s(false);
    s.service->begin_session();
    TimeNs before = 0;
    for (int i = 0; i < 12; ++i) {
        const FrameTiming timing = s.one_frame(true);
        EXPECT_GT(timing.predicted_display_time, before);
        if (before) { EXPECT_EQ((timing.predicted_display_time - before) % s.headset.display.period, 0); }
        before = timing.predicted_display_time;
    }
    s.service->end_session();
    const RunReport report = s.service->report();
    EXPECT_EQ(report.frames.submitted, 12u);
    EXPECT_GE(report.frames.displayed, 6u);
    EXPECT_EQ(report.composed, report.frames.displayed + report.frames.reused);
    std::uint64_t shown = 0;
    for (const PresentationRecord& record : s.service->presentation_records(100)) shown += record.refreshes_shown;
    EXPECT_EQ(shown, report.frames.displayed + report.frames.reused + report.frames.missed);
    for (std::uint32_t image = 0; image < 3; ++image) EXPECT_TRUE(s.service->wait_image_idle(s.swapchain, image, 0));
    EXPECT_TRUE(s.errors.empty());
}

TEST(RealClock, PipelinedApplications) {
    Session s(false);
    s.service->begin_session();
    FrameTiming timing = s.service->wait_frame();
    for (int i = 0; i < 6; ++i) {
        s.service->begin_frame(timing.frame_id);
        const FrameTiming next = s.service->wait_frame();  // before the frame in hand is submitted
        s.service->submit_frame({timing.frame_id, timing.predicted_display_time, {}});
        EXPECT_GT(next.predicted_display_time, timing.predicted_display_time);
        timing = next;
    }
    s.service->end_session();
    EXPECT_EQ(s.service->report().frames.submitted, 6u);
}

TEST(Service, DestructionInTheMiddleOfASession) {
    for (const bool lockstep : {true, false}) {
        Session s(lockstep);
        s.service->begin_session();
        for (int i = 0; i < 3; ++i) s.one_frame();
        s.service->wait_frame();
        s.service.reset();
    }
}

}  // namespace
}  // namespace entoptic::compositor
