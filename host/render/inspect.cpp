#include "render/inspect.hpp"

#include "base/error.hpp"

namespace clarity {

struct Inspector::Impl {
    std::shared_ptr<Device> device;
};

Inspector::Inspector(std::shared_ptr<Device> device) : impl_(std::make_unique<Impl>()) {
    impl_->device = std::move(device);
}
Inspector::~Inspector() = default;

RayTree Inspector::trace(const Prepared&, const Settings&, const View&, unsigned, unsigned) {
    throw Error(Exit::failed, "rays cannot be inspected yet");
}

}  // namespace clarity
