// How an image crosses from the compositor to an application: memory on a file descriptor and the numbers to import it.
#pragma once

#include <array>
#include <cstdint>

namespace entoptic {

// An image allocated by the compositor for an application to render into. Plain numbers: the Vulkan enumerators are stored
// as integers so that no room has to include vulkan.h for this header. The importer must create its image with exactly these
// numbers, TILING_OPTIMAL, external handle type OPAQUE_FD, and bind the memory at offset 0 as a dedicated allocation.
struct ImageMemory {
    int fd = -1;                     // opaque fd, owned by the receiver; a successful import takes it over
    std::uint64_t size = 0;          // bytes of the allocation
    std::uint32_t vk_format = 0;     // VkFormat
    std::uint32_t vk_usage = 0;      // VkImageUsageFlags
    std::uint32_t vk_create_flags = 0;
    std::uint32_t width = 0, height = 0, array_layers = 1, mip_levels = 1, samples = 1;
    std::uint32_t memory_type_bits = 0;              // of the exporting device; same index space on the same physical device
    std::array<std::uint8_t, 16> device_uuid{}, driver_uuid{};
};

}  // namespace entoptic
