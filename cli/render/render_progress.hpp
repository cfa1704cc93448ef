// render_progress.hpp -- the progress of parts of a run of `clarity render`.
#pragma once
#include <functional>
#include <string>
#include <utility>

#include "base/progress.hpp"

namespace clarity {

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
