// labels: unit
#include "app/system/active_runtime.h"

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

namespace entoptic::app {
namespace {

namespace fs = std::filesystem;

class ActiveRuntimeTest : public ::testing::Test {
protected:
    void SetUp() override {
        write("ours/openxr.json", R"({"file_format_version":"1.0.0","runtime":{"library_path":"lib/ours.so"}})");
        write("other/openxr.json", R"({"file_format_version":"1.0.0","runtime":{"library_path":"/usr/lib/other.so"}})");
    }
    void TearDown() override { fs::remove_all(folder_); }
    void write(const std::string& name, const std::string& text) const {
        fs::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name) << text;
    }
    std::string path(const std::string& name) const { return (folder_ / name).string(); }
    ActiveRuntime runtime(std::optional<std::string> forced = {}) const { return {path("user"), {path("system")}, forced}; }
    std::string ours() const { return path("ours/openxr.json"); }

    fs::path folder_ = fs::temp_directory_path() / ("entoptic_active_runtime_" + std::to_string(getpid()));
};

TEST_F(ActiveRuntimeTest, SetAndRestoreLeaveNothingBehind) {
    EXPECT_EQ(runtime().current(ours()).file, "");
    EXPECT_EQ(runtime().restore(ours()), false);
    ASSERT_TRUE(runtime().set(ours()));
    ASSERT_TRUE(runtime().set(ours()));  // again: nothing to do
    const RuntimeChoice now = runtime().current(ours());
    EXPECT_TRUE(now.ours);
    EXPECT_EQ(now.library, path("ours/lib/ours.so"));
    EXPECT_EQ(runtime().restore(ours()), true);
    EXPECT_TRUE(fs::is_empty(path("user/openxr/1")));
}

TEST_F(ActiveRuntimeTest, WhatWasThereComesBackFileOrLink) {
    for (const bool link : {true, false}) {
        fs::remove_all(path("user"));
        fs::create_directories(path("user/openxr/1"));
        if (link)
            fs::create_symlink(path("other/openxr.json"), runtime().user_file());
        else
            write("user/openxr/1/active_runtime.json", "{}");
        ASSERT_TRUE(runtime().set(ours()));
        EXPECT_TRUE(runtime().current(ours()).ours);
        EXPECT_EQ(runtime().restore(ours()), true);
        EXPECT_FALSE(runtime().current(ours()).ours);
        EXPECT_EQ(fs::is_symlink(runtime().user_file()), link);
        EXPECT_FALSE(fs::exists(runtime().kept_file()));
    }
}

TEST_F(ActiveRuntimeTest, ALinkToARuntimeThatIsGoneIsKept) {
    fs::create_directories(path("user/openxr/1"));
    fs::create_symlink(path("gone.json"), runtime().user_file());
    ASSERT_TRUE(runtime().set(ours()));
    EXPECT_EQ(runtime().restore(ours()), true);
    EXPECT_TRUE(fs::is_symlink(runtime().user_file()));
}

TEST_F(ActiveRuntimeTest, NothingOfAnothersIsOverwritten) {
    ASSERT_TRUE(runtime().set(ours()));
    fs::remove(runtime().user_file());
    write("user/openxr/1/active_runtime.json", "{}");  // somebody set another since
    write("user/openxr/1/active_runtime.json.before-entoptic", "{}");
    EXPECT_FALSE(runtime().set(ours()));
    EXPECT_FALSE(runtime().restore(ours()));
    EXPECT_TRUE(fs::exists(runtime().user_file()));
}

TEST_F(ActiveRuntimeTest, TheLoadersOrder) {
    write("system/openxr/1/active_runtime.json", R"({"runtime":{"library_path":"libplain.so"}})");
    EXPECT_EQ(runtime().current(ours()).library, "libplain.so");
    EXPECT_EQ(runtime().current(ours()).source, "the system's choice");
    write("user/openxr/1/active_runtime.json", "not json");
    EXPECT_EQ(runtime().current(ours()).library, "");
    EXPECT_EQ(runtime().current(ours()).source, "this user's choice");
#if defined(__x86_64__)
    write("user/openxr/1/active_runtime.x86_64.json", R"({"runtime":{"library_path":"/a/b.so"}})");
    EXPECT_EQ(runtime().current(ours()).library, "/a/b.so");
#endif
    EXPECT_TRUE(runtime(ours()).current(ours()).ours);
}

}  // namespace
}  // namespace entoptic::app
