// Loaded before an application (LD_PRELOAD): counts its calls of the frame loop and ends the process at one of them, in the way that
// ENTOPTIC_TEST_END names, at the call that ENTOPTIC_TEST_CALL counts to, once ENTOPTIC_TEST_AFTER calls of xrEndFrame have been made
// (0: from xrBeginSession on, which is call 1):
//   killed   SIGKILL before the runtime hears of the call: nothing of the process can clean up
//   exits    exit(3) after the call: destructors and exit handlers run while the session lives
// What was called is said on stderr, so that a run tells where it ended.
#include <dlfcn.h>
#include <openxr/openxr.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace {

int number_of(const char* variable) {
    const char* text = std::getenv(variable);
    return text ? std::atoi(text) : 0;
}

std::string_view wanted_end() {
    const char* text = std::getenv("ENTOPTIC_TEST_END");
    return text ? text : "killed";
}

std::atomic<int> calls{0}, frames{0};
std::atomic<bool> begun = false;

// True when this call is the one to end at.
bool arrives(std::string_view name) {
    if (name == "xrBeginSession") begun = true;
    const bool counted = begun && frames >= number_of("ENTOPTIC_TEST_AFTER");
    if (name == "xrEndFrame") ++frames;
    if (!counted || ++calls != number_of("ENTOPTIC_TEST_CALL")) return false;
    std::fprintf(stderr, "ending (%s) at call %d, %s\n", wanted_end().data(), calls.load(), name.data());
    return true;
}

template <typename Function, typename... Arguments> XrResult call(const char* name, Arguments... arguments) {
    static const auto next = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
    const bool end = arrives(name);
    if (end && wanted_end() == "killed") kill(getpid(), SIGKILL);
    const XrResult result = next(arguments...);
    if (end && wanted_end() == "exits") std::exit(3);
    return result;
}

}  // namespace

#define ENTOPTIC_CALL(name, parameters, ...) \
    extern "C" __attribute__((visibility("default"))) XrResult name parameters { return call<decltype(name)>(#name, __VA_ARGS__); }

ENTOPTIC_CALL(xrBeginSession, (XrSession a, const XrSessionBeginInfo* b), a, b)
ENTOPTIC_CALL(xrEndSession, (XrSession a), a)
ENTOPTIC_CALL(xrPollEvent, (XrInstance a, XrEventDataBuffer* b), a, b)
ENTOPTIC_CALL(xrSyncActions, (XrSession a, const XrActionsSyncInfo* b), a, b)
ENTOPTIC_CALL(xrGetActionStateFloat, (XrSession a, const XrActionStateGetInfo* b, XrActionStateFloat* c), a, b, c)
ENTOPTIC_CALL(xrLocateSpace, (XrSpace a, XrSpace b, XrTime c, XrSpaceLocation* d), a, b, c, d)
ENTOPTIC_CALL(xrLocateViews, (XrSession a, const XrViewLocateInfo* b, XrViewState* c, uint32_t d, uint32_t* e, XrView* f), a, b, c, d, e, f)
ENTOPTIC_CALL(xrWaitFrame, (XrSession a, const XrFrameWaitInfo* b, XrFrameState* c), a, b, c)
ENTOPTIC_CALL(xrBeginFrame, (XrSession a, const XrFrameBeginInfo* b), a, b)
ENTOPTIC_CALL(xrAcquireSwapchainImage, (XrSwapchain a, const XrSwapchainImageAcquireInfo* b, uint32_t* c), a, b, c)
ENTOPTIC_CALL(xrWaitSwapchainImage, (XrSwapchain a, const XrSwapchainImageWaitInfo* b), a, b)
ENTOPTIC_CALL(xrReleaseSwapchainImage, (XrSwapchain a, const XrSwapchainImageReleaseInfo* b), a, b)
ENTOPTIC_CALL(xrEndFrame, (XrSession a, const XrFrameEndInfo* b), a, b)
