#include "device/device_loss.hpp"

#include <mutex>
#include <vector>

namespace clarity {

void never_release(std::shared_ptr<const void> object) {
    static auto& mutex = *new std::mutex;
    static auto& all = *new std::vector<std::shared_ptr<const void>>;
    const std::lock_guard<std::mutex> lock(mutex);
    all.push_back(std::move(object));
}

}  // namespace clarity
