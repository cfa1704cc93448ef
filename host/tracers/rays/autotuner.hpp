// autotuner.hpp -- tries several variants of the same work, then uses the fastest.
#pragma once
#include <algorithm>
#include <array>

namespace clarity {

// The caller asks variant() which variant to run, runs it, and reports its time to took(). Used from one thread.
//
// How the choice is made: all variants run one after the other, in three rounds. The first round is a warm-up (it may include a
// compilation, and the launcher may cut it into small pieces). The minimum of the other two rounds counts. A variant that is
// 1.5 times slower than the fastest after its second run is not tried a third time.
//
// When the choice is reviewed: the clock of a GPU rises for some tenths of a second after it gets work. A choice that was made
// meanwhile favours the variants that were tried last. So all variants are tried again (two rounds, without the warm-up)
// - when three consecutive runs took clearly more or less time (10 %) than the run that decided the choice. Each time this
//   happens, the number of runs needed doubles, so that a machine which is never steady does not tune for ever;
// - after 16 uses, then after 64, 256 and so on: this finds a smaller drift, and costs less and less.
// The current choice stays unless another variant takes 3 % less time: smaller differences are noise.
class Autotuner {
 public:
    // variants: how many there are, 1 to kMost.
    explicit Autotuner(unsigned variants = 1) : variants_(variants) {
        if (variants_ > 1) try_all(0);
    }
    // The variant to run next.
    unsigned variant() const { return trying() ? at_ : best_; }
    // True if the next run is a trial, possibly of a slow variant. A benchmark must not count its time.
    bool trying() const { return round_ < kRounds; }
    // True if a run of the chosen variant has confirmed the time that decided the choice.
    bool settled() const { return variants_ == 1 || confirmed_; }
    // Reports that the run of variant() took `ms`.
    void took(double ms) {
        if (variants_ == 1) return;
        if (trying())
            note_try(ms);
        else
            note_use(ms);
    }

    static constexpr unsigned kMost = 5;

 private:
    static constexpr unsigned kRounds = 3;
    static constexpr double kFarBehind = 1.5;
    static constexpr double kWorthIt = 0.97;
    static constexpr double kClearly = 1.1;

    void try_all(unsigned first_round) {
        ms_.fill(1e30);
        round_ = first_round;
        at_ = uses_ = unlike_ = 0;
        confirmed_ = false;
    }

    void note_try(double ms) {
        if (round_ > 0) ms_[at_] = std::min(ms_[at_], ms);
        do {
            if (++at_ < variants_) continue;
            at_ = 0;
            if (++round_ == kRounds - 1) worth_a_third_ = kFarBehind * ms_[fastest()];
        } while (round_ == kRounds - 1 && ms_[at_] > worth_a_third_);
        if (!trying() && ms_[fastest()] < kWorthIt * ms_[best_]) best_ = fastest();
    }

    void note_use(double ms) {
        const double expected = ms_[best_];
        if (ms > kClearly * expected || kClearly * ms < expected) {
            ++unlike_;
        } else {
            unlike_ = 0;
            confirmed_ = true;
        }
        ++uses_;
        if (unlike_ == most_unlike_) {
            most_unlike_ *= 2;
            try_all(1);
        } else if (uses_ == look_again_) {
            look_again_ *= 4;
            try_all(1);
        }
    }

    unsigned fastest() const {
        return static_cast<unsigned>(std::min_element(ms_.begin(), ms_.begin() + variants_) - ms_.begin());
    }

    unsigned variants_, round_ = kRounds, at_ = 0, best_ = 0;
    unsigned uses_ = 0, look_again_ = 16;    // uses since the choice, and the number of uses after which it is reviewed
    unsigned unlike_ = 0, most_unlike_ = 3;  // consecutive runs that took another time than expected, and their limit
    bool confirmed_ = false;
    double worth_a_third_ = 0;  // ms; slower variants are not tried a third time
    std::array<double, kMost> ms_{};
};

}  // namespace clarity
