// labels: unit
// The runtime library as the loader and the application meet it.
#include "app/host/eye_size.h"
#include "drivers/driver.h"
#include "runtime/loader_interface.h"

#include <array>
#include <cstdio>
#include <dlfcn.h>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace entoptic::app {
namespace {

const std::string library = ENTOPTIC_BINARY_DIR "/lib/libopenxr_entoptic.so";

std::string output_of(const std::string& command) {
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
    std::string out;
    std::array<char, 4096> part{};
    while (pipe && std::fgets(part.data(), int(part.size()), pipe.get())) out += part.data();
    return out;
}

TEST(Library, ExportsTheLoadersEntryAndNothingElse) {
    const std::string symbols = output_of("nm -D --defined-only '" + library + "' | awk '$2 != \"A\" { print $3 }'");
    EXPECT_EQ(symbols, "xrNegotiateLoaderRuntimeInterface\n");
}

TEST(Library, DoesNotNeedTheLoader) {
    const std::string needed = output_of("readelf -d '" + library + "' | grep NEEDED");
    EXPECT_NE(needed.find("libvulkan"), std::string::npos) << needed;
    EXPECT_EQ(needed.find("openxr_loader"), std::string::npos) << needed;
    EXPECT_EQ(output_of("readelf -d '" ENTOPTIC_BINARY_DIR "/bin/entoptic' | grep openxr_loader"), "");
}

TEST(Library, TheManifestOfTheBuildTreeNamesIt) {
    std::ifstream in(ENTOPTIC_BINARY_DIR "/openxr_entoptic-dev.json");
    const auto manifest = nlohmann::json::parse(in);
    EXPECT_EQ(manifest.at("file_format_version"), "1.0.0");
    const std::string path = manifest.at("runtime").at("library_path");
    EXPECT_TRUE(std::ifstream(ENTOPTIC_BINARY_DIR "/" + path).good()) << path;
}

TEST(Library, NegotiatesWithALoader) {
    void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL);
    ASSERT_TRUE(handle) << dlerror();
    using Negotiate = XrResult (*)(const XrNegotiateLoaderInfo*, XrNegotiateRuntimeRequest*);
    const auto negotiate = reinterpret_cast<Negotiate>(dlsym(handle, "xrNegotiateLoaderRuntimeInterface"));
    ASSERT_TRUE(negotiate);
    const XrNegotiateLoaderInfo info{XR_LOADER_INTERFACE_STRUCT_LOADER_INFO,
                                     XR_LOADER_INFO_STRUCT_VERSION,
                                     sizeof(XrNegotiateLoaderInfo),
                                     1,
                                     1,
                                     XR_MAKE_VERSION(1, 0, 0),
                                     XR_MAKE_VERSION(1, 0xfff, 0xfff)};
    XrNegotiateRuntimeRequest request{
        XR_LOADER_INTERFACE_STRUCT_RUNTIME_REQUEST, XR_RUNTIME_INFO_STRUCT_VERSION, sizeof(XrNegotiateRuntimeRequest), 0, 0, nullptr};
    EXPECT_EQ(negotiate(&info, &request), XR_SUCCESS);
    EXPECT_EQ(request.runtimeInterfaceVersion, 1u);
    EXPECT_TRUE(request.getInstanceProcAddr);
    dlclose(handle);
}

TEST(EyeSize, KeepsTheCentresDensity) {
    drivers::DriverOptions options;
    const auto headset = drivers::open_headset(options);
    ASSERT_TRUE(headset) << headset.error().message;
    const EyeSize size = recommended_eye_size(*headset, 1);
    // Of the example lens: its grow_for_undistort is 0.6, so the flat picture is 1.6 panels wide where the centre has its density.
    EXPECT_NEAR(size.width / 1440.0, 1.6, 0.02);
    EXPECT_NEAR(size.height / 1600.0, 1.6, 0.02);
    EXPECT_EQ(size.width % 2, 0u);
    EXPECT_EQ(size.height % 2, 0u);
    const EyeSize half = recommended_eye_size(*headset, 0.5);
    EXPECT_NEAR(half.width, size.width / 2.0, 2);
}

}  // namespace
}  // namespace entoptic::app
