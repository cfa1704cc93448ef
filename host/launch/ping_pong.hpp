// ping_pong.hpp -- two sets of counters on a device, used by alternate launches.
#pragma once
#include <CL/opencl.hpp>

namespace clarity {

// Each launch counts in one set and clears the other for the next launch, which saves a command. After a failed launch the
// content of both sets is undefined.
class PingPong {
 public:
    // Calls enqueue(parity), where `parity` (0 or 1) is the set to use. If that set may not be zero, calls clear(parity) first.
    // Passes on exceptions of both.
    template <class Clear, class Enqueue>
    void take(const Clear& clear, const Enqueue& enqueue) {
        if (!clean_) clear(parity_);
        clean_ = false;  // stays false if enqueue() throws
        enqueue(parity_);
        parity_ ^= 1u;
        clean_ = true;
    }
    // Call this when the sets have moved to another buffer: their content is then undefined.
    void forget() { clean_ = false; }

 private:
    cl_uint parity_ = 0;
    bool clean_ = false;  // the set of this parity is zero
};

}  // namespace clarity
