// ping_pong.hpp -- two sets of counters on a device, which launches use in turn.
#pragma once
#include <CL/opencl.hpp>

namespace clarity {

// A launch counts in one set and clears the other for the next, which spares a command. One that could not be enqueued leaves
// anything in them.
class PingPong {
 public:
    // turn: 0 or 1, the set that enqueue(turn) uses; clear(turn), if need be before, makes it zeroes. Passes on what they
    // throw.
    template <class Clear, class Enqueue>
    void take(const Clear& clear, const Enqueue& enqueue) {
        if (!clean_) clear(turn_);
        clean_ = false;  // unless all goes well
        enqueue(turn_);
        turn_ ^= 1u;
        clean_ = true;
    }
    // The sets are in another buffer now.
    void forget() { clean_ = false; }

 private:
    cl_uint turn_ = 0;
    bool clean_ = false;  // the set of this turn is
};

}  // namespace clarity
