#include "runtime/objects/swapchain.h"

#include "runtime/objects/instance.h"
#include "runtime/objects/session.h"

namespace entoptic::runtime {

namespace {

XrSwapchainCreateInfo without_chain(XrSwapchainCreateInfo info) {
    info.next = nullptr;
    return info;
}

Outcome gone() { return error(XR_ERROR_HANDLE_INVALID, "the swapchain was destroyed during the call"); }

}  // namespace

Swapchain::Swapchain(std::shared_ptr<Session> session, const XrSwapchainCreateInfo& info, std::uint64_t id,
                     std::unique_ptr<SwapchainImages> images)
    : Object(ObjectType::swapchain),
      session_(std::move(session)),
      info_(without_chain(info)),
      id_(id),
      image_count_(images->count()),
      images_(std::move(images)) {}

Swapchain::~Swapchain() { retire(); }

Instance& Swapchain::instance() { return session_->instance(); }

void Swapchain::retire() {
    std::shared_ptr<SwapchainImages> images;
    {
        std::lock_guard lock(mutex_);
        images = std::move(images_);
        images_.reset();
    }
    if (!images) return;
    images.reset();
    instance().host().frames().destroy_swapchain(id_);
}

Outcome Swapchain::enumerate(XrSwapchainImageBaseHeader* images) {
    std::lock_guard lock(mutex_);
    return images_ ? images_->enumerate(images) : gone();
}

Outcome Swapchain::acquire(std::uint32_t& index) {
    std::lock_guard lock(mutex_);
    if (!images_) return gone();
    if ((info_.createFlags & XR_SWAPCHAIN_CREATE_STATIC_IMAGE_BIT) != 0 && static_used_) {
        return error(XR_ERROR_CALL_ORDER_INVALID, "the image of a static swapchain can be acquired once only");
    }
    if (all_acquired()) return error(XR_ERROR_CALL_ORDER_INVALID, "all {} images are acquired already; release one first", image_count_);
    Acquired next{next_, false};
    // Nearly always the compositor is done with the image whose turn it is, and the barrier goes to the queue here, where the specification
    // lets a runtime use it. Else xrWaitSwapchainImage does it, once the image is free.
    if (instance().host().frames().wait_image_idle(id_, next.index, 0)) {
        ENTOPTIC_XR_TRY(images_->acquire(next.index));
        next.handed_over = true;
    }
    acquired_.push_back(next);
    index = next.index;
    static_used_ = true;
    next_ = (next_ + 1) % image_count_;
    return XR_SUCCESS;
}

Outcome Swapchain::wait(XrDuration timeout) {
    std::unique_lock lock(mutex_);
    if (!images_) return gone();
    if (acquired_.empty()) return error(XR_ERROR_CALL_ORDER_INVALID, "no image is acquired; call xrAcquireSwapchainImage first");
    if (waited_) return error(XR_ERROR_CALL_ORDER_INVALID, "image {} was waited for and must be released first", *waited_);
    if (waiting_) return error(XR_ERROR_CALL_ORDER_INVALID, "another thread is waiting for this swapchain's image");
    const std::uint32_t index = acquired_.front().index;
    if (!acquired_.front().handed_over) {
        waiting_ = true;
        lock.unlock();
        const bool idle = instance().host().frames().wait_image_idle(id_, index, timeout);
        lock.lock();
        waiting_ = false;
        if (!images_) return gone();
        if (!idle) return XR_TIMEOUT_EXPIRED;
        ENTOPTIC_XR_TRY(images_->acquire(index));
    }
    acquired_.pop_front();
    waited_ = index;
    return XR_SUCCESS;
}

Outcome Swapchain::release() {
    std::lock_guard lock(mutex_);
    if (!images_) return gone();
    if (!waited_) return error(XR_ERROR_CALL_ORDER_INVALID, "no image has been waited for; call xrWaitSwapchainImage first");
    ENTOPTIC_XR_TRY(images_->release(*waited_));
    last_released_ = waited_;
    waited_.reset();
    return XR_SUCCESS;
}

Outcome Swapchain::take_for_layer(std::uint32_t& index) {
    std::shared_ptr<SwapchainImages> images;
    {
        std::lock_guard lock(mutex_);
        if (!images_) return gone();
        if (!last_released_)
            return error(XR_ERROR_LAYER_INVALID, "the layer's swapchain has no released image yet; render one and release it");
        index = *last_released_;
        images = images_;
    }
    return images->wait_released(index);
}

}  // namespace entoptic::runtime
