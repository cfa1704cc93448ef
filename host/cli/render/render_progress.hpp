// render_progress.hpp -- the progress of parts of a run of `clarity render`.
#pragma once
#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include "base/progress.hpp"

namespace clarity {

// Progress of a part of the work: report(f) of the part is report(from + f * share) of the whole.
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

// Reports progress, but is never cancelled: for work that must come to its end.
class Uncancelled : public Progress {
 public:
    explicit Uncancelled(Progress& whole) : whole_(whole) {}
    bool report(float fraction) override {
        whole_.report(fraction);
        return true;
    }
    bool cancelled() const override { return false; }

 private:
    Progress& whole_;
};

// Cancels a round of --watch, without a message, when a saved file has made it obsolete.
class UntilSaved : public Progress {
 public:
    UntilSaved(Progress& whole, std::function<bool()> saved) : whole_(whole), saved_(std::move(saved)) {}
    void stage(const std::string& name) override { whole_.stage(name); }
    bool report(float fraction) override {
        if (!whole_.report(fraction) || (saved_ && saved_())) cancel();
        return !cancelled();
    }
    bool cancelled() const override { return Progress::cancelled() || whole_.cancelled(); }

 private:
    Progress& whole_;
    const std::function<bool()> saved_;
};

}  // namespace clarity
