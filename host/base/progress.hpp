// progress.hpp -- reports the progress of long work, and cancels it.
#pragma once
#include <atomic>
#include <string>

namespace clarity {

// The work calls it from any thread; the default ignores what is reported.
class Progress {
 public:
    virtual ~Progress() = default;
    // A new stage begins: "importing car.fbx", "building bvh2".
    virtual void stage(const std::string&) {}
    // Progress within the stage, 0..1; negative: unknown. Returns false once the work is cancelled.
    virtual bool report(float) { return !cancelled(); }
    void cancel() { cancelled_ = true; }
    // Also true for a part of the work once the whole is cancelled. Called from several threads, often.
    virtual bool cancelled() const { return cancelled_; }

 private:
    std::atomic<bool> cancelled_{false};
};

}  // namespace clarity
