// guarded_accel.hpp -- a structure with its arrays between guard pages, which kernels on a CPU read in place.
#pragma once
#include <list>
#include <memory>

#include "render/accel/accel_build.hpp"
#include "render/accel/guarded_memory.hpp"

namespace clarity {

// Must outlive all that uses the structure.
class GuardedAccel {
 public:
    explicit GuardedAccel(const AccelData& built);
    std::shared_ptr<const AccelData> accel() const { return accel_; }

 private:
    std::list<GuardedBytes> memory_;
    std::shared_ptr<AccelData> accel_;
};

}  // namespace clarity
