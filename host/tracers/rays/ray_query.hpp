// ray_query.hpp -- what a query of the caller's own rays asks for, and how it ran.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/progress.hpp"
#include "rt_types.h"

namespace clarity {

// All that is counted of a ray; each ray has the counts of its packet. What begins with `own` is what the structure's traversal
// reports, and not what the host's helpers counted (cl/CONTRACT.md).
struct RayWork {
    RT_HIT_COUNTERS(RT_COUNTER_MEMBER)
};

// What RayQueries::trace() computes.
struct RayQuery {
    bool any_hit = false;  // only whether anything is hit between t_min and t_max
    // Fill in steps, leaf_tests and lane_steps. This uses a slower program: leave it out when measuring time.
    bool count = false;
    // Write only t and prim of the nearest hit. Use it to compare times with libraries that write no more than that.
    bool brief = false;
    // Full stacks of a debug program are counted and not logged: the caller expects them.
    bool quiet = false;
    // Of the rays: they hit only instances that share a bit of it with their mask. RT_SEEN_BY_*, and bits of the caller's own.
    rt_u32 mask = RT_SEEN_BY_ALL;
    std::vector<RayWork>* work = nullptr;  // with `count`: takes one a ray
    Progress* progress = nullptr;          // a cancel ends the query; null: nobody cancels
};

// What RayQueries::trace_all() computes.
struct AllHitsQuery {
    bool count_only = false;  // how many hits each ray has, and not which
    bool quiet = false;       // as in RayQuery
    rt_u32 mask = RT_SEEN_BY_ALL;
};

// All hits of rays. Those of ray i are hits[first[i]] to hits[first[i + 1] - 1], ordered by t, and at one t by prim. Counts of
// steps are 0.
struct AllHits {
    std::vector<uint64_t> first;  // one more than there are rays
    std::vector<rt_hit> hits;     // empty if they were only counted
    uint64_t count(size_t ray) const { return first[ray + 1] - first[ray]; }
};

// How the last RayQueries::trace() ran. The autotuner (autotuner.hpp) tries several variants for each set of rays.
struct RayTuning {
    unsigned variant = 0;     // number of the variant; 0 is the plain kernel
    bool trial = false;       // this run tried a variant that may be slow: do not use its time as a measurement
    bool settled = true;      // the variant is chosen, and one more run has confirmed the choice
    double processor_ms = 0;  // LaunchTimes::processor_ms
};

}  // namespace clarity
