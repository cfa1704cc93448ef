// progress.hpp -- reports the progress of long work, and cancels it.
#pragma once
#include <algorithm>
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

// The progress of a part of the work.

// report(f) of the part is report(from + f * share) of the whole.
class PartOf : public Progress {
 public:
    PartOf(Progress& whole, double from, double share) : whole_(whole), from_(from), share_(share) {}
    bool report(float fraction) override {
        if (!whole_.report(float(from_ + share_ * std::max(0.0f, fraction)))) cancel();
        return !cancelled();
    }
    // A long sample asks between its launches, but reports only at its end.
    bool cancelled() const override { return Progress::cancelled() || whole_.cancelled(); }

 private:
    Progress& whole_;
    const double from_, share_;
};

}  // namespace clarity
