#include "samples/common/gpu.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

#include "samples/common/failure.h"

namespace samples {

void check_vk(VkResult result, const char* call) {
    if (result < 0) { throw Failure(ExitCode::failed, fmt::format("{} failed (VkResult {})", call, static_cast<int>(result))); }
}

// ---- device ---------------------------------------------------------------------------------------------------------------------

Gpu::Gpu(const std::string& application, const Factory& factory) {
    try {
        create_instance(application, factory);
        create_device(factory);
    } catch (...) {
        if (device_ != VK_NULL_HANDLE) { vkDestroyDevice(device_, nullptr); }
        if (instance_ != VK_NULL_HANDLE) { vkDestroyInstance(instance_, nullptr); }
        throw;
    }
}

Gpu::~Gpu() {
    vkDeviceWaitIdle(device_);
    vkDestroyCommandPool(device_, command_pool_, nullptr);
    vkDestroyDevice(device_, nullptr);
    vkDestroyInstance(instance_, nullptr);
}

void Gpu::create_instance(const std::string& application, const Factory& factory) {
    VkApplicationInfo app{VK_STRUCTURE_TYPE_APPLICATION_INFO};
    app.pApplicationName = application.c_str();
    app.pEngineName = "Entoptic samples";
    app.apiVersion = VK_API_VERSION_1_2;
    VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
    info.pApplicationInfo = &app;
    if (const VkResult result = factory.create_instance(info, &instance_); result < 0) {
        throw Failure(ExitCode::missing, fmt::format("cannot start Vulkan (VkResult {}): install a Vulkan driver, for example "
                                                     "`apt install mesa-vulkan-drivers`, and see what `vulkaninfo` says",
                                                     static_cast<int>(result)));
    }
}

void Gpu::create_device(const Factory& factory) {
    physical_device_ = factory.choose_device(instance_);
    vkGetPhysicalDeviceProperties(physical_device_, &properties_);
    vkGetPhysicalDeviceMemoryProperties(physical_device_, &memory_properties_);
    if (properties_.apiVersion < VK_API_VERSION_1_2) {
        throw Failure(ExitCode::missing, fmt::format("{} offers no Vulkan 1.2: update its driver", properties_.deviceName));
    }
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(physical_device_, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(physical_device_, &count, families.data());
    const auto family =
        std::find_if(families.begin(), families.end(), [](const auto& f) { return (f.queueFlags & VK_QUEUE_GRAPHICS_BIT) != 0; });
    if (family == families.end()) {
        throw Failure(ExitCode::missing, fmt::format("{} cannot draw (no graphics queue)", properties_.deviceName));
    }
    queue_family_ = static_cast<std::uint32_t>(family - families.begin());
    has_timestamps_ = family->timestampValidBits > 0;

    const float priority = 1.0F;
    VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
    queue.queueFamilyIndex = queue_family_;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO};
    info.queueCreateInfoCount = 1;
    info.pQueueCreateInfos = &queue;
    check_vk(factory.create_device(physical_device_, info, &device_), "vkCreateDevice");
    vkGetDeviceQueue(device_, queue_family_, 0, &queue_);

    VkCommandPoolCreateInfo pool{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
    pool.flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT;
    pool.queueFamilyIndex = queue_family_;
    check_vk(vkCreateCommandPool(device_, &pool, nullptr, &command_pool_), "vkCreateCommandPool");
}

static VkPhysicalDevice choose_any_device(VkInstance instance) {
    std::uint32_t count = 0;
    vkEnumeratePhysicalDevices(instance, &count, nullptr);
    std::vector<VkPhysicalDevice> devices(count);
    vkEnumeratePhysicalDevices(instance, &count, devices.data());
    if (devices.empty()) {
        throw Failure(ExitCode::missing, "no Vulkan device: install a driver, for example `apt install mesa-vulkan-drivers`");
    }
    const auto discrete = std::find_if(devices.begin(), devices.end(), [](VkPhysicalDevice device) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(device, &properties);
        return properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU;
    });
    return discrete != devices.end() ? *discrete : devices.front();
}

std::unique_ptr<Gpu> Gpu::standalone(const std::string& application) {
    Factory factory;
    factory.create_instance = [](const VkInstanceCreateInfo& info, VkInstance* instance) {
        return vkCreateInstance(&info, nullptr, instance);
    };
    factory.choose_device = choose_any_device;
    factory.create_device = [](VkPhysicalDevice physical, const VkDeviceCreateInfo& info, VkDevice* device) {
        return vkCreateDevice(physical, &info, nullptr, device);
    };
    return std::make_unique<Gpu>(application, factory);
}

std::uint32_t Gpu::memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags wanted) const {
    for (std::uint32_t i = 0; i < memory_properties_.memoryTypeCount; ++i) {
        const bool allowed = (type_bits & (1U << i)) != 0;
        if (allowed && (memory_properties_.memoryTypes[i].propertyFlags & wanted) == wanted) { return i; }
    }
    throw Failure(ExitCode::missing, fmt::format("{} has no memory of the kind needed", properties_.deviceName));
}

bool Gpu::supports(VkFormat format, VkFormatFeatureFlags features) const {
    VkFormatProperties format_properties;
    vkGetPhysicalDeviceFormatProperties(physical_device_, format, &format_properties);
    return (format_properties.optimalTilingFeatures & features) == features;
}

void Gpu::submit_and_wait(const std::function<void(VkCommandBuffer)>& record) const {
    VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
    allocate.commandPool = command_pool_;
    allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    allocate.commandBufferCount = 1;
    VkCommandBuffer commands = VK_NULL_HANDLE;
    check_vk(vkAllocateCommandBuffers(device_, &allocate, &commands), "vkAllocateCommandBuffers");
    VkCommandBufferBeginInfo begin{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check_vk(vkBeginCommandBuffer(commands, &begin), "vkBeginCommandBuffer");
    record(commands);
    check_vk(vkEndCommandBuffer(commands), "vkEndCommandBuffer");
    VkSubmitInfo submit{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    submit.commandBufferCount = 1;
    submit.pCommandBuffers = &commands;
    check_vk(vkQueueSubmit(queue_, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit");
    check_vk(vkQueueWaitIdle(queue_), "vkQueueWaitIdle");
    vkFreeCommandBuffers(device_, command_pool_, 1, &commands);
}

// ---- images and buffers -----------------------------------------------------------------------------------------------------------

VkImageAspectFlags aspect_of(VkFormat format) {
    return format == VK_FORMAT_D32_SFLOAT ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

static OwnedMemory allocate(const Gpu& gpu, const VkMemoryRequirements& needs, VkMemoryPropertyFlags properties) {
    VkMemoryAllocateInfo info{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO};
    info.allocationSize = needs.size;
    info.memoryTypeIndex = gpu.memory_type(needs.memoryTypeBits, properties);
    VkDeviceMemory memory = VK_NULL_HANDLE;
    check_vk(vkAllocateMemory(gpu.device(), &info, nullptr, &memory), "vkAllocateMemory");
    return {gpu.device(), memory};
}

OwnedImageView create_image_view(const Gpu& gpu, VkImage image, VkFormat format, std::uint32_t mip_levels) {
    VkImageViewCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    info.image = image;
    info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    info.format = format;
    info.subresourceRange = {aspect_of(format), 0, mip_levels, 0, 1};
    VkImageView view = VK_NULL_HANDLE;
    check_vk(vkCreateImageView(gpu.device(), &info, nullptr, &view), "vkCreateImageView");
    return {gpu.device(), view};
}

Image create_image(const Gpu& gpu, const ImageDescription& description) {
    VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = description.format;
    info.extent = {description.extent.width, description.extent.height, 1};
    info.mipLevels = description.mip_levels;
    info.arrayLayers = 1;
    info.samples = description.samples;
    info.tiling = VK_IMAGE_TILING_OPTIMAL;
    info.usage = description.usage;
    VkImage handle = VK_NULL_HANDLE;
    check_vk(vkCreateImage(gpu.device(), &info, nullptr, &handle), "vkCreateImage");
    Image image;
    image.image = {gpu.device(), handle};
    image.format = description.format;
    image.extent = description.extent;
    image.mip_levels = description.mip_levels;
    VkMemoryRequirements needs;
    vkGetImageMemoryRequirements(gpu.device(), handle, &needs);
    image.memory = allocate(gpu, needs, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    check_vk(vkBindImageMemory(gpu.device(), handle, image.memory.get(), 0), "vkBindImageMemory");
    image.view = create_image_view(gpu, handle, description.format, description.mip_levels);
    return image;
}

Buffer create_buffer(const Gpu& gpu, VkDeviceSize size, VkBufferUsageFlags usage) {
    VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO};
    info.size = size;
    info.usage = usage;
    VkBuffer handle = VK_NULL_HANDLE;
    check_vk(vkCreateBuffer(gpu.device(), &info, nullptr, &handle), "vkCreateBuffer");
    Buffer buffer;
    buffer.buffer = {gpu.device(), handle};
    buffer.size = size;
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(gpu.device(), handle, &needs);
    buffer.memory = allocate(gpu, needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    check_vk(vkBindBufferMemory(gpu.device(), handle, buffer.memory.get(), 0), "vkBindBufferMemory");
    check_vk(vkMapMemory(gpu.device(), buffer.memory.get(), 0, VK_WHOLE_SIZE, 0, &buffer.mapped), "vkMapMemory");
    return buffer;
}

Buffer create_buffer_from(const Gpu& gpu, std::span<const std::byte> bytes, VkBufferUsageFlags usage) {
    Buffer buffer = create_buffer(gpu, bytes.size(), usage);
    std::memcpy(buffer.mapped, bytes.data(), bytes.size());
    return buffer;
}

namespace {

struct LayoutChange {
    VkImageLayout from, to;
    VkAccessFlags from_access, to_access;
    VkPipelineStageFlags from_stage, to_stage;
    VkImageAspectFlags aspect = VK_IMAGE_ASPECT_COLOR_BIT;
};

}  // namespace

static void change_layout(VkCommandBuffer commands, VkImage image, std::uint32_t levels, const LayoutChange& change) {
    VkImageMemoryBarrier barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER};
    barrier.srcAccessMask = change.from_access;
    barrier.dstAccessMask = change.to_access;
    barrier.oldLayout = change.from;
    barrier.newLayout = change.to;
    barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {change.aspect, 0, levels, 0, 1};
    vkCmdPipelineBarrier(commands, change.from_stage, change.to_stage, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

static std::vector<VkBufferImageCopy> copies_of_levels(VkExtent2D extent, std::span<const std::vector<std::byte>> levels) {
    std::vector<VkBufferImageCopy> copies;
    VkDeviceSize offset = 0;
    for (std::uint32_t level = 0; level < levels.size(); ++level) {
        VkBufferImageCopy copy{};
        copy.bufferOffset = offset;
        copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1};
        copy.imageExtent = {std::max(extent.width >> level, 1U), std::max(extent.height >> level, 1U), 1};
        copies.push_back(copy);
        offset += levels[level].size();
    }
    return copies;
}

Image create_texture(const Gpu& gpu, VkFormat format, VkExtent2D extent, std::span<const std::vector<std::byte>> levels) {
    const auto level_count = static_cast<std::uint32_t>(levels.size());
    Image image = create_image(gpu, {.format = format,
                                     .extent = extent,
                                     .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
                                     .mip_levels = level_count});
    VkDeviceSize size = 0;
    for (const auto& level : levels) { size += level.size(); }
    const Buffer staging = create_buffer(gpu, size, VK_BUFFER_USAGE_TRANSFER_SRC_BIT);
    auto* target = static_cast<std::byte*>(staging.mapped);
    for (const auto& level : levels) {
        std::memcpy(target, level.data(), level.size());
        target += level.size();
    }
    const auto copies = copies_of_levels(extent, levels);
    gpu.submit_and_wait([&](VkCommandBuffer commands) {
        change_layout(commands, image.image.get(), level_count,
                      {VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 0, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT});
        vkCmdCopyBufferToImage(commands, staging.buffer.get(), image.image.get(), VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                               static_cast<std::uint32_t>(copies.size()), copies.data());
        change_layout(commands, image.image.get(), level_count,
                      {VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_ACCESS_SHADER_READ_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT});
    });
    return image;
}

static std::vector<std::byte> read_image(const Gpu& gpu, VkImage image, VkExtent2D extent, std::size_t bytes_per_pixel,
                                         const LayoutChange& to_source) {
    const std::size_t size = std::size_t{extent.width} * extent.height * bytes_per_pixel;
    const Buffer staging = create_buffer(gpu, size, VK_BUFFER_USAGE_TRANSFER_DST_BIT);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {to_source.aspect, 0, 0, 1};
    copy.imageExtent = {extent.width, extent.height, 1};
    const LayoutChange back{to_source.to,       to_source.from,       to_source.to_access, to_source.from_access,
                            to_source.to_stage, to_source.from_stage, to_source.aspect};
    gpu.submit_and_wait([&](VkCommandBuffer commands) {
        change_layout(commands, image, 1, to_source);
        vkCmdCopyImageToBuffer(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, staging.buffer.get(), 1, &copy);
        change_layout(commands, image, 1, back);
    });
    std::vector<std::byte> bytes(size);
    std::memcpy(bytes.data(), staging.mapped, size);
    return bytes;
}

std::vector<std::byte> read_back(const Gpu& gpu, VkImage image, VkExtent2D extent, std::size_t bytes_per_pixel) {
    return read_image(gpu, image, extent, bytes_per_pixel,
                      {VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                       VK_ACCESS_TRANSFER_READ_BIT, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT});
}

std::vector<float> read_back_depth(const Gpu& gpu, VkImage image, VkExtent2D extent) {
    const std::vector<std::byte> bytes =
        read_image(gpu, image, extent, sizeof(float),
                   {VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT, VK_PIPELINE_STAGE_ALL_GRAPHICS_BIT,
                    VK_PIPELINE_STAGE_TRANSFER_BIT, VK_IMAGE_ASPECT_DEPTH_BIT});
    std::vector<float> values(bytes.size() / sizeof(float));
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
}

OwnedSampler create_sampler(const Gpu& gpu, VkFilter filter, VkSamplerAddressMode u, VkSamplerAddressMode v) {
    VkSamplerCreateInfo info{VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO};
    info.magFilter = filter;
    info.minFilter = filter;
    info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
    info.addressModeU = u;
    info.addressModeV = v;
    info.addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE;
    info.maxLod = VK_LOD_CLAMP_NONE;
    VkSampler sampler = VK_NULL_HANDLE;
    check_vk(vkCreateSampler(gpu.device(), &info, nullptr, &sampler), "vkCreateSampler");
    return {gpu.device(), sampler};
}

// ---- descriptors ------------------------------------------------------------------------------------------------------------------

OwnedSetLayout create_set_layout(const Gpu& gpu, std::span<const SetBinding> bindings) {
    std::vector<VkDescriptorSetLayoutBinding> list;
    for (const SetBinding& binding : bindings) {
        list.push_back({static_cast<std::uint32_t>(list.size()), binding.type, 1, binding.stages, nullptr});
    }
    VkDescriptorSetLayoutCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO};
    info.bindingCount = static_cast<std::uint32_t>(list.size());
    info.pBindings = list.data();
    VkDescriptorSetLayout layout = VK_NULL_HANDLE;
    check_vk(vkCreateDescriptorSetLayout(gpu.device(), &info, nullptr, &layout), "vkCreateDescriptorSetLayout");
    return {gpu.device(), layout};
}

OwnedDescriptorPool create_descriptor_pool(const Gpu& gpu, std::uint32_t sets, std::uint32_t uniform_buffers, std::uint32_t images) {
    std::vector<VkDescriptorPoolSize> sizes;
    if (uniform_buffers > 0) { sizes.push_back({VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, uniform_buffers}); }
    sizes.push_back({VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, images});
    VkDescriptorPoolCreateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO};
    info.maxSets = sets;
    info.poolSizeCount = static_cast<std::uint32_t>(sizes.size());
    info.pPoolSizes = sizes.data();
    VkDescriptorPool pool = VK_NULL_HANDLE;
    check_vk(vkCreateDescriptorPool(gpu.device(), &info, nullptr, &pool), "vkCreateDescriptorPool");
    return {gpu.device(), pool};
}

VkDescriptorSet allocate_set(const Gpu& gpu, VkDescriptorPool pool, VkDescriptorSetLayout layout) {
    VkDescriptorSetAllocateInfo info{VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO};
    info.descriptorPool = pool;
    info.descriptorSetCount = 1;
    info.pSetLayouts = &layout;
    VkDescriptorSet set = VK_NULL_HANDLE;
    check_vk(vkAllocateDescriptorSets(gpu.device(), &info, &set), "vkAllocateDescriptorSets");
    return set;
}

void write_image(const Gpu& gpu, VkDescriptorSet set, std::uint32_t binding, VkImageView view, VkSampler sampler) {
    const VkDescriptorImageInfo image{sampler, view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set;
    write.dstBinding = binding;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
    write.pImageInfo = &image;
    vkUpdateDescriptorSets(gpu.device(), 1, &write, 0, nullptr);
}

void write_uniform_buffer(const Gpu& gpu, VkDescriptorSet set, std::uint32_t binding, VkBuffer buffer, VkDeviceSize offset,
                          VkDeviceSize range) {
    const VkDescriptorBufferInfo info{buffer, offset, range};
    VkWriteDescriptorSet write{VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET};
    write.dstSet = set;
    write.dstBinding = binding;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
    write.pBufferInfo = &info;
    vkUpdateDescriptorSets(gpu.device(), 1, &write, 0, nullptr);
}

// ---- pipelines --------------------------------------------------------------------------------------------------------------------

OwnedPipelineLayout create_pipeline_layout(const Gpu& gpu, std::span<const VkDescriptorSetLayout> sets,
                                           std::span<const VkPushConstantRange> push_constants) {
    VkPipelineLayoutCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO};
    info.setLayoutCount = static_cast<std::uint32_t>(sets.size());
    info.pSetLayouts = sets.data();
    info.pushConstantRangeCount = static_cast<std::uint32_t>(push_constants.size());
    info.pPushConstantRanges = push_constants.data();
    VkPipelineLayout layout = VK_NULL_HANDLE;
    check_vk(vkCreatePipelineLayout(gpu.device(), &info, nullptr, &layout), "vkCreatePipelineLayout");
    return {gpu.device(), layout};
}

using OwnedShader = Owned<VkShaderModule, vkDestroyShaderModule>;

static OwnedShader create_shader(const Gpu& gpu, std::span<const std::uint32_t> spirv) {
    VkShaderModuleCreateInfo info{VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO};
    info.codeSize = spirv.size_bytes();
    info.pCode = spirv.data();
    VkShaderModule shader = VK_NULL_HANDLE;
    check_vk(vkCreateShaderModule(gpu.device(), &info, nullptr, &shader), "vkCreateShaderModule");
    return {gpu.device(), shader};
}

static VkPipelineShaderStageCreateInfo stage_of(VkShaderStageFlagBits stage, VkShaderModule shader) {
    VkPipelineShaderStageCreateInfo info{VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO};
    info.stage = stage;
    info.module = shader;
    info.pName = "main";
    return info;
}

static VkPipelineColorBlendAttachmentState blend_state_of(Blend blend) {
    VkPipelineColorBlendAttachmentState state{};
    state.blendEnable = blend == Blend::add ? VK_TRUE : VK_FALSE;
    state.srcColorBlendFactor = VK_BLEND_FACTOR_ONE;
    state.dstColorBlendFactor = VK_BLEND_FACTOR_ONE;
    state.colorBlendOp = VK_BLEND_OP_ADD;
    state.srcAlphaBlendFactor = VK_BLEND_FACTOR_ZERO;
    state.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
    state.alphaBlendOp = VK_BLEND_OP_ADD;
    state.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
    return state;
}

OwnedPipeline create_pipeline(const Gpu& gpu, const PipelineDescription& d) {
    const OwnedShader vertex = create_shader(gpu, d.vertex_spirv);
    const OwnedShader fragment = create_shader(gpu, d.fragment_spirv);
    const std::array stages{stage_of(VK_SHADER_STAGE_VERTEX_BIT, vertex.get()), stage_of(VK_SHADER_STAGE_FRAGMENT_BIT, fragment.get())};
    const VkVertexInputBindingDescription binding{0, d.vertex_stride, VK_VERTEX_INPUT_RATE_VERTEX};
    VkPipelineVertexInputStateCreateInfo input{VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO};
    input.vertexBindingDescriptionCount = d.vertex_stride > 0 ? 1 : 0;
    input.pVertexBindingDescriptions = &binding;
    input.vertexAttributeDescriptionCount = static_cast<std::uint32_t>(d.attributes.size());
    input.pVertexAttributeDescriptions = d.attributes.data();
    VkPipelineInputAssemblyStateCreateInfo assembly{VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO};
    assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
    VkPipelineViewportStateCreateInfo viewport{VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO};
    viewport.viewportCount = 1;
    viewport.scissorCount = 1;
    VkPipelineRasterizationStateCreateInfo raster{VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO};
    raster.polygonMode = VK_POLYGON_MODE_FILL;
    raster.cullMode = d.cull_back_faces ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE;
    raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
    raster.lineWidth = 1.0F;
    VkPipelineMultisampleStateCreateInfo multisample{VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO};
    multisample.rasterizationSamples = d.samples;
    VkPipelineDepthStencilStateCreateInfo depth{VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO};
    depth.depthTestEnable = d.depth_test ? VK_TRUE : VK_FALSE;
    depth.depthWriteEnable = d.depth_write ? VK_TRUE : VK_FALSE;
    depth.depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
    const VkPipelineColorBlendAttachmentState attachment = blend_state_of(d.blend);
    VkPipelineColorBlendStateCreateInfo blend{VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO};
    blend.attachmentCount = 1;
    blend.pAttachments = &attachment;
    const std::array dynamic_states{VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
    VkPipelineDynamicStateCreateInfo dynamic{VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO};
    dynamic.dynamicStateCount = static_cast<std::uint32_t>(dynamic_states.size());
    dynamic.pDynamicStates = dynamic_states.data();

    VkGraphicsPipelineCreateInfo info{VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO};
    info.stageCount = static_cast<std::uint32_t>(stages.size());
    info.pStages = stages.data();
    info.pVertexInputState = &input;
    info.pInputAssemblyState = &assembly;
    info.pViewportState = &viewport;
    info.pRasterizationState = &raster;
    info.pMultisampleState = &multisample;
    info.pDepthStencilState = &depth;
    info.pColorBlendState = &blend;
    info.pDynamicState = &dynamic;
    info.layout = d.layout;
    info.renderPass = d.render_pass;
    VkPipeline pipeline = VK_NULL_HANDLE;
    check_vk(vkCreateGraphicsPipelines(gpu.device(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline), "vkCreateGraphicsPipelines");
    return {gpu.device(), pipeline};
}

}  // namespace samples
