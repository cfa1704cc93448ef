// part_of_progress.hpp -- the progress of a part of the work.
#pragma once
#include <algorithm>

#include "base/progress.hpp"

namespace clarity {

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
