#include "runtime/objects/debug_utils.h"

#include "runtime/objects/instance.h"

#include <algorithm>

namespace entoptic::runtime {

namespace {

bool wanted(const XrDebugUtilsMessengerCreateInfoEXT& info, XrDebugUtilsMessageSeverityFlagsEXT severity,
            XrDebugUtilsMessageTypeFlagsEXT types) {
    return (info.messageSeverities & severity) != 0 && (info.messageTypes & types) != 0;
}

XrDebugUtilsMessengerCreateInfoEXT without_chain(XrDebugUtilsMessengerCreateInfoEXT info) {
    info.next = nullptr;
    return info;
}

}  // namespace

Messenger::Messenger(std::shared_ptr<Instance> instance, const XrDebugUtilsMessengerCreateInfoEXT& info)
    : Object(ObjectType::messenger), instance_(std::move(instance)), info_(without_chain(info)) {}

void Messenger::retire() { instance_->debug().remove(this); }

void DebugUtils::add(const Messenger* messenger) {
    std::lock_guard lock(mutex_);
    receivers_.push_back({messenger, messenger->info()});
}

void DebugUtils::add_for_creation(const XrDebugUtilsMessengerCreateInfoEXT& info) {
    std::lock_guard lock(mutex_);
    receivers_.push_back({nullptr, without_chain(info)});
}

void DebugUtils::creation_done() { remove(nullptr); }

void DebugUtils::remove(const Messenger* messenger) {
    std::lock_guard lock(mutex_);
    std::erase_if(receivers_, [&](const Receiver& receiver) { return receiver.messenger == messenger; });
}

void DebugUtils::set_name(DebugObject object, const char* name) {
    std::lock_guard lock(mutex_);
    if (name && *name)
        names_[{object.type, object.handle}] = name;
    else
        names_.erase({object.type, object.handle});
}

void DebugUtils::drop_individual(std::vector<Label>& labels) {
    if (!labels.empty() && !labels.back().region) labels.pop_back();
}

void DebugUtils::begin_region(std::uint64_t session, const char* name) {
    std::lock_guard lock(mutex_);
    auto& labels = labels_[session];
    drop_individual(labels);
    labels.push_back({name, true});
}

void DebugUtils::end_region(std::uint64_t session) {
    std::lock_guard lock(mutex_);
    auto& labels = labels_[session];
    drop_individual(labels);
    if (!labels.empty()) labels.pop_back();
}

void DebugUtils::insert_label(std::uint64_t session, const char* name) {
    std::lock_guard lock(mutex_);
    auto& labels = labels_[session];
    drop_individual(labels);
    labels.push_back({name, false});
}

void DebugUtils::forget_session(std::uint64_t session) {
    std::lock_guard lock(mutex_);
    labels_.erase(session);
}

void DebugUtils::submit(XrDebugUtilsMessageSeverityFlagsEXT severity, XrDebugUtilsMessageTypeFlagsEXT types, const char* id,
                        const char* function, const char* message, const std::vector<DebugObject>& objects) {
    std::vector<Receiver> receivers;
    std::vector<std::string> object_names, label_names;
    {
        std::lock_guard lock(mutex_);
        std::copy_if(receivers_.begin(), receivers_.end(), std::back_inserter(receivers),
                     [&](const Receiver& receiver) { return wanted(receiver.info, severity, types); });
        if (receivers.empty()) return;
        for (const DebugObject& object : objects) {
            auto found = names_.find({object.type, object.handle});
            object_names.push_back(found == names_.end() ? object.name : found->second);
            auto labels = labels_.find(object.handle);
            if (object.type != XR_OBJECT_TYPE_SESSION || labels == labels_.end()) continue;
            for (auto label = labels->second.rbegin(); label != labels->second.rend(); ++label) label_names.push_back(label->name);
        }
    }
    std::vector<XrDebugUtilsObjectNameInfoEXT> object_infos;
    for (std::size_t i = 0; i < objects.size(); ++i) {
        const char* name = object_names[i].empty() ? nullptr : object_names[i].c_str();
        object_infos.push_back({XR_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT, nullptr, objects[i].type, objects[i].handle, name});
    }
    std::vector<XrDebugUtilsLabelEXT> label_infos;
    for (const std::string& name : label_names) label_infos.push_back({XR_TYPE_DEBUG_UTILS_LABEL_EXT, nullptr, name.c_str()});
    XrDebugUtilsMessengerCallbackDataEXT data{XR_TYPE_DEBUG_UTILS_MESSENGER_CALLBACK_DATA_EXT};
    data.messageId = id;
    data.functionName = function;
    data.message = message;
    data.objectCount = static_cast<std::uint32_t>(object_infos.size());
    data.objects = object_infos.empty() ? nullptr : object_infos.data();
    data.sessionLabelCount = static_cast<std::uint32_t>(label_infos.size());
    data.sessionLabels = label_infos.empty() ? nullptr : label_infos.data();
    for (const Receiver& receiver : receivers) receiver.info.userCallback(severity, types, &data, receiver.info.userData);
}

}  // namespace entoptic::runtime
