// progress.hpp -- how long work tells where it stands and learns that it is no longer wanted.
#pragma once
#include <atomic>
#include <string>

namespace clarity {

// Called from any thread. The default says nothing and goes on.
class Progress {
 public:
    virtual ~Progress() = default;
    // A new stage: "importing car.fbx", "building bvh2".
    virtual void stage(const std::string&) {}
    // 0..1 within the stage; negative: unknown. Returns false once the work is cancelled.
    virtual bool report(float) { return !cancelled(); }
    void cancel() { cancelled_ = true; }
    bool cancelled() const { return cancelled_; }

 private:
    std::atomic<bool> cancelled_{false};
};

}  // namespace clarity
