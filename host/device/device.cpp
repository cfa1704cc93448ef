#include "device/device.hpp"

#include <utility>

#include "base/error.hpp"

namespace clarity {

Device::Device(DeviceInfo info) : info_(std::move(info)), loss_(std::make_shared<DeviceLoss>()) {
    try {
        context_ = cl::Context(info_.cl_device);
        queue_ = Queue(context_, info_.cl_device, true);
    } catch (const cl::Error& e) {
        throw Error(Exit::no_device, "device " + info_.id() + " (" + info_.name + ") cannot be opened: " + e.what() +
                                         " failed with OpenCL error " + std::to_string(e.err()) +
                                         "; try another one of `clarity devices`");
    }
}

Device::Device(DeviceInfo info, cl::Context context, std::shared_ptr<DeviceLoss> loss)
    : info_(std::move(info)), loss_(std::move(loss)), context_(std::move(context)) {
    queue_ = Queue(context_, info_.cl_device, true);
}

Device::~Device() {
    if (loss_->stuck()) never_release(std::make_shared<std::pair<cl::Context, Queue>>(context_, queue_));
}

void Device::drain() const noexcept {
    if (info_.cpu) clFinish(queue_());
}

std::shared_ptr<Device> Device::with_own_queue() const {
    return std::shared_ptr<Device>(new Device(info_, context_, loss_));
}

unsigned DeviceInfo::preferred_lanes() const {
    if (!traces_packets()) return 1;
    if (float_width >= 16) return 16;
    if (float_width >= 8) return 8;
    return 4;
}

}  // namespace clarity
