#include "samples/common/eye_pass.h"

#include <array>

namespace samples {

static VkAttachmentDescription2 attachment(VkFormat format, VkSampleCountFlagBits samples, VkAttachmentLoadOp load,
                                           VkAttachmentStoreOp store, VkImageLayout layout, bool over = false) {
    VkAttachmentDescription2 description{VK_STRUCTURE_TYPE_ATTACHMENT_DESCRIPTION_2};
    description.format = format;
    description.samples = samples;
    description.loadOp = load;
    description.storeOp = store;
    description.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    description.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    description.initialLayout = over ? layout : VK_IMAGE_LAYOUT_UNDEFINED;  // undefined: what was there may go
    description.finalLayout = layout;
    return description;
}

static VkAttachmentReference2 reference(std::size_t attachment, VkImageLayout layout, VkImageAspectFlags aspect) {
    return {VK_STRUCTURE_TYPE_ATTACHMENT_REFERENCE_2, nullptr, static_cast<std::uint32_t>(attachment), layout, aspect};
}

// Attachments: 0 the image that is kept; then depth, if any; then the multisample image, if any; then the depth that it is resolved to.
OwnedRenderPass create_render_pass(const Gpu& gpu, const PassFormat& format) {
    constexpr auto colour_layout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    constexpr auto depth_layout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    constexpr auto clear = VK_ATTACHMENT_LOAD_OP_CLEAR, ignore = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    constexpr auto store = VK_ATTACHMENT_STORE_OP_STORE, drop = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    const bool resolves = format.samples != VK_SAMPLE_COUNT_1_BIT;
    std::vector<VkAttachmentDescription2> attachments;
    attachments.push_back(attachment(format.colour, VK_SAMPLE_COUNT_1_BIT, resolves ? ignore : clear, store, colour_layout, format.over));
    const auto kept = reference(0, colour_layout, VK_IMAGE_ASPECT_COLOR_BIT);
    const auto depth = reference(1, depth_layout, VK_IMAGE_ASPECT_DEPTH_BIT);
    if (format.depth) {
        attachments.push_back(attachment(VK_FORMAT_D32_SFLOAT, format.samples, clear, format.keep_depth && !resolves ? store : drop,
                                         depth_layout, format.over && format.keep_depth && !resolves));
    }
    const auto multisample = reference(attachments.size(), colour_layout, VK_IMAGE_ASPECT_COLOR_BIT);
    if (resolves) { attachments.push_back(attachment(format.colour, format.samples, clear, drop, colour_layout)); }
    const auto kept_depth = reference(attachments.size(), depth_layout, VK_IMAGE_ASPECT_DEPTH_BIT);
    VkSubpassDescriptionDepthStencilResolve depth_resolve{VK_STRUCTURE_TYPE_SUBPASS_DESCRIPTION_DEPTH_STENCIL_RESOLVE};
    depth_resolve.depthResolveMode = VK_RESOLVE_MODE_SAMPLE_ZERO_BIT;
    depth_resolve.pDepthStencilResolveAttachment = &kept_depth;
    if (resolves && format.keep_depth) {
        attachments.push_back(attachment(VK_FORMAT_D32_SFLOAT, VK_SAMPLE_COUNT_1_BIT, ignore, store, depth_layout, format.over));
    }
    VkSubpassDescription2 subpass{VK_STRUCTURE_TYPE_SUBPASS_DESCRIPTION_2};
    subpass.pNext = resolves && format.keep_depth ? &depth_resolve : nullptr;
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = resolves ? &multisample : &kept;
    subpass.pResolveAttachments = resolves ? &kept : nullptr;
    subpass.pDepthStencilAttachment = format.depth ? &depth : nullptr;

    // The depth and multisample images are shared by successive pictures of an eye: the next must not begin to write
    // before the last has finished.
    VkSubpassDependency2 dependency{VK_STRUCTURE_TYPE_SUBPASS_DEPENDENCY_2};
    dependency.srcSubpass = VK_SUBPASS_EXTERNAL;
    dependency.dstSubpass = 0;
    dependency.srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
    dependency.dstStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT;
    dependency.srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
    dependency.dstAccessMask = dependency.srcAccessMask | VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT;

    VkRenderPassCreateInfo2 info{VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO_2};
    info.attachmentCount = static_cast<std::uint32_t>(attachments.size());
    info.pAttachments = attachments.data();
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    info.dependencyCount = 1;
    info.pDependencies = &dependency;
    VkRenderPass render_pass = VK_NULL_HANDLE;
    check_vk(vkCreateRenderPass2(gpu.device(), &info, nullptr, &render_pass), "vkCreateRenderPass2");
    return {gpu.device(), render_pass};
}

static OwnedFramebuffer create_framebuffer(const Gpu& gpu, VkRenderPass render_pass, VkExtent2D extent,
                                           const std::vector<VkImageView>& views) {
    VkFramebufferCreateInfo info{VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO};
    info.renderPass = render_pass;
    info.attachmentCount = static_cast<std::uint32_t>(views.size());
    info.pAttachments = views.data();
    info.width = extent.width;
    info.height = extent.height;
    info.layers = 1;
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    check_vk(vkCreateFramebuffer(gpu.device(), &info, nullptr, &framebuffer), "vkCreateFramebuffer");
    return {gpu.device(), framebuffer};
}

EyePass::EyePass(const Gpu& gpu, const PassFormat& format, VkRenderPass render_pass, VkExtent2D extent, const std::vector<VkImage>& images,
                 const std::vector<VkImage>& depth_images)
    : gpu_(&gpu), format_(format), render_pass_(render_pass), extent_(extent) {
    const bool resolves = format.samples != VK_SAMPLE_COUNT_1_BIT;
    if (format.depth && (resolves || !format.keep_depth)) {
        depth_ = create_image(gpu, {.format = VK_FORMAT_D32_SFLOAT,
                                    .extent = extent,
                                    .usage = VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                                    .samples = format.samples});
    }
    if (resolves) {
        multisample_ = create_image(gpu, {.format = format.colour,
                                          .extent = extent,
                                          .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT,
                                          .samples = format.samples});
    }
    if (format.keep_depth) {
        for (VkImage image : depth_images) { depth_views_.push_back(create_image_view(gpu, image, VK_FORMAT_D32_SFLOAT, 1)); }
    }
    for (VkImage image : images) {
        views_.push_back(create_image_view(gpu, image, format.colour, 1));
        for (std::size_t depth = 0; depth < (format.keep_depth ? depth_views_.size() : 1); ++depth) {
            std::vector<VkImageView> attached{views_.back().get()};
            if (format.depth) { attached.push_back(depth_.view.get() != VK_NULL_HANDLE ? depth_.view.get() : depth_views_[depth].get()); }
            if (resolves) { attached.push_back(multisample_.view.get()); }
            if (resolves && format.keep_depth) { attached.push_back(depth_views_[depth].get()); }
            framebuffers_.push_back(create_framebuffer(gpu, render_pass, extent, attached));
        }
    }
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = gpu.command_pool();
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    check_vk(vkAllocateCommandBuffers(gpu.device(), &allocate, &commands_), "vkAllocateCommandBuffers");
    VkFenceCreateInfo fence_info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    fence_info.flags = VK_FENCE_CREATE_SIGNALED_BIT;
    VkFence fence = VK_NULL_HANDLE;
    check_vk(vkCreateFence(gpu.device(), &fence_info, nullptr, &fence), "vkCreateFence");
    done_ = {gpu.device(), fence};
    if (gpu.has_timestamps()) {
        VkQueryPoolCreateInfo query_info{VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO};
        query_info.queryType = VK_QUERY_TYPE_TIMESTAMP;
        query_info.queryCount = 2;
        VkQueryPool times = VK_NULL_HANDLE;
        check_vk(vkCreateQueryPool(gpu.device(), &query_info, nullptr, &times), "vkCreateQueryPool");
        times_ = {gpu.device(), times};
    }
}

std::optional<double> EyePass::milliseconds() const {
    std::array<std::uint64_t, 2> ticks{};
    if (times_.get() == VK_NULL_HANDLE || vkGetQueryPoolResults(gpu_->device(), times_.get(), 0, 2, sizeof(ticks), ticks.data(),
                                                                sizeof(ticks[0]), VK_QUERY_RESULT_64_BIT) != VK_SUCCESS) {
        return std::nullopt;
    }
    return 1e-6 * static_cast<double>(gpu_->properties().limits.timestampPeriod) * static_cast<double>(ticks[1] - ticks[0]);
}

void EyePass::wait() const {
    const VkFence fence = done_.get();
    check_vk(vkWaitForFences(gpu_->device(), 1, &fence, VK_TRUE, UINT64_MAX), "vkWaitForFences");
}

void EyePass::draw(std::uint32_t index, std::uint32_t depth, const VkRect2D& area,
                   const std::function<void(VkCommandBuffer)>& record) const {
    wait();
    const VkFence fence = done_.get();
    check_vk(vkResetFences(gpu_->device(), 1, &fence), "vkResetFences");
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check_vk(vkBeginCommandBuffer(commands_, &begin), "vkBeginCommandBuffer");

    if (times_.get() != VK_NULL_HANDLE) {
        vkCmdResetQueryPool(commands_, times_.get(), 0, 2);
        vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, times_.get(), 0);
    }
    const VkClearValue black{.color = {.float32 = {0, 0, 0, 1}}};
    const VkClearValue far{.depthStencil = {1.0F, 0}};
    const std::array clears{black, format_.depth ? far : black, black};
    VkRenderPassBeginInfo pass{VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO};
    pass.renderPass = render_pass_;
    pass.framebuffer = framebuffers_.at(format_.keep_depth ? index * depth_views_.size() + depth : index).get();
    pass.renderArea = area;
    pass.clearValueCount = static_cast<std::uint32_t>(clears.size());
    pass.pClearValues = clears.data();
    vkCmdBeginRenderPass(commands_, &pass, VK_SUBPASS_CONTENTS_INLINE);
    const VkViewport viewport{0, 0, static_cast<float>(extent_.width), static_cast<float>(extent_.height), 0, 1};
    vkCmdSetViewport(commands_, 0, 1, &viewport);
    vkCmdSetScissor(commands_, 0, 1, &pass.renderArea);
    record(commands_);
    vkCmdEndRenderPass(commands_);
    if (times_.get() != VK_NULL_HANDLE) { vkCmdWriteTimestamp(commands_, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, times_.get(), 1); }

    check_vk(vkEndCommandBuffer(commands_), "vkEndCommandBuffer");
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands_;
    check_vk(vkQueueSubmit(gpu_->queue(), 1, &submit, fence), "vkQueueSubmit");
}

}  // namespace samples
