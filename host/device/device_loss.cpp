#include "device/device_loss.hpp"

#include <mutex>
#include <vector>

namespace clarity {

namespace {

// Never destroyed itself.
struct Kept {
    std::mutex mutex;
    std::vector<std::shared_ptr<const void>> objects;
};

Kept& kept() {
    static Kept& all = *new Kept;
    return all;
}

}  // namespace

void never_release(std::shared_ptr<const void> object) {
    const std::lock_guard<std::mutex> lock(kept().mutex);
    kept().objects.push_back(std::move(object));
}

bool any_never_released() {
    const std::lock_guard<std::mutex> lock(kept().mutex);
    return !kept().objects.empty();
}

}  // namespace clarity
