// labels: unit
#include "drivers/virtual_hmd/virtual_hmd_script.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <sstream>

namespace entoptic::drivers {
namespace {

Script parsed(const std::string& text) {
    auto script = parse_script(text, "test.toml");
    EXPECT_TRUE(script) << script.error().message;
    return script ? *script : Script{};
}

std::string error_of(const std::string& text) {
    const auto script = parse_script(text, "test.toml");
    EXPECT_FALSE(script) << text;
    if (script) return "";
    EXPECT_EQ(script.error().kind, ErrorKind::usage);
    return script.error().message;
}

void expect_error(const std::string& text, const std::string& start, const std::string& part) {
    const std::string message = error_of(text);
    EXPECT_EQ(message.rfind(start, 0), 0u) << message;
    EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(Channel, LinearHasTheSlopeAsItsRate) {
    const Channel<1> channel(Interpolation::linear, {{1, {2}}, {3, {6}}, {4, {0}}});
    EXPECT_DOUBLE_EQ(channel.at(0).value[0], 2);
    EXPECT_DOUBLE_EQ(channel.at(0).rate[0], 0);
    EXPECT_DOUBLE_EQ(channel.at(2).value[0], 4);
    EXPECT_DOUBLE_EQ(channel.at(2).rate[0], 2);
    EXPECT_DOUBLE_EQ(channel.at(3.5).value[0], 3);
    EXPECT_DOUBLE_EQ(channel.at(3.5).rate[0], -6);
    EXPECT_DOUBLE_EQ(channel.at(9).value[0], 0);
    EXPECT_DOUBLE_EQ(channel.at(9).rate[0], 0);
}

TEST(Channel, HoldJumpsAtItsKeys) {
    const Channel<1> channel(Interpolation::hold, {{0, {1}}, {2, {5}}});
    EXPECT_DOUBLE_EQ(channel.at(std::nextafter(2.0, 0.0)).value[0], 1);
    EXPECT_DOUBLE_EQ(channel.at(2).value[0], 5);
}

TEST(Channel, SmoothGoesThroughItsKeysWithoutOvershootAndWithContinuousRate) {
    const std::vector<Key<1>> keys{{0, {0}}, {1, {3}}, {1.2, {3.1}}, {4, {10}}, {5, {10}}, {6, {2}}};
    const Channel<1> channel(Interpolation::smooth, keys);
    for (const auto& key : keys) {
        EXPECT_NEAR(channel.at(key.time).value[0], key.value[0], 1e-12);
        EXPECT_NEAR(channel.at(key.time - 1e-9).rate[0], channel.at(key.time + 1e-9).rate[0], 1e-6);
    }
    double last = 0;
    for (double t = 0; t <= 5; t += 0.001) {
        const double now = channel.at(t).value[0];
        EXPECT_GE(now, last - 1e-12);
        EXPECT_LE(now, 10 + 1e-12);
        last = now;
    }
    for (double t = 0.01; t < 6; t += 0.0137) {
        const double numeric = (channel.at(t + 1e-6).value[0] - channel.at(t - 1e-6).value[0]) / 2e-6;
        EXPECT_NEAR(channel.at(t).rate[0], numeric, 1e-4) << t;
    }
    EXPECT_DOUBLE_EQ(channel.at(0).rate[0], 0);
    EXPECT_DOUBLE_EQ(channel.at(6).rate[0], 0);
}

TEST(Channel, TwoSmoothKeysAreTheSmoothstepPolynomial) {
    const Channel<1> channel(Interpolation::smooth, {{0, {0}}, {1, {1}}});
    for (double x : {0.1, 0.25, 0.5, 0.9}) EXPECT_NEAR(channel.at(x).value[0], x * x * (3 - 2 * x), 1e-12);
}

// Main sequence (Bahill, Clark and Stark 1975): 10 degrees take some 43 ms and peak at 300 to 500 deg/s.
TEST(Channel, SaccadeFollowsTheMainSequence) {
    const Channel<2> channel(Interpolation::saccade, {{0, {0, 0}}, {1, {6, 8}}});
    EXPECT_DOUBLE_EQ(channel.at(0.999).value[0], 0);
    EXPECT_DOUBLE_EQ(channel.at(1.0 + 0.043).value[0], 6);
    EXPECT_DOUBLE_EQ(channel.at(1.0 + 0.043).value[1], 8);
    EXPECT_NEAR(channel.at(1.0215).value[0], 3, 1e-9);
    double peak = 0;
    for (double t = 1; t < 1.05; t += 1e-4) peak = std::max(peak, std::hypot(channel.at(t).rate[0], channel.at(t).rate[1]));
    EXPECT_GT(peak, 300);
    EXPECT_LT(peak, 500);
    EXPECT_DOUBLE_EQ(channel.end_time(), 1.043);
}

TEST(Script, DefaultsAreAStandingPerson) {
    const Script script = parsed("");
    const PoseState head = head_at(script, 123);
    EXPECT_FLOAT_EQ(head.pose.position.y, 1.6f);
    EXPECT_TRUE(head.position_tracked && head.orientation_tracked);
    ASSERT_TRUE(script.pupil_mm);
    EXPECT_DOUBLE_EQ(script.pupil_mm->at(5).value[0], 4);
    EXPECT_TRUE(controller_at(script, 0, 0).active);
    EXPECT_TRUE(controller_at(script, 1, 0).active);
    EXPECT_FALSE(script.loop);
}

TEST(Script, OrientationSigns) {
    const auto forward = [](std::array<double, 3> deg) { return orientation_of(deg) * glm::dvec3(0, 0, -1); };
    EXPECT_NEAR(forward({90, 0, 0}).x, 1, 1e-12);  // yaw right
    EXPECT_NEAR(forward({0, 90, 0}).y, 1, 1e-12);  // pitch up
    const glm::dvec3 up = orientation_of({0, 0, 90}) * glm::dvec3(0, 1, 0);
    EXPECT_NEAR(up.x, 1, 1e-12);  // roll clockwise: the top of the head goes right
    const glm::dvec3 both = forward({90, 30, 0});
    EXPECT_NEAR(both.x, std::sqrt(0.75), 1e-12);
    EXPECT_NEAR(both.y, 0.5, 1e-12);
}

TEST(Script, VelocitiesAreTheDerivativesOfThePose) {
    const Script script = parsed(R"(
[head.position_m]
interpolation = "smooth"
keys = [[0, 0, 1, 0], [1, 0.5, 1.5, -1], [2, 0, 1, 0]]
[head.orientation_deg]
interpolation = "smooth"
keys = [[0, 0, 0, 0], [1, 80, -40, 20], [2, -30, 60, -50]]
)");
    for (int i = 1; i < 20; ++i) {
        const DurationNs t = DurationNs{i} * 97'000'000, h = 1'000'000;  // 1 ms
        const PoseState before = head_at(script, t - h), now = head_at(script, t), after = head_at(script, t + h);
        const glm::vec3 linear = (after.pose.position - before.pose.position) / 0.002f;
        EXPECT_LT(glm::length(linear - now.linear_velocity), 2e-3f) << i;
        glm::quat turn = after.pose.orientation * glm::conjugate(before.pose.orientation);
        if (turn.w < 0) turn = -turn;
        const glm::vec3 axis(turn.x, turn.y, turn.z);
        const glm::vec3 angular = 2 * std::asin(std::min(1.0f, glm::length(axis))) / 0.002f * glm::normalize(axis);
        EXPECT_LT(glm::length(angular - now.angular_velocity), 2e-3f * (1 + glm::length(angular))) << i;
    }
}

TEST(Script, LoopsExactly) {
    const Script script = parsed("loop = true\nduration_s = 3\n[head.position_m]\nkeys = [[0, 0,0,0], [3, 3,0,0]]\n");
    for (DurationNs t : {0L, 1L, 1'234'567'890L, 2'999'999'999L}) {
        for (std::int64_t round : {1, 7, 100'000})
            EXPECT_EQ(head_at(script, t).pose.position.x, head_at(script, t + round * 3 * ns_per_s).pose.position.x);
    }
    EXPECT_EQ(head_at(script, 3 * ns_per_s).pose.position.x, 0);
}

TEST(Script, WithoutLoopTheEndStays) {
    const Script script = parsed("[head.position_m]\nkeys = [[0, 0,0,0], [3, 3,0,0]]\n");
    const PoseState end = head_at(script, 1000 * ns_per_s);
    EXPECT_FLOAT_EQ(end.pose.position.x, 3);
    EXPECT_EQ(end.linear_velocity, glm::vec3(0));
    EXPECT_DOUBLE_EQ(script.duration_s, 3);
}

TEST(Script, HeadLostHoldsThePositionAndKeepsTheOrientation) {
    const Script script = parsed(
        "[head.position_m]\nkeys = [[0, 0,0,0], [10, 10,0,0]]\n[head.orientation_deg]\nkeys = [[0, 0,0,0], [10, 90,0,0]]\n"
        "[lost]\nhead = [[2, 3]]\n");
    const PoseState lost = head_at(script, 4 * ns_per_s);
    EXPECT_FLOAT_EQ(lost.pose.position.x, 2);
    EXPECT_EQ(lost.linear_velocity, glm::vec3(0));
    EXPECT_TRUE(lost.position_valid);
    EXPECT_FALSE(lost.position_tracked);
    EXPECT_TRUE(lost.orientation_tracked);
    EXPECT_NEAR(2 * std::acos(lost.pose.orientation.w) * 57.29578, 36, 1e-3);
    const PoseState found = head_at(script, 5 * ns_per_s);
    EXPECT_TRUE(found.position_tracked);
    EXPECT_FLOAT_EQ(found.pose.position.x, 5);
}

TEST(Script, ControllersDoWhatIsWritten) {
    const Script script = parsed(R"(
[controllers.left]
position_m = { keys = [[0, 0,1,0], [4, 4,1,0]] }
orientation_deg = [90, 0, 0]
trigger = { interpolation = "hold", keys = [[0, 0], [1, 0.75]] }
thumbstick = [0.25, -0.5]
lost = [[2, 1]]
off = [[3, 0.5]]
[controllers.left.buttons]
menu = [[1, 0.1], [2, 0.1]]
[controllers.right]
enabled = false
)");
    const ControllerState one = controller_at(script, 0, ns_per_s);
    EXPECT_TRUE(one.active);
    EXPECT_FLOAT_EQ(one.grip.pose.position.x, 1);
    EXPECT_FLOAT_EQ(one.grip.linear_velocity.x, 1);
    EXPECT_NEAR(one.aim.pose.position.x, 1.05, 1e-6);  // 5 cm ahead, to the right
    EXPECT_FLOAT_EQ(one.trigger, 0.75f);
    EXPECT_TRUE(one.trigger_touch);
    EXPECT_TRUE(one.menu_click);
    EXPECT_FALSE(one.select_click);
    EXPECT_FLOAT_EQ(one.thumbstick.y, -0.5f);
    EXPECT_TRUE(one.thumbstick_touch);
    EXPECT_FALSE(controller_at(script, 0, ns_per_s + 100'000'001).menu_click);
    const ControllerState lost = controller_at(script, 0, 2 * ns_per_s + ns_per_s / 2);
    EXPECT_TRUE(lost.active);
    EXPECT_FLOAT_EQ(lost.grip.pose.position.x, 2);
    EXPECT_FALSE(lost.grip.position_tracked);
    EXPECT_FALSE(controller_at(script, 0, 3 * ns_per_s + 1).active);
    EXPECT_TRUE(controller_at(script, 0, 3 * ns_per_s + ns_per_s / 2).active);
    EXPECT_FALSE(controller_at(script, 1, 0).active);
}

TEST(Script, VergenceIsInterpolatedInDioptres) {
    const Script script = parsed("[gaze]\nvergence_m = { keys = [[0, inf], [1, 0.5]] }\n");
    EXPECT_DOUBLE_EQ(script.vergence_dioptres.at(0).value[0], 0);
    EXPECT_DOUBLE_EQ(script.vergence_dioptres.at(0.5).value[0], 1);
}

TEST(Script, PupilModelMeansNoDiameter) { EXPECT_FALSE(parsed("[pupil]\ndiameter_mm = \"model\"\n").pupil_mm); }

TEST(ScriptErrors, SayTheLineAndTheRemedy) {
    expect_error("[head]\nposition_m = [0, 1.6, 0]\npositon = 3\n", "test.toml:3:", "unknown key 'positon' in [head]");
    expect_error("version = 2\n", "test.toml:1:", "from 1 to 1");
    expect_error("\n\n[gaze\n", "test.toml:3:", "not valid TOML");
    expect_error("[head]\nposition_m = \"up\"\n", "test.toml:2:", "array of 3 numbers");
    expect_error("[head]\nposition_m = [1, 2]\n", "test.toml:2:", "array of 3 numbers");
    expect_error("[head]\nposition_m = [1, nan, 2]\n", "test.toml:2:", "number 2");
    expect_error("[head]\nposition_m = [1, 1e9, 2]\n", "test.toml:2:", "from -1000 to 1000");
    expect_error("[head.position_m]\nkeys = [[0, 0, 0, 0],\n [1, 0, 0]]\n", "test.toml:3:", "3 numbers");
    expect_error("[head.position_m]\nkeys = [[0, 0, 0, 0],\n[1, 0, 0, 0],\n[1, 0, 0, 0]]\n", "test.toml:4:", "times must increase");
    expect_error("[head.position_m]\nkeys = []\n", "test.toml:2:", "needs keys");
    expect_error("[head.position_m]\ninterpolation = \"linear\"\n", "test.toml:1:", "needs keys");
    expect_error("[head.position_m]\ninterpolation = \"saccade\"\nkeys = [[0,0,0,0]]\n", "test.toml:2:", "linear, smooth or hold");
    expect_error("[head.position_m]\nkey = [[0,0,0,0]]\n", "test.toml:2:", "unknown key 'key'");
    expect_error("[head.position_m]\nkeys = [[-1,0,0,0]]\n", "test.toml:2:", "time");
    expect_error("head = 3\n", "test.toml:1:", "must be a table");
    expect_error("loop = 1\n", "test.toml:1:", "true or false");
    expect_error("name = 1\n", "test.toml:1:", "a string");
    expect_error("loop = true\n", "test.toml:1:", "duration_s");
    expect_error("loop = true\nduration_s = 2\n[blinks]\nat = [[1.9]]\n", "test.toml:2:", "until its last event, 2.250 s");
    expect_error("[blinks]\nat = [[1], [1.2]]\n", "test.toml:2:", "follow each other");
    expect_error("[blinks]\nat = [1, 2]\n", "test.toml:2:", "[start]");
    expect_error("[lost]\neyes = [[1, 0]]\n", "test.toml:2:", "more than 0");
    expect_error("[lost]\neyes = [[1, 2], [2, 1]]\n", "test.toml:2:", "follow each other");
    expect_error("[pupil]\ndiameter_mm = 0\n", "test.toml:2:", "1.5 to 9");
    expect_error("[pupil]\ndiameter_mm = \"big\"\n", "test.toml:2:", "a number");
    expect_error("[gaze]\nleft_deg = [0, 0]\n", "test.toml:1:", "both left_deg and right_deg");
    expect_error("[gaze]\nvergence_m = 0\n", "test.toml:2:", "0.05");
    expect_error("[gaze.direction_deg]\nkeys = [[0, 0,0], [1, 20,0],\n [1.03, 0,0]]\n", "test.toml:3:", "1.065 s");
    expect_error("[tracker]\nlatency_ms = 1\n", "test.toml:1:", "latency_jitter_ms");
    expect_error("[tracker]\nlatency_jitter_ms = 3\n", "test.toml:1:", "half the time");
    expect_error("[controllers.left.buttons]\nx = [[0,1]]\n", "test.toml:2:", "unknown key 'x'");
    expect_error("[controllers.middle]\n", "test.toml:1:", "unknown key 'middle'");
}

TEST(ScriptErrors, RandomBytesNeverThrow) {
    std::uint64_t state = 1;
    const std::string alphabet = "[]{}=.\",\n #0123456789einfheadgazepupilkys_\\\"\t\x01\xff";
    for (int round = 0; round < 2000; ++round) {
        std::string text;
        for (int i = 0; i < 80; ++i) {
            state = state * 6364136223846793005ull + 1442695040888963407ull;
            text += alphabet[(state >> 33) % alphabet.size()];
        }
        (void)parse_script(text, "random");
    }
}

// Built-in scripts with a few bytes changed reach deeper than noise does: either an error or a script that can be evaluated.
TEST(ScriptErrors, DamagedScriptsNeverThrow) {
    std::uint64_t state = 2;
    const auto random = [&](std::uint64_t n) {
        state = state * 6364136223846793005ull + 1442695040888963407ull;
        return (state >> 33) % n;
    };
    int accepted = 0;
    for (int round = 0; round < 3000; ++round) {
        std::string text = builtin_scripts()[random(builtin_scripts().size())].text;
        for (int i = 0; i < 3; ++i) text[random(text.size())] = "0123456789.-[]e,=\n"[random(18)];
        const auto script = parse_script(text, "damaged");
        accepted += script ? 1 : 0;
        if (!script) continue;
        for (DurationNs t = 0; t < 20 * ns_per_s; t += 777'777'777) ASSERT_TRUE(std::isfinite(head_at(*script, t).pose.position.x));
    }
    EXPECT_GT(accepted, 100);
    EXPECT_LT(accepted, 2700);
}

TEST(Script, EveryBuiltinParsesAndHasItsName) {
    ASSERT_EQ(builtin_scripts().size(), 6u);
    for (const BuiltinScript& builtin : builtin_scripts()) {
        const auto script = load_script(builtin.name);
        ASSERT_TRUE(script) << script.error().message;
        EXPECT_EQ(script->name, builtin.name);
        EXPECT_NE(script->description, "");
    }
}

// A loop that jumps would be a glitch nobody asked for.
TEST(Script, BuiltinLoopsCloseSmoothly) {
    for (const BuiltinScript& builtin : builtin_scripts()) {
        const Script script = *load_script(builtin.name);
        if (!script.loop) continue;
        const auto end = static_cast<DurationNs>(script.duration_s * 1e9);
        const PoseState last = head_at(script, end - 1000), first = head_at(script, end);
        EXPECT_LT(glm::length(last.pose.position - first.pose.position), 1e-5f) << builtin.name;
        EXPECT_GT(std::abs(glm::dot(last.pose.orientation, first.pose.orientation)), 0.999999f) << builtin.name;
        EXPECT_EQ(script.gaze_deg.keys().front().value, script.gaze_deg.keys().back().value) << builtin.name;
    }
}

TEST(Script, FilesAreReadAndTheirAbsenceIsExplained) {
    const auto path = std::filesystem::temp_directory_path() / "entoptic_virtual_hmd_script_test.toml";
    std::ofstream(path) << "name = \"mine\"\n[pupil]\ndiameter_mm = 3\n";
    const auto script = load_script(path.string());
    std::filesystem::remove(path);
    ASSERT_TRUE(script) << script.error().message;
    EXPECT_EQ(script->name, "mine");
    const auto none = load_script("no-such-script");
    ASSERT_FALSE(none);
    EXPECT_NE(none.error().message.find("look-around"), std::string::npos);
}

// The example in the documentation is a script that works.
TEST(Script, TheDocumentedExampleParses) {
    std::ifstream file(ENTOPTIC_SOURCE_DIR "/drivers/virtual_hmd/virtual_hmd.md");
    std::ostringstream all;
    all << file.rdbuf();
    const std::string text = all.str();
    const auto begin = text.find("```toml\n"), end = text.find("```", begin + 8);
    ASSERT_NE(begin, std::string::npos);
    const auto script = parse_script(text.substr(begin + 8, end - begin - 8), "virtual_hmd.md");
    ASSERT_TRUE(script) << script.error().message;
    EXPECT_FALSE(script->blinks.empty());
    EXPECT_FALSE(script->eyes_lost.empty());
    EXPECT_GT(script->head_orientation_deg.keys().size(), 1u);
}

}  // namespace
}  // namespace entoptic::drivers
