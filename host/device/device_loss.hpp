// device_loss.hpp -- whether an open device is lost, and what becomes of the objects on it.
#pragma once
#include <atomic>
#include <memory>

namespace clarity {

// State of one open device, shared with everything that has objects on it. Thread-safe.
class DeviceLoss {
 public:
    // A driver reported that the device failed. Its objects are released as always.
    void note_failed() {
        State none = State::none;
        state_.compare_exchange_strong(none, State::failed);
    }
    // A call failed for want of resources. That may be so once, or the device has failed: NVIDIA's driver says this of all
    // calls after a kernel that read out of bounds. The third in a row counts as that.
    void note_refused() {
        if (++refused_ >= 3) note_failed();
    }
    void note_worked() { refused_ = 0; }
    // A launch did not end. The driver may wait for it in any call that releases an object, so nothing on the device is
    // released.
    void note_stuck() { state_ = State::stuck; }
    bool lost() const { return state_ != State::none; }
    bool stuck() const { return state_ == State::stuck; }

 private:
    enum class State { none, failed, stuck };
    std::atomic<State> state_{State::none};
    std::atomic<int> refused_{0};
};

// Keeps an object until the process ends, for destructors of objects on a device that is stuck. For any thread.
void never_release(std::shared_ptr<const void> object);
// Whether there is such an object: a launch may then run for ever, and the driver may wait for it when it is unloaded.
bool any_never_released();

}  // namespace clarity
