// own_entries.hpp -- entries of our structures: they build, trace a set of rays, or render pictures.
#pragma once
#include <functional>
#include <vector>

#include "stand/ray_sets.hpp"
#include "tools/bench/cases/case_state.hpp"
#include "tools/bench/output/record.hpp"
#include "tracers/rays/ray_queries.hpp"

namespace clarity::bench {

// Each function sets `once` and `finish` of an entry. Both use the other arguments, which must outlive the entry.

// Builds a structure on the host by calling `build`.
void add_build(Entry& entry, std::function<AccelData()> build);
// Traces the rays of the case. Throws Error(failed) if the scene has no such rays.
void add_rays(CaseState& state, Entry& entry, const Fixture::Held& held);
// Sets `once` alone, to trace these rays, which are the same for all entries of the case.
void time_rays(CaseState& state, Entry& entry, const Fixture::Held& held, const RaySet& set);
// One frame, from the call to tone-mapped pixels in host memory.
void add_frame(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held);
// The frame which baselines render too. Its times end when the film is complete, as theirs do. Tone mapping and readback are in
// the parts only.
void add_whitted(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held);
// A sequence of pictures of a moving camera (moving.hpp).
void add_moving(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held, bool overlapped);

// Puts the number of active rays of the set into the count of its kind: primary, shadow or secondary.
void set_ray_counts(BenchRecord& row, const RaySet& set);
// Traces one frame that counts its rays, and puts the counts into the row.
void count_rays(CaseState& state, BenchRecord& row, const Settings& settings, const Fixture::Held& held, const View& view);

// Compares each overlapped sequence with the non-overlapped one of the same structure and device.
void compare_with_one_by_one(std::vector<BenchRecord>& rows);

// Turns the counters of packets into figures per ray.

// `hits`: results of `rays`, traced with RayQuery::count in packets of `lanes`; `work`: RayQuery::work of them. node_bytes:
// size of one node in bytes.
Analysis analyze(const std::vector<rt_ray>& rays, const std::vector<rt_hit>& hits, const std::vector<RayWork>& work,
                 unsigned lanes, unsigned node_bytes);

}  // namespace clarity::bench
