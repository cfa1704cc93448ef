// frame_entries.hpp -- entries of our structures which render pictures.
#pragma once
#include "bench/cases/case_state.hpp"

namespace clarity::bench {

// Each function sets `once` and `finish` of an entry. Both use `state`, which must outlive the entry.

// One frame, from the call to tone-mapped pixels in host memory.
void add_frame(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held);
// The frame which baselines render too. Its times end when the film is complete, as theirs do. Tone mapping and readback are in
// the parts only.
void add_whitted(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held);
// A sequence of pictures of a moving camera (moving.hpp).
void add_moving(CaseState& state, Entry& entry, const Settings& settings, const Fixture::Held& held, bool overlapped);

// Traces one frame that counts its rays, and puts the counts into the row.
void count_rays(CaseState& state, BenchRecord& row, const Settings& settings, const Fixture::Held& held, const View& view);

// Compares each overlapped sequence with the non-overlapped one of the same structure and device.
void compare_with_one_by_one(std::vector<BenchRecord>& rows);

}  // namespace clarity::bench
