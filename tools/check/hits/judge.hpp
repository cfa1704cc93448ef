// judge.hpp -- compares hits with the truth, and finds what wrong ones have in common.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "rt_types.h"
#include "tools/check/hits/brute_force.hpp"

namespace clarity::check {

enum class Fault { none, missed, too_far, wrong_distance, not_there, outside_limits, no_leaf, not_a_number };

// Judges one answer: a nearest hit; or that to an any-hit query, whose t is 0 where the ray is occluded.
Fault judge(const rt_ray& ray, const Truth& truth, const rt_hit& hit, bool any_hit);

// The wrong answers to one set of rays.
struct Faults {
    struct One {
        size_t ray;
        Fault fault;
    };
    std::vector<One> wrong;
    size_t rays = 0;
    bool any_hit = false;
    // Whether something was lost: missed, or hit behind something nearer.
    bool misses() const;
    // Judges all answers to a set.
    static Faults of(const std::vector<rt_ray>& set, const std::vector<Truth>& truths, const std::vector<rt_hit>& hits,
                     bool any_hit);
    // What they have in common: how many, how they are wrong, and, if it is one, the octant, the lane or the kind of primitive.
    std::string text(const std::vector<rt_ray>& set, const std::vector<Truth>& truths, const std::vector<rt_hit>& hits,
                     int lanes) const;
};

}  // namespace clarity::check
