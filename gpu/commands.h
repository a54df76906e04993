// Kernels (compute pipelines) and the recording of one batch of GPU work, with a time for each named stage.
//
//   Commands c = ...;
//   c.begin();
//   c.begin_stage("warp");
//   c.dispatch(kernel, {buffer, view}, push, {groups_x, groups_y, 1});
//   c.barrier();
//   c.end_stage();
//   c.submit(); c.wait();
//   c.stage_times()
#pragma once

#include "gpu/device.h"
#include "gpu/memory.h"

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace entoptic::gpu {

// Parameters that are the same for all invocations belong in uniform buffers: on lavapipe a load from a storage buffer costs a bounds check
// and a branch each (a pass with 85 of them: 65 ms, from uniform buffers 43 ms).
enum class BindingKind { storage_buffer, sampled_image, uniform_buffer };

// What a compute shader expects. Bindings are set 0, binding 0, 1, 2 … in this order.
struct KernelInfo {
    std::string name;
    std::span<const std::uint32_t> spirv;
    std::vector<BindingKind> bindings;
    std::uint32_t push_constant_bytes = 0;                 // at most 128
    std::vector<std::uint32_t> specialization;             // constant_id 0, 1, 2 …
};

class Kernel {
public:
    Kernel() = default;
    static Result<Kernel> create(const Device& device, const KernelInfo& info);
    ~Kernel();
    Kernel(Kernel&& other) noexcept { *this = std::move(other); }
    Kernel& operator=(Kernel&& other) noexcept;

    VkPipeline pipeline() const { return pipeline_; }
    VkPipelineLayout layout() const { return layout_; }
    VkDescriptorSetLayout set_layout() const { return set_layout_; }
    const std::vector<BindingKind>& bindings() const { return bindings_; }
    std::uint32_t push_constant_bytes() const { return push_constant_bytes_; }
    explicit operator bool() const { return pipeline_ != VK_NULL_HANDLE; }

private:
    const Device* device_ = nullptr;
    VkDescriptorSetLayout set_layout_ = VK_NULL_HANDLE;
    VkPipelineLayout layout_ = VK_NULL_HANDLE;
    VkPipeline pipeline_ = VK_NULL_HANDLE;
    std::vector<BindingKind> bindings_;
    std::uint32_t push_constant_bytes_ = 0;
};

// One bound resource: a whole buffer or a part of it, or a view with a sampler (layout GENERAL or as given).
struct Binding {
    Binding(const Buffer& b, std::size_t offset = 0, std::size_t size = VK_WHOLE_SIZE) : buffer{b.handle(), offset, size} {}
    Binding(VkImageView view, VkSampler sampler, VkImageLayout layout) : image{sampler, view, layout} {}
    VkDescriptorBufferInfo buffer{};
    VkDescriptorImageInfo image{};
};

struct Groups {
    std::uint32_t x = 1, y = 1, z = 1;
};
// Workgroups of `size` that cover `count` items.
constexpr std::uint32_t groups_for(std::uint32_t count, std::uint32_t size) { return (count + size - 1) / size; }

struct StageTime {
    std::string name;
    double ms = 0;
};

class Commands {
public:
    static Result<Commands> create(Device& device, const std::string& name);
    Commands() = default;
    ~Commands();
    Commands(Commands&& other) noexcept { *this = std::move(other); }
    Commands& operator=(Commands&& other) noexcept;

    // Starts a new batch; the previous one must have been waited for.
    Result<void> begin();
    void dispatch(const Kernel& kernel, std::span<const Binding> bindings, std::span<const std::byte> push, Groups groups);
    // Group counts are read from `arguments` (a VkDispatchIndirectCommand at `offset`) when the GPU gets there. Zero: nothing runs.
    void dispatch_indirect(const Kernel& kernel, std::span<const Binding> bindings, std::span<const std::byte> push, const Buffer& arguments,
                           std::size_t offset);
    // All earlier compute and transfer writes become visible to later compute, indirect and transfer commands.
    void barrier();
    void fill(const Buffer& buffer, std::uint32_t value, std::size_t offset = 0, std::size_t size = VK_WHOLE_SIZE);
    void copy(const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t from_offset = 0, std::size_t to_offset = 0);
    VkCommandBuffer handle() const { return command_buffer_; }    // for image barriers and blits

    // Stages do not nest; work outside them is not timed.
    void begin_stage(std::string_view name);
    void end_stage();

    Result<void> submit(VkSemaphore wait = VK_NULL_HANDLE, VkPipelineStageFlags wait_stage = 0, VkSemaphore signal = VK_NULL_HANDLE);
    Result<void> wait();     // until the GPU has finished; buffers for the CPU are readable then
    std::vector<StageTime> stage_times() const;    // of the batch waited for last; empty without timestamps

    // Typed push constants and literal lists of bindings.
    template <class Push> void dispatch(const Kernel& kernel, std::initializer_list<Binding> bindings, const Push& push, Groups groups) {
        dispatch(kernel, std::span(bindings.begin(), bindings.size()), std::as_bytes(std::span(&push, 1)), groups);
    }
    template <class Push>
    void dispatch_indirect(const Kernel& kernel, std::initializer_list<Binding> bindings, const Push& push, const Buffer& arguments, std::size_t offset) {
        dispatch_indirect(kernel, std::span(bindings.begin(), bindings.size()), std::as_bytes(std::span(&push, 1)), arguments, offset);
    }

private:
    void bind(const Kernel& kernel, std::span<const Binding> bindings, std::span<const std::byte> push);
    Result<VkDescriptorSet> allocate_set(const Kernel& kernel);

    Device* device_ = nullptr;
    VkCommandPool pool_ = VK_NULL_HANDLE;
    VkCommandBuffer command_buffer_ = VK_NULL_HANDLE;
    VkFence fence_ = VK_NULL_HANDLE;
    VkQueryPool queries_ = VK_NULL_HANDLE;
    std::vector<VkDescriptorPool> descriptor_pools_;
    std::size_t current_pool_ = 0;
    std::vector<std::string> stages_;
    std::vector<StageTime> times_;
    bool pending_ = false;
};

struct NoPush {};   // for kernels without push constants

}  // namespace entoptic::gpu
