// refit_policy.hpp -- whether a structure that follows a motion is refitted once more, or built anew.
//
// A refit is cheap, but a refitted tree is traced slower than a fresh one. Each frame adds what that costs to a debt. Once the
// debt has reached the cost of a build, a build follows. For trees that decay evenly no fixed period does better: the best one
// is where the loss of a period equals the cost of its build.
//
// Not all slow trees get better by a build: a motion that goes back and forth returns to the pose of the old tree by itself. So
// nothing is built while the loss falls; a motion that has returned since the last build must pile up more debt; and after a
// build that did not pay, the next one has to wait longer. refit_policy_test.cpp compares all this with the best fixed
// strategy.
#pragma once

namespace clarity {

class RefitPolicy {
 public:
    // The next pose: whether the structure should be built anew for it.
    bool wants_build() const;

    // What was done for a pose, in milliseconds. build_ms: how much longer a build takes than a refit.
    void built(double build_ms);
    // cost_ratio: expected cost of a ray now against that after the last build (SAH). trace_ms: of a frame in about this pose.
    void refitted(double cost_ratio, double trace_ms);

    double debt_ms() const { return debt_ms_; }
    double limit_ms() const;  // the debt at which a build follows

 private:
    double build_ms_ = 0;  // 0: not known
    // The debt that is borne, in costs of a build. 1 suits trees that decay evenly; how a motion goes on is not known before
    // its first builds, and 1.3 did best in the trial of refit_policy.cpp. Each build then says whether it paid.
    double patience_ = 1.3;
    bool has_followed_ = false;  // more than the first build is known
    // Since the last build. A loss is what a frame takes longer than with a fresh tree.
    double debt_ms_ = 0, loss_ms_ = 0, greatest_loss_ms_ = 0;
    bool has_returned_ = false;
    double loss_before_ms_ = 0;  // of the last frame before the build
    double gained_ms_ = 0;       // by the build, as if the old tree had stayed as slow as it was
};

}  // namespace clarity
