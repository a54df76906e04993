#include "gpu/commands.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <fmt/format.h>
#include <utility>

namespace entoptic::gpu {
namespace {

constexpr std::uint32_t max_stages = 64;
constexpr std::uint32_t sets_per_pool = 128;

VkDescriptorType descriptor_type(BindingKind kind) {
    switch (kind) {
    case BindingKind::storage_buffer: return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    case BindingKind::uniform_buffer: return VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    case BindingKind::sampled_image: return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    }
    return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

}  // namespace

Result<Kernel> Kernel::create(const Device& device, const KernelInfo& info) {
    Kernel kernel;
    kernel.device_ = &device;
    kernel.bindings_ = info.bindings;
    kernel.push_constant_bytes_ = info.push_constant_bytes;
    std::vector<VkDescriptorSetLayoutBinding> bindings;
    for (BindingKind kind : info.bindings)
        bindings.push_back({static_cast<std::uint32_t>(bindings.size()), descriptor_type(kind), 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
    VkDescriptorSetLayoutCreateInfo set{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    set.bindingCount = static_cast<std::uint32_t>(bindings.size());
    set.pBindings = bindings.data();
    ENTOPTIC_VK(vkCreateDescriptorSetLayout(device.handle(), &set, nullptr, &kernel.set_layout_));
    const VkPushConstantRange range{VK_SHADER_STAGE_COMPUTE_BIT, 0, info.push_constant_bytes};
    VkPipelineLayoutCreateInfo layout{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    layout.setLayoutCount = 1;
    layout.pSetLayouts = &kernel.set_layout_;
    layout.pushConstantRangeCount = info.push_constant_bytes ? 1 : 0;
    layout.pPushConstantRanges = &range;
    ENTOPTIC_VK(vkCreatePipelineLayout(device.handle(), &layout, nullptr, &kernel.layout_));

    VkShaderModuleCreateInfo module_info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    module_info.codeSize = info.spirv.size_bytes();
    module_info.pCode = info.spirv.data();
    VkShaderModule module = VK_NULL_HANDLE;
    ENTOPTIC_VK(vkCreateShaderModule(device.handle(), &module_info, nullptr, &module));
    std::vector<VkSpecializationMapEntry> entries;
    for (std::uint32_t i = 0; i < info.specialization.size(); ++i) entries.push_back({i, i * 4, 4});
    VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()), entries.data(), info.specialization.size() * 4,
                                        info.specialization.data()};
    VkComputePipelineCreateInfo create{VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO};
    create.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    create.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    create.stage.module = module;
    create.stage.pName = "main";
    create.stage.pSpecializationInfo = entries.empty() ? nullptr : &specialization;
    create.layout = kernel.layout_;
    const VkResult result = vkCreateComputePipelines(device.handle(), VK_NULL_HANDLE, 1, &create, nullptr, &kernel.pipeline_);
    vkDestroyShaderModule(device.handle(), module, nullptr);
    if (result != VK_SUCCESS) {
        Error error = vulkan_error("vkCreateComputePipelines", result);
        error.message += fmt::format(", for the shader {}", info.name);
        return forward_error(error);
    }
    device.set_name(VK_OBJECT_TYPE_PIPELINE, reinterpret_cast<std::uint64_t>(kernel.pipeline_), info.name);
    return kernel;
}

Kernel::~Kernel() {
    if (!device_) return;
    vkDestroyPipeline(device_->handle(), pipeline_, nullptr);
    vkDestroyPipelineLayout(device_->handle(), layout_, nullptr);
    vkDestroyDescriptorSetLayout(device_->handle(), set_layout_, nullptr);
}

Kernel& Kernel::operator=(Kernel&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(set_layout_, other.set_layout_);
    std::swap(layout_, other.layout_);
    std::swap(pipeline_, other.pipeline_);
    std::swap(bindings_, other.bindings_);
    std::swap(push_constant_bytes_, other.push_constant_bytes_);
    return *this;
}

Result<Commands> Commands::create(Device& device, const std::string& name) {
    Commands commands;
    commands.device_ = &device;
    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = device.queue_family();
    ENTOPTIC_VK(vkCreateCommandPool(device.handle(), &pool, nullptr, &commands.pool_));
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = commands.pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    ENTOPTIC_VK(vkAllocateCommandBuffers(device.handle(), &allocate, &commands.command_buffer_));
    VkFenceCreateInfo fence{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    ENTOPTIC_VK(vkCreateFence(device.handle(), &fence, nullptr, &commands.fence_));
    if (device.timestamp_period_ns() > 0) {
        VkQueryPoolCreateInfo query{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
        query.queryType = VK_QUERY_TYPE_TIMESTAMP;
        query.queryCount = 2 * max_stages;
        ENTOPTIC_VK(vkCreateQueryPool(device.handle(), &query, nullptr, &commands.queries_));
    }
    device.set_name(VK_OBJECT_TYPE_COMMAND_BUFFER, reinterpret_cast<std::uint64_t>(commands.command_buffer_), name);
    return commands;
}

Commands::~Commands() {
    if (!device_) return;
    if (pending_) vkWaitForFences(device_->handle(), 1, &fence_, VK_TRUE, UINT64_MAX);
    for (VkDescriptorPool pool : descriptor_pools_) vkDestroyDescriptorPool(device_->handle(), pool, nullptr);
    vkDestroyQueryPool(device_->handle(), queries_, nullptr);
    vkDestroyFence(device_->handle(), fence_, nullptr);
    vkDestroyCommandPool(device_->handle(), pool_, nullptr);
}

Commands& Commands::operator=(Commands&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(pool_, other.pool_);
    std::swap(command_buffer_, other.command_buffer_);
    std::swap(fence_, other.fence_);
    std::swap(queries_, other.queries_);
    std::swap(descriptor_pools_, other.descriptor_pools_);
    std::swap(current_pool_, other.current_pool_);
    std::swap(stages_, other.stages_);
    std::swap(times_, other.times_);
    std::swap(pending_, other.pending_);
    return *this;
}

Result<void> Commands::begin() {
    assert(!pending_);
    for (VkDescriptorPool pool : descriptor_pools_) vkResetDescriptorPool(device_->handle(), pool, 0);
    current_pool_ = 0;
    stages_.clear();
    VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    ENTOPTIC_VK(vkBeginCommandBuffer(command_buffer_, &info));
    if (queries_) vkCmdResetQueryPool(command_buffer_, queries_, 0, 2 * max_stages);
    return {};
}

Result<VkDescriptorSet> Commands::allocate_set(const Kernel& kernel) {
    const VkDescriptorSetLayout layout = kernel.set_layout();
    VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    info.descriptorSetCount = 1;
    info.pSetLayouts = &layout;
    for (;; ++current_pool_) {
        if (current_pool_ == descriptor_pools_.size()) {
            const std::array<VkDescriptorPoolSize, 3> sizes{{{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, sets_per_pool * 8},
                                                             {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, sets_per_pool * 2},
                                                             {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, sets_per_pool * 4}}};
            VkDescriptorPoolCreateInfo pool{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
            pool.maxSets = sets_per_pool;
            pool.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
            pool.pPoolSizes = sizes.data();
            VkDescriptorPool created = VK_NULL_HANDLE;
            ENTOPTIC_VK(vkCreateDescriptorPool(device_->handle(), &pool, nullptr, &created));
            descriptor_pools_.push_back(created);
        }
        info.descriptorPool = descriptor_pools_[current_pool_];
        VkDescriptorSet set = VK_NULL_HANDLE;
        const VkResult result = vkAllocateDescriptorSets(device_->handle(), &info, &set);
        if (result == VK_SUCCESS) return set;
        if (result != VK_ERROR_OUT_OF_POOL_MEMORY && result != VK_ERROR_FRAGMENTED_POOL)
            return forward_error(vulkan_error("vkAllocateDescriptorSets", result));
    }
}

void Commands::bind(const Kernel& kernel, std::span<const Binding> bindings, std::span<const std::byte> push) {
    assert(bindings.size() == kernel.bindings().size());
    const auto set = allocate_set(kernel);
    assert(set.has_value());
    std::vector<VkWriteDescriptorSet> writes(bindings.size());
    for (std::size_t i = 0; i < bindings.size(); ++i) {
        writes[i] = {VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
        writes[i].dstSet = *set;
        writes[i].dstBinding = static_cast<std::uint32_t>(i);
        writes[i].descriptorCount = 1;
        writes[i].descriptorType = descriptor_type(kernel.bindings()[i]);
        writes[i].pBufferInfo = &bindings[i].buffer;
        writes[i].pImageInfo = &bindings[i].image;
    }
    vkUpdateDescriptorSets(device_->handle(), static_cast<std::uint32_t>(writes.size()), writes.data(), 0, nullptr);
    vkCmdBindPipeline(command_buffer_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.pipeline());
    vkCmdBindDescriptorSets(command_buffer_, VK_PIPELINE_BIND_POINT_COMPUTE, kernel.layout(), 0, 1, &*set, 0, nullptr);
    if (kernel.push_constant_bytes() == 0) return;
    assert(push.size() == kernel.push_constant_bytes());
    vkCmdPushConstants(command_buffer_, kernel.layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, static_cast<std::uint32_t>(push.size()), push.data());
}

void Commands::dispatch(const Kernel& kernel, std::span<const Binding> bindings, std::span<const std::byte> push, Groups groups) {
    if (groups.x == 0 || groups.y == 0 || groups.z == 0) return;
    bind(kernel, bindings, push);
    vkCmdDispatch(command_buffer_, groups.x, groups.y, groups.z);
}

void Commands::dispatch_indirect(const Kernel& kernel, std::span<const Binding> bindings, std::span<const std::byte> push, const Buffer& arguments,
                                 std::size_t offset) {
    bind(kernel, bindings, push);
    vkCmdDispatchIndirect(command_buffer_, arguments.handle(), offset);
}

void Commands::barrier() {
    VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    barrier.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_INDIRECT_COMMAND_READ_BIT |
                            VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
    const VkPipelineStageFlags work = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
    vkCmdPipelineBarrier(command_buffer_, work, work | VK_PIPELINE_STAGE_DRAW_INDIRECT_BIT, 0, 1, &barrier, 0, nullptr, 0, nullptr);
}

void Commands::fill(const Buffer& buffer, std::uint32_t value, std::size_t offset, std::size_t size) {
    vkCmdFillBuffer(command_buffer_, buffer.handle(), offset, size, value);
}

void Commands::copy(const Buffer& from, const Buffer& to, std::size_t bytes, std::size_t from_offset, std::size_t to_offset) {
    const VkBufferCopy region{from_offset, to_offset, bytes};
    vkCmdCopyBuffer(command_buffer_, from.handle(), to.handle(), 1, &region);
}

void Commands::begin_stage(std::string_view name) {
    if (!queries_ || stages_.size() >= max_stages) return;
    vkCmdWriteTimestamp(command_buffer_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, static_cast<std::uint32_t>(2 * stages_.size()));
    stages_.emplace_back(name);
}

void Commands::end_stage() {
    if (!queries_ || stages_.empty()) return;
    vkCmdWriteTimestamp(command_buffer_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, queries_, static_cast<std::uint32_t>(2 * stages_.size() - 1));
}

Result<void> Commands::submit(VkSemaphore wait, VkPipelineStageFlags wait_stage, VkSemaphore signal) {
    VkMemoryBarrier host{VK_STRUCTURE_TYPE_MEMORY_BARRIER};
    host.srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
    host.dstAccessMask = VK_ACCESS_HOST_READ_BIT;
    vkCmdPipelineBarrier(command_buffer_, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &host,
                         0, nullptr, 0, nullptr);
    ENTOPTIC_VK(vkEndCommandBuffer(command_buffer_));
    VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    info.commandBufferCount = 1;
    info.pCommandBuffers = &command_buffer_;
    info.waitSemaphoreCount = wait ? 1 : 0;
    info.pWaitSemaphores = &wait;
    info.pWaitDstStageMask = &wait_stage;
    info.signalSemaphoreCount = signal ? 1 : 0;
    info.pSignalSemaphores = &signal;
    const std::lock_guard lock(device_->queue_mutex());
    ENTOPTIC_VK(vkResetFences(device_->handle(), 1, &fence_));
    ENTOPTIC_VK(vkQueueSubmit(device_->queue(), 1, &info, fence_));
    pending_ = true;
    return {};
}

Result<void> Commands::wait() {
    if (!pending_) return {};
    ENTOPTIC_VK(vkWaitForFences(device_->handle(), 1, &fence_, VK_TRUE, UINT64_MAX));
    pending_ = false;
    times_.clear();
    if (!queries_ || stages_.empty()) return {};
    std::vector<std::uint64_t> ticks(2 * stages_.size());
    ENTOPTIC_VK(vkGetQueryPoolResults(device_->handle(), queries_, 0, static_cast<std::uint32_t>(ticks.size()), ticks.size() * 8, ticks.data(), 8,
                                      VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT));
    for (std::size_t i = 0; i < stages_.size(); ++i)
        times_.push_back({stages_[i], static_cast<double>(ticks[2 * i + 1] - ticks[2 * i]) * device_->timestamp_period_ns() * 1e-6});
    return {};
}

std::vector<StageTime> Commands::stage_times() const { return times_; }

}  // namespace entoptic::gpu
