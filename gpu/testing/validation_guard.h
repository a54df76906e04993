// For tests: fails the program when the Vulkan validation layer said anything. Header-only.
#pragma once

#include "gpu/device.h"

#include <gtest/gtest.h>

namespace entoptic::gpu::testing {

// Register once a test program:  const auto* guard = ::testing::AddGlobalTestEnvironment(new ValidationGuard(&test_device));
class ValidationGuard : public ::testing::Environment {
public:
    explicit ValidationGuard(Device& (*device)()) : device_(device) {}
    void TearDown() override { EXPECT_EQ(device_().validation_messages(), 0u) << "the Vulkan validation layer complained"; }

private:
    Device& (*device_)();
};

}  // namespace entoptic::gpu::testing
