// ray_entries.hpp -- entries of our structures which trace a set of rays.
#pragma once
#include "bench/cases/case_state.hpp"

namespace clarity::bench {

// Sets `once` and `finish` of an entry: it traces the rays of the case. Both use `state`, which must outlive the entry. Throws
// Error(failed) if the scene has no such rays.
void add_rays(CaseState& state, Entry& entry, const Fixture::Held& held);

// Puts the number of active rays of the set into the count of its kind: primary, shadow or secondary.
void set_ray_counts(BenchRecord& row, const RaySet& set);

}  // namespace clarity::bench
