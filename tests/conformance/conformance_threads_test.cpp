// labels: gpu
// Many threads at once: pipelined frames, calls during destruction, waits that another call ends.
#include "runtime/testing/client.h"

#include <atomic>
#include <thread>

namespace entoptic::runtime::testing {
namespace {

class Threads : public SessionTest {};

TEST_F(Threads, WaitAndRenderInTwoThreads) {
    ASSERT_EQ(begin_session(), XR_SUCCESS);
    constexpr int frames = 200;
    std::mutex mutex;
    std::condition_variable ready;
    std::vector<XrTime> queue;
    std::thread waiter([&] {
        for (int i = 0; i < frames; ++i) {
            XrFrameState state{XR_TYPE_FRAME_STATE};
            EXPECT_EQ(xr.xrWaitFrame(session, nullptr, &state), XR_SUCCESS);
            std::lock_guard lock(mutex);
            queue.push_back(state.predictedDisplayTime);
            ready.notify_one();
        }
    });
    XrTime last = 0;
    for (int i = 0; i < frames; ++i) {
        XrTime time = 0;
        {
            std::unique_lock lock(mutex);
            ready.wait(lock, [&] { return !queue.empty(); });
            time = queue.front();
            queue.erase(queue.begin());
        }
        EXPECT_GT(time, last);
        last = time;
        EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_SUCCESS);
        EXPECT_EQ(end_frame(time), XR_SUCCESS);
    }
    waiter.join();
    EXPECT_EQ(xr.host->service.submitted_count, frames);
}

TEST_F(Threads, ASecondWaitIsReleasedByBeginOrEnd) {
    ASSERT_EQ(begin_session(), XR_SUCCESS);
    static_cast<void>(wait_frame());
    std::atomic<int> returned{0};
    std::thread blocked([&] {
        XrFrameState state{XR_TYPE_FRAME_STATE};
        EXPECT_EQ(xr.xrWaitFrame(session, nullptr, &state), XR_SUCCESS);
        ++returned;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(returned, 0);
    EXPECT_EQ(xr.xrBeginFrame(session, nullptr), XR_SUCCESS);
    blocked.join();

    std::thread stopped([&] {
        XrFrameState state{XR_TYPE_FRAME_STATE};
        EXPECT_EQ(xr.xrWaitFrame(session, nullptr, &state), XR_ERROR_SESSION_NOT_RUNNING);
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(xr.xrRequestExitSession(session), XR_SUCCESS);
    EXPECT_EQ(xr.xrEndSession(session), XR_SUCCESS);
    stopped.join();
}

TEST_F(Threads, DestroyDuringAWait) {
    ASSERT_EQ(begin_session(), XR_SUCCESS);
    static_cast<void>(wait_frame());
    std::thread blocked([&] {
        XrFrameState state{XR_TYPE_FRAME_STATE};
        const XrResult result = xr.xrWaitFrame(session, nullptr, &state);
        EXPECT_TRUE(result == XR_ERROR_SESSION_NOT_RUNNING || result == XR_ERROR_HANDLE_INVALID) << result;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(xr.xrDestroySession(session), XR_SUCCESS);
    blocked.join();
    session = XR_NULL_HANDLE;
}

TEST_F(Threads, ABlockedImageDoesNotBlockOthers) {
    const XrSwapchain blocked = make_swapchain(), other = make_swapchain();
    xr.host->service.block_image(1, 0, true);
    std::uint32_t index = 0;
    ASSERT_EQ(xr.xrAcquireSwapchainImage(blocked, nullptr, &index), XR_SUCCESS);
    std::thread waiter([&] { EXPECT_EQ(wait_image(blocked), XR_SUCCESS); });
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_EQ(wait_image(blocked, 0), XR_ERROR_CALL_ORDER_INVALID) << "one thread waits already";
    for (int i = 0; i < 5; ++i) static_cast<void>(cycle(other));
    ASSERT_EQ(xr.xrAcquireSwapchainImage(blocked, nullptr, &index), XR_SUCCESS);
    EXPECT_EQ(index, 1u);
    xr.host->service.block_image(1, 0, false);
    waiter.join();
}

TEST_F(Threads, EverythingAtOnce) {
    run_to_focus();
    std::vector<std::thread> threads;
    std::atomic<bool> stop{false};
    const XrSpace local = reference_space(XR_REFERENCE_SPACE_TYPE_LOCAL);
    threads.emplace_back([&] {
        while (!stop) {
            const XrReferenceSpaceCreateInfo info{
                XR_TYPE_REFERENCE_SPACE_CREATE_INFO, nullptr, XR_REFERENCE_SPACE_TYPE_VIEW, {{0, 0, 0, 1}, {0, 0, 0}}};
            XrSpace space = XR_NULL_HANDLE;
            EXPECT_EQ(xr.xrCreateReferenceSpace(session, &info, &space), XR_SUCCESS);
            XrSpaceLocation location{XR_TYPE_SPACE_LOCATION};
            EXPECT_EQ(xr.xrLocateSpace(space, local, now(), &location), XR_SUCCESS);
            EXPECT_EQ(xr.xrDestroySpace(space), XR_SUCCESS);
        }
    });
    threads.emplace_back([&] {
        for (int i = 0; !stop; ++i) {
            const std::string name = "set" + std::to_string(i);
            XrActionSetCreateInfo info{XR_TYPE_ACTION_SET_CREATE_INFO, nullptr, "", "", 0};
            std::strcpy(info.actionSetName, name.c_str());
            std::strcpy(info.localizedActionSetName, name.c_str());
            XrActionSet set = XR_NULL_HANDLE;
            EXPECT_EQ(xr.xrCreateActionSet(xr.instance, &info, &set), XR_SUCCESS);
            EXPECT_EQ(xr.xrDestroyActionSet(set), XR_SUCCESS);
        }
    });
    threads.emplace_back([&] {
        while (!stop) {
            XrPath path = XR_NULL_PATH;
            EXPECT_EQ(xr.xrStringToPath(xr.instance, "/user/hand/left", &path), XR_SUCCESS);
            XrEventDataBuffer event{XR_TYPE_EVENT_DATA_BUFFER};
            EXPECT_TRUE(XR_SUCCEEDED(xr.xrPollEvent(xr.instance, &event)));
            const XrActionsSyncInfo sync{XR_TYPE_ACTIONS_SYNC_INFO};
            EXPECT_TRUE(XR_SUCCEEDED(xr.xrSyncActions(session, &sync)));
        }
    });
    for (int i = 0; i < 100; ++i) EXPECT_EQ(frame(), XR_SUCCESS);
    stop = true;
    for (std::thread& thread : threads) thread.join();
}

}  // namespace
}  // namespace entoptic::runtime::testing
